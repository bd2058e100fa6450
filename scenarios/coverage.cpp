#include "scenarios/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/marked_values.h"
#include "control/explore.h"
#include "maps/grid_update.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "world/wall_tree.h"

namespace sf::scenarios {

namespace {

using base::Pose;
using maps::Cell;
using maps::CellAt;
using sensors::lasers_of;
using sensors::LaserSettings;

constexpr int kHeadings = 16;
constexpr std::uint32_t kBeams = 361;

/// The explorer's grid where possible, so that both maps have the same cells.
maps::GridGeometry plan_over(const world::World& world, double cell) {
  try {
    return control::grid_around(world, cell);
  } catch (const base::InputError&) {
  }
  const world::Extent& e = world.extent;
  const auto words = [&](double size) {
    return static_cast<std::uint32_t>(std::clamp(std::ceil(size / (4.0 * cell)), 1.0, 4096.0));
  };
  return {e.x_min, e.y_max, cell, words(e.x_max - e.x_min), words(e.y_max - e.y_min)};
}

std::vector<world::Segment> walls_where(const world::World& world, bool (*take)(const world::Segment&), double z_min,
                                        double z_max) {
  std::vector<world::Segment> walls;
  for (const world::Segment& wall : world.walls)
    if (take(wall) && wall.z_min <= z_max && wall.z_max > z_min) walls.push_back(wall);
  return walls;
}

/// Cells whose centres the robot's origin can reach: clear of walls by its radius and connected to its start.
std::vector<CellAt> reachable(const world::World& world, std::uint32_t mover, const maps::GridGeometry& geometry) {
  const world::Mover& robot = world.movers[mover];
  double top = 0.0;
  for (const world::Segment& side : robot.body) top = std::max(top, side.z_max);
  const world::WallTree walls(walls_where(
      world, [](const world::Segment& w) { return w.stops_robots; }, robot.X_WM.z, robot.X_WM.z + top));
  const auto clear = [&](CellAt at) {
    const glm::dvec2 p = maps::middle(geometry, at);
    return !walls.any(world::box_around(p, robot.radius),
                      [&](const world::Segment& w) { return world::distance(p, w.a, w.b) < robot.radius; });
  };
  maps::OccupancyGrid seen(geometry);
  std::vector<CellAt> found{maps::cell_at(geometry, {robot.X_WM.x, robot.X_WM.y})};
  if (!maps::contains(geometry, found[0])) return {};
  seen.set(found[0], Cell::free);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const CellAt next{found[i].column + dc, found[i].row + dr};
      if (!maps::contains(geometry, next) || seen.at(next) != Cell::unexplored || !clear(next)) continue;
      seen.set(next, Cell::free);
      found.push_back(next);
    }
  return found;
}

/// Range along a direction, at most `most` [m], by testing every wall.
double cast(const std::vector<world::Segment>& walls, glm::dvec2 from, glm::dvec2 along, double most) {
  double least = most;
  for (const world::Segment& wall : walls) {
    const glm::dvec2 side = wall.b - wall.a;
    const double across = base::cross(along, side);
    if (across == 0.0) continue;
    const double t = base::cross(wall.a - from, side) / across;
    const double u = base::cross(wall.a - from, along) / across;
    if (t >= 0.0 && t < least && u >= 0.0 && u <= 1.0) least = t;
  }
  return least;
}

/// A position of the robot, the laser's poses there for all headings, and the walls in range.
struct Viewpoint {
  glm::dvec2 p;
  std::vector<Pose> eyes;
  std::vector<world::Segment> near;
};

std::vector<Viewpoint> stands_of(const world::World& world, std::uint32_t mover, const LaserSettings& laser,
                                 const maps::GridGeometry& geometry) {
  const double z = world.movers[mover].X_WM.z + laser.X_MS.z;
  const auto walls = walls_where(
      world, [](const world::Segment& w) { return w.seen_by_laser; }, z, z);
  const double ahead = std::hypot(laser.X_MS.x, laser.X_MS.y);
  std::vector<Viewpoint> viewpoints;
  for (const CellAt at : reachable(world, mover, geometry)) {
    Viewpoint viewpoint{.p = maps::middle(geometry, at)};
    for (const world::Segment& wall : walls)
      if (world::distance(viewpoint.p, wall.a, wall.b) < laser.range_max + ahead) viewpoint.near.push_back(wall);
    for (int h = 0; h < kHeadings; ++h) {
      const Pose X_WS = base::compose({viewpoint.p.x, viewpoint.p.y, 0.0, 2.0 * M_PI * h / kHeadings}, laser.X_MS);
      const glm::dvec2 out = glm::dvec2{X_WS.x, X_WS.y} - viewpoint.p;
      // A sensor that reaches beyond the body may be within a wall. Such poses are left out.
      if (ahead == 0.0 || cast(viewpoint.near, viewpoint.p, 1.0 / ahead * out, ahead) >= ahead)
        viewpoint.eyes.push_back(X_WS);
    }
    viewpoints.push_back(std::move(viewpoint));
  }
  return viewpoints;
}

maps::OccupancyGrid scans_from(const LaserSettings& laser, const maps::GridGeometry& geometry,
                               const std::vector<Viewpoint>& viewpoints) {
  maps::OccupancyGrid grid(geometry);
  std::vector<double> ranges(kBeams);
  const std::vector<glm::dvec2> beams = maps::beam_directions(laser.fov, kBeams);
  for (const Viewpoint& viewpoint : viewpoints)
    for (const Pose& X_WS : viewpoint.eyes) {
      for (std::uint32_t i = 0; i < kBeams; ++i)
        ranges[i] = cast(viewpoint.near, {X_WS.x, X_WS.y}, base::rotate(X_WS.yaw, beams[i]), laser.range_max);
      maps::add_scan(grid, {X_WS, ranges, beams, 0.0, laser.range_max});
    }
  return grid;
}

/// The point is in range and field of view of the laser and not occluded.
bool sees(const Viewpoint& viewpoint, const Pose& X_WS, const LaserSettings& laser, glm::dvec2 p) {
  const glm::dvec2 d = base::rotate(-X_WS.yaw, p - glm::dvec2{X_WS.x, X_WS.y});
  const double far = glm::length(d);
  if (far >= laser.range_max || std::abs(std::atan2(d.y, d.x)) > 0.5 * laser.fov) return false;
  if (far == 0.0) return true;
  const glm::dvec2 eye{X_WS.x, X_WS.y};
  return cast(viewpoint.near, eye, 1.0 / far * (p - eye), far) >= far;
}

/// Free cells whose centre is visible from no pose become unexplored: their line was rounded past a corner.
void forget_hidden(const LaserSettings& laser, const std::vector<Viewpoint>& viewpoints, maps::OccupancyGrid& grid) {
  const double reach = laser.range_max + std::hypot(laser.X_MS.x, laser.X_MS.y);
  std::vector<CellAt> open;
  for (std::int64_t row = 0; row < maps::rows(grid.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(grid.geometry); ++column)
      if (grid.at({column, row}) == Cell::free) open.push_back({column, row});
  for (const Viewpoint& viewpoint : viewpoints)
    std::erase_if(open, [&](CellAt at) {
      const glm::dvec2 p = maps::middle(grid.geometry, at);
      if (glm::length(p - viewpoint.p) >= reach) return false;
      return std::any_of(viewpoint.eyes.begin(), viewpoint.eyes.end(),
                         [&](const Pose& X_WS) { return sees(viewpoint, X_WS, laser, p); });
    });
  for (const CellAt at : open) grid.set(at, Cell::unexplored);
}

}  // namespace

RobotMap::RobotMap(const world::World& world, std::uint32_t mover, double cell)
    : mover_(mover), grid_(plan_over(world, cell)) {
  const std::vector<LaserSettings> lasers = lasers_of(world.movers[mover]);
  SF_CHECK(!lasers.empty(), "a map needs a laser: " + world.movers[mover].name);
  beams_ = maps::beam_directions(lasers[0].fov, lasers[0].samples);
  range_min_ = lasers[0].range_min;
  range_max_ = lasers[0].range_max;
}

void RobotMap::add(const base::ReadingBlock& reading) {
  if (reading.mover != mover_ || reading.type != sensors::kLaser || reading.sensor != 0) return;
  if (reading.values.size() != beams_.size()) return;
  maps::add_scan(grid_, {reading.X_WS, base::marked_values(reading, ranges_), beams_, range_min_, range_max_});
}

void add_scans(std::span<const base::ReadingBlock> readings, std::map<std::uint32_t, RobotMap>& maps) {
  if (maps.empty()) return;
  for (const base::ReadingBlock& reading : readings)
    if (const auto at = maps.find(reading.mover); at != maps.end()) at->second.add(reading);
}

maps::OccupancyGrid visible_area(const world::World& world, std::uint32_t mover, const maps::GridGeometry& geometry) {
  const std::vector<LaserSettings> lasers = lasers_of(world.movers[mover]);
  SF_CHECK(!lasers.empty(), "nothing is seen without a laser: " + world.movers[mover].name);
  const std::vector<Viewpoint> viewpoints = stands_of(world, mover, lasers[0], geometry);
  maps::OccupancyGrid grid = scans_from(lasers[0], geometry, viewpoints);
  forget_hidden(lasers[0], viewpoints, grid);
  return grid;
}

const maps::OccupancyGrid& VisibleArea::of(std::uint32_t mover, const maps::GridGeometry& geometry) {
  if (!grid_ || mover_ != mover || !(grid_->geometry == geometry)) grid_ = visible_area(world_, mover, geometry);
  mover_ = mover;
  return *grid_;
}

Coverage coverage_of(const maps::OccupancyGrid& map, const maps::OccupancyGrid& reference) {
  SF_CHECK(map.geometry == reference.geometry, "maps of two geometries cannot be compared");
  Coverage seen;
  for (std::int64_t row = 0; row < maps::rows(map.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(map.geometry); ++column) {
      if (reference.at({column, row}) != Cell::free) continue;
      ++seen.wanted;
      seen.missed += map.at({column, row}) == Cell::unexplored;
    }
  return seen;
}

std::string text_of(const Coverage& seen) { return fmt::format("{} of {}", seen.missed, seen.wanted); }

double disagreement(const maps::OccupancyGrid& map, const maps::OccupancyGrid& reference) {
  SF_CHECK(map.geometry == reference.geometry, "maps of two geometries cannot be compared");
  std::size_t both = 0, apart = 0;
  for (std::int64_t row = 0; row < maps::rows(map.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(map.geometry); ++column) {
      const Cell a = map.at({column, row}), b = reference.at({column, row});
      if (a == Cell::unexplored || b == Cell::unexplored) continue;
      ++both;
      apart += a != b;
    }
  return both == 0 ? 0.0 : static_cast<double>(apart) / static_cast<double>(both);
}

}  // namespace sf::scenarios
