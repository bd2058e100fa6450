#include "scenarios/visible_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/hash.h"
#include "scenarios/sight.h"
#include "sensors/laser.h"
#include "world/wall_tree.h"

namespace sf::scenarios {

namespace {

using maps::Cell;
using maps::CellAt;
using sensors::SensorSpec;

std::vector<world::Segment> walls_where(const world::World& world, bool (*take)(const world::Segment&), double z_min,
                                        double z_max) {
  std::vector<world::Segment> walls;
  for (const world::Segment& wall : world.walls)
    if (take(wall) && wall.z_min <= z_max && wall.z_max > z_min) walls.push_back(wall);
  return walls;
}

/// [m] Returns the height of the robot's body above its origin.
double top_of(const world::Mover& robot) {
  double top = 0.0;
  for (const world::Segment& side : robot.body) top = std::max(top, side.z_max);
  return top;
}

/// Positions of a robot: cells whose centres its origin can reach, at least its radius from walls and connected to its
/// start.
struct Positions {
  maps::OccupancyGrid cells;     ///< free where reachable
  std::vector<CellAt> in_order;  ///< neighbours are adjacent in the list
  bool start_is_clear = false;
};

Positions positions_of(const world::World& world, std::uint32_t mover, const maps::GridGeometry& geometry) {
  const world::Mover& robot = world.movers[mover];
  const world::WallTree walls(walls_where(
      world, [](const world::Segment& w) { return w.stops_robots; }, robot.X_WM.z, robot.X_WM.z + top_of(robot)));
  const auto clear = [&](CellAt at) {
    const glm::dvec2 p = maps::middle(geometry, at);
    return !walls.any(world::box_around(p, robot.radius),
                      [&](const world::Segment& w) { return world::distance(p, w.a, w.b) < robot.radius; });
  };
  const CellAt start = maps::cell_at(geometry, {robot.X_WM.x, robot.X_WM.y});
  Positions positions{maps::OccupancyGrid(geometry), {}};
  if (!maps::contains(geometry, start)) return positions;
  positions.start_is_clear = clear(start);
  positions.cells.set(start, Cell::free);
  std::vector<CellAt>& found = positions.in_order = {start};
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const CellAt next{found[i].column + dc, found[i].row + dr};
      if (!maps::contains(geometry, next) || positions.cells.at(next) != Cell::unexplored || !clear(next)) continue;
      positions.cells.set(next, Cell::free);
      found.push_back(next);
    }
  return positions;
}

/// Returns the middle of the part of a segment within `reach` of the origin along each axis.
std::optional<glm::dvec2> middle_inside(glm::dvec2 a, glm::dvec2 b, double reach) {
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double d = b[axis] - a[axis];
    if (d == 0.0 && std::abs(a[axis]) > reach) return std::nullopt;
    if (d == 0.0) continue;
    const double enter = (std::copysign(-reach, d) - a[axis]) / d, leave = (std::copysign(reach, d) - a[axis]) / d;
    first = std::max(first, enter);
    last = std::min(last, leave);
  }
  if (first > last) return std::nullopt;
  return a + 0.5 * (first + last) * (b - a);
}

/// A cell, and a position from which a neighbouring cell is visible.
struct Candidate {
  CellAt at;
  CellAt robot;
};

/// Marks the visible cells. Expands from each of them to those within two cells, so that light passes through gaps.
class Survey {
 public:
  Survey(const world::World& world, std::uint32_t mover, const SensorSpec& laser, const Positions& positions,
         const std::function<void(double)>& progress)
      : positions_(positions),
        sight_(walls_seen(world, mover, laser), laser, positions.cells),
        tried_(positions.cells.geometry),
        seen_(positions.cells.geometry),
        progress_(progress) {}

  maps::OccupancyGrid run() {
    CellAt robot{};
    for (const CellAt at : positions_.in_order) {
      add(at, robot);
      while (!open_.empty()) {
        const Candidate next = open_.back();
        open_.pop_back();
        if (const auto by = look(next)) spread(next.at, robot = *by);
      }
    }
    return std::move(seen_);
  }

 private:
  static std::vector<world::Segment> walls_seen(const world::World& world, std::uint32_t mover,
                                                const SensorSpec& laser) {
    const double z = world.movers[mover].X_WM.z + laser.X_MS.z;
    return walls_where(
        world, [](const world::Segment& w) { return w.seen_by_laser; }, z, z);
  }

  void add(CellAt at, CellAt robot) {
    if (!maps::contains(tried_.geometry, at) || tried_.at(at) != Cell::unexplored) return;
    tried_.set(at, Cell::free);
    open_.push_back({at, robot});
    constexpr std::size_t kBetween = 4096;
    if (progress_ && ++count_ % kBetween == 0)
      progress_(static_cast<double>(count_) / static_cast<double>(16 * seen_.words.size()));
  }

  void spread(CellAt at, CellAt robot) {
    constexpr int kNear = 2;
    for (int dr = -kNear; dr <= kNear; ++dr)
      for (int dc = -kNear; dc <= kNear; ++dc) add({at.column + dc, at.row + dr}, robot);
  }

  std::optional<CellAt> find(glm::dvec2 p, CellAt robot) {
    return sight_.sees(robot, p) ? std::optional(robot) : sight_.find(p);
  }

  /// Marks the cell as occupied if a wall in it is visible, and as free if its centre is.
  /// @return a position that sees it
  std::optional<CellAt> look(const Candidate& candidate) {
    const maps::GridGeometry& grid = seen_.geometry;
    const glm::dvec2 centre = maps::middle(grid, candidate.at);
    std::optional<CellAt> by;
    const bool occupied =
        sight_.walls().any(world::box_around(centre, 0.5 * grid.cell), [&](const world::Segment& wall) {
          const std::optional<glm::dvec2> inside = middle_inside(wall.a - centre, wall.b - centre, 0.5 * grid.cell);
          if (!inside) return false;
          const glm::dvec2 p = centre + *inside;
          return maps::cell_at(grid, p) == candidate.at && (by = find(p, candidate.robot)).has_value();
        });
    if (!occupied) by = find(centre, candidate.robot);
    if (by) seen_.set(candidate.at, occupied ? Cell::occupied : Cell::free);
    return by;
  }

  const Positions& positions_;
  Sight sight_;
  maps::OccupancyGrid tried_, seen_;
  std::vector<Candidate> open_;
  const std::function<void(double)>& progress_;
  std::size_t count_ = 0;  ///< candidates
};

/// All inputs of a visible area other than walls, grid and positions. [m], [rad]
using Shape = std::array<double, 9>;

Shape shape_of(const world::Mover& m, const SensorSpec& l) {
  return {m.radius, m.X_WM.z, top_of(m), l.X_MS.x, l.X_MS.y, l.X_MS.z, l.X_MS.yaw, l.fov, l.limit};
}

std::uint64_t hash_of_walls(const world::World& world) {
  std::uint64_t hash = world.walls.size();
  for (const world::Segment& w : world.walls) {
    const double fields[] = {
        w.a.x, w.a.y, w.b.x, w.b.y, w.z_min, w.z_max, w.seen_by_laser ? 1.0 : 0.0, w.stops_robots ? 1.0 : 0.0};
    hash = base::hash_bytes(fields, sizeof fields, hash);
  }
  return hash;
}

}  // namespace

struct SeenArea {
  std::uint64_t walls = 0;
  Shape shape{};
  CellAt start;
  Positions positions;
  maps::OccupancyGrid seen;

  bool is_for(std::uint64_t other_walls, const Shape& other, const maps::GridGeometry& geometry, CellAt from) const {
    if (walls != other_walls || shape != other || !(seen.geometry == geometry)) return false;
    // The first start is reachable from another one if it is clear.
    return from == start ||
           (positions.start_is_clear && maps::contains(geometry, from) && positions.cells.at(from) == Cell::free);
  }
};

namespace {

/// Shared by the process, for the jobs of a sweep.
constexpr std::size_t kMostAreas = 8;
std::mutex shared_areas_mutex;
std::deque<std::shared_ptr<const SeenArea>> shared_areas;

}  // namespace

maps::OccupancyGrid visible_area(const world::World& world, std::uint32_t mover, const maps::GridGeometry& geometry,
                                 const std::function<void(double)>& progress) {
  const sensors::SensorSet sensor_set(world);
  return VisibleArea(world, sensor_set).of(mover, geometry, progress);
}

VisibleArea::VisibleArea(const world::World& world, const sensors::SensorSet& sensor_set)
    : world_(world), sensor_set_(sensor_set), walls_(hash_of_walls(world)) {}

const maps::OccupancyGrid& VisibleArea::of(std::uint32_t mover, const maps::GridGeometry& geometry,
                                           const std::function<void(double)>& progress) {
  const world::Mover& robot = world_.movers[mover];
  const CellAt start = maps::cell_at(geometry, {robot.X_WM.x, robot.X_WM.y});
  const auto lasers = sensor_set_.of(sensors::kLaser, mover);
  SF_CHECK(!lasers.empty(), "nothing is seen without a laser: " + robot.name);
  const Shape shape = shape_of(robot, lasers.front());
  {
    const std::lock_guard lock(shared_areas_mutex);
    for (const auto& area : shared_areas)
      if (area->is_for(walls_, shape, geometry, start)) return used_.emplace_back(area)->seen;
  }
  Positions positions = positions_of(world_, mover, geometry);
  maps::OccupancyGrid seen = Survey(world_, mover, lasers.front(), positions, progress).run();
  used_.push_back(std::make_shared<SeenArea>(SeenArea{walls_, shape, start, std::move(positions), std::move(seen)}));
  const std::lock_guard lock(shared_areas_mutex);
  shared_areas.push_back(used_.back());
  if (shared_areas.size() > kMostAreas) shared_areas.pop_front();
  return used_.back()->seen;
}

}  // namespace sf::scenarios
