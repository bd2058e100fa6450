#include "world/free_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string>

#include "base/error.h"
#include "base/random.h"
#include "world/ros_map.h"
#include "world/wall_tree.h"

namespace sf::world {

namespace {

constexpr double kMaxCells = 2000.0;       // cells of the coarse grid per axis
constexpr double kOpenWorld = 10.0;        // [m] smallest searched distance around the first robot
constexpr std::uint32_t kAttempts = 4000;  // draws per copy; random packing is full long before that

double clear_radius(const Mover& robot) { return robot.radius + kPlaceMargin; }

struct Heights {
  double min = HUGE_VAL, max = -HUGE_VAL;  // [m]
  bool meet(const Segment& wall) const { return wall.z_min < max && min < wall.z_max; }
};

Heights heights_of(const Mover& robot, double z) {
  Heights heights;
  for (const Segment& s : robot.body)
    heights = {std::min(heights.min, s.z_min + z), std::max(heights.max, s.z_max + z)};
  return heights;
}

// For placement, the border of a map's known area is a wall without `solid_left`.
std::vector<Segment> walls_at_height(const World& world, const Mover& robot, std::span<const Segment> known) {
  const Heights heights = heights_of(robot, robot.X_WM.z);
  std::vector<Segment> walls;
  for (const Segment& wall : world.walls) {
    const bool matters = wall.stops_robots || wall.seen_by_laser;
    // On terrain, robots and walls stand at any height.
    if (matters && (!world.terrain.empty() || heights.meet(wall))) walls.push_back(wall);
  }
  for (const Segment& edge : known) {
    walls.push_back(edge);
    walls.back().solid_left = false;
  }
  return walls;
}

bool clear_of_walls(const WallTree& walls, glm::dvec2 p, double radius) {
  return !walls.any(box_around(p, radius), [&](const Segment& w) { return distance(p, w.a, w.b) < radius; });
}

bool wall_between(const WallTree& walls, glm::dvec2 p, glm::dvec2 q) {
  return walls.any(box_of(p, q), [&](const Segment& w) { return segments_meet(p, q, w.a, w.b); });
}

bool in_solid(const WallTree& walls, glm::dvec2 p) {
  return winding_number(walls, p, [](const Segment&) { return true; }) != 0;
}

bool is_known(std::span<const Segment> known, glm::dvec2 p) { return known.empty() || winding_number(known, p) != 0; }

// ---- The coarse grid and the reachable region.

struct Region {
  glm::dvec2 corner;  // [m] lower left
  double cell = 0.0;  // [m]
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  std::vector<std::uint32_t> cells;  // reachable cells, in a fixed order

  glm::dvec2 centre(std::uint32_t at) const {
    return {corner.x + (at % columns + 0.5) * cell, corner.y + (at / columns + 0.5) * cell};
  }
};

// Builds a grid whose cells have half the size of the robot's circle. Cells are larger in large worlds, but never wider
// than the circle. Two neighbouring clear centres then have no wall between them: each point between them is within the
// circle's radius of one centre.
Region grid_over(const WallTree& walls, const Mover& robot) {
  const glm::dvec2 p{robot.X_WM.x, robot.X_WM.y};
  Box box = base::united(box_around(p, kOpenWorld), walls.extent());
  const double radius = clear_radius(robot);
  const Box most = box_around(p, 2.0 * radius * kMaxCells / 2.0);
  box.min = {std::max(box.min.x, most.min.x), std::max(box.min.y, most.min.y)};
  box.max = {std::min(box.max.x, most.max.x), std::min(box.max.y, most.max.y)};

  const glm::dvec2 size = box.max - box.min;
  Region region{.corner = box.min};
  region.cell = std::max(0.5 * radius, std::sqrt(size.x * size.y) / kMaxCells);
  region.columns = static_cast<std::uint32_t>(std::ceil(size.x / region.cell));
  region.rows = static_cast<std::uint32_t>(std::ceil(size.y / region.cell));
  return region;
}

enum class Cell : std::uint8_t { unknown, blocked, reached };

// Appends the cells reachable from `first` to region.cells. Tests cells when the flood fill reaches them.
void flood(Region& region, std::vector<Cell>& state, const WallTree& walls, double radius, std::uint32_t first) {
  std::size_t next = region.cells.size();
  const auto visit = [&](std::uint32_t to) {
    if (state[to] != Cell::unknown) return;
    if (!clear_of_walls(walls, region.centre(to), radius)) {
      state[to] = Cell::blocked;
      return;
    }
    state[to] = Cell::reached;
    region.cells.push_back(to);
  };
  for (visit(first); next < region.cells.size(); ++next) {
    const std::uint32_t at = region.cells[next];
    if (at % region.columns > 0) visit(at - 1);
    if (at % region.columns + 1 < region.columns) visit(at + 1);
    if (at >= region.columns) visit(at - region.columns);
    if (at / region.columns + 1 < region.rows) visit(at + region.columns);
  }
}

// Returns the nearest clear cell without a wall between its centre and p, or kNone.
std::uint32_t cell_near(const Region& region, const WallTree& walls, double radius, glm::dvec2 p) {
  const double reach = 2.0 * radius + region.cell;
  const auto index = [&](double v, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(v / region.cell), 0.0, count - 1.0));
  };
  std::uint32_t nearest = kNone;
  double least = HUGE_VAL;
  for (std::uint32_t y = index(p.y - reach - region.corner.y, region.rows);
       y <= index(p.y + reach - region.corner.y, region.rows); ++y) {
    for (std::uint32_t x = index(p.x - reach - region.corner.x, region.columns);
         x <= index(p.x + reach - region.corner.x, region.columns); ++x) {
      const glm::dvec2 centre = region.centre(y * region.columns + x);
      const double away = length(centre - p);
      if (away >= least || !clear_of_walls(walls, centre, radius) || wall_between(walls, p, centre)) continue;
      least = away;
      nearest = y * region.columns + x;
    }
  }
  return nearest;
}

// Returns true for a region that is not enclosed: it reaches the border of the searched area or of a map's known area.
bool is_open(const Region& region, const Box& known, double radius) {
  const double reach = radius + 1.5 * region.cell;
  return std::any_of(region.cells.begin(), region.cells.end(), [&](std::uint32_t at) {
    const std::uint32_t x = at % region.columns, y = at / region.columns;
    const glm::dvec2 p = region.centre(at);
    return x == 0 || y == 0 || x + 1 == region.columns || y + 1 == region.rows ||
           (known.min.x <= known.max.x &&
            std::min({p.x - known.min.x, p.y - known.min.y, known.max.x - p.x, known.max.y - p.y}) < reach);
  });
}

// Selects the largest enclosed region, unless an open region is a hundred times larger.
void take_largest(std::span<const Segment> known, Region& region, std::vector<Cell>& state, const WallTree& walls,
                  double radius) {
  const Box all_known = box_of(known);
  std::vector<std::uint32_t> inside, outside;
  for (std::uint32_t at = 0; at < state.size(); ++at) {
    if (state[at] != Cell::unknown) continue;
    region.cells.clear();
    flood(region, state, walls, radius, at);
    std::vector<std::uint32_t>& largest = is_open(region, all_known, radius) ? outside : inside;
    if (region.cells.size() <= largest.size()) continue;
    const glm::dvec2 p = region.centre(at);
    if (!in_solid(walls, p) && is_known(known, p)) largest.swap(region.cells);
  }
  region.cells.swap(100 * inside.size() > outside.size() ? inside : outside);
}

Region reachable(std::span<const Segment> known, const WallTree& walls, const Mover& robot) {
  Region region = grid_over(walls, robot);
  const double radius = clear_radius(robot);
  const glm::dvec2 p{robot.X_WM.x, robot.X_WM.y};
  std::vector<Cell> state(static_cast<std::size_t>(region.columns) * region.rows, Cell::unknown);
  const bool free = !in_solid(walls, p) && is_known(known, p);
  const std::uint32_t first = free ? cell_near(region, walls, radius, p) : kNone;
  if (first != kNone) {
    flood(region, state, walls, radius, first);
  } else {
    take_largest(known, region, state, walls, radius);
  }
  return region;
}

// ---- Random placement, one pose after another.

// Points in hash buckets, so memory depends on the number of copies and not on the extent of the world.
class PlacedRobots {
 public:
  PlacedRobots(std::size_t count, double apart) : apart_(apart), heads_(2 * count + 1, kNone) {}

  bool clear(glm::dvec2 p) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        for (std::uint32_t k = heads_[bucket(p, dx, dy)]; k != kNone; k = next_[k]) {
          if (length(points_[k] - p) < apart_) return false;
        }
      }
    }
    return true;
  }
  void add(glm::dvec2 p) {
    const std::size_t at = bucket(p, 0, 0);
    next_.push_back(heads_[at]);
    heads_[at] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
  }

 private:
  std::size_t bucket(glm::dvec2 p, int dx, int dy) const {
    const auto x = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(p.x / apart_)) + dx);
    const auto y = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(p.y / apart_)) + dy);
    return static_cast<std::size_t>(((x * 0x9E3779B97F4A7C15u + y) * 0xBF58476D1CE4E5B9u >> 20) % heads_.size());
  }
  double apart_;  // [m] smallest distance between two copies
  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;
  std::vector<glm::dvec2> points_;
};

bool clear_of_tags(std::span<const Disc> tags, glm::dvec2 p, double radius) {
  return std::none_of(tags.begin(), tags.end(),
                      [&](const Disc& tag) { return length(tag.p - p) < radius + tag.radius; });
}

// Returns the floor plan or map: a picture whose area is at least half of the walls' extent. Null: none.
const Model* plan_of(const World& world) {
  const Box box = box_of(world.walls);
  const glm::dvec2 size = box.max - box.min;
  for (const Model& model : world.models)
    if (model.is_bitmap && model.mover == kNone && 2.0 * model.size.x * model.size.y >= size.x * size.y) return &model;
  return nullptr;
}

std::vector<Segment> stopping(const World& world) {
  std::vector<Segment> walls;
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls),
               [](const Segment& wall) { return wall.stops_robots; });
  return walls;
}

// Returns the first model with a wall that the robot's outline would cross at that pose, or kNone. The outline is
// shrunk slightly, so contact does not count.
std::uint32_t model_in(const WallTree& walls, const Mover& robot, const Pose& X_WM) {
  const Heights heights = heights_of(robot, X_WM.z);
  std::uint32_t first = kNone;
  walls.any(box_around({X_WM.x, X_WM.y}, robot.radius), [&](const Segment& wall) {
    if (!heights.meet(wall) || wall.model >= first) return false;
    for (const Segment& side : robot.body)
      if (side.stops_robots &&
          segments_meet(transform(X_WM, 0.98 * side.a), transform(X_WM, 0.98 * side.b), wall.a, wall.b))
        first = wall.model;
    return false;
  });
  return first;
}

}  // namespace

PlaceCheck::PlaceCheck(const World& world)
    : world_(world),
      ground_(world.ramps, world.terrain),
      walls_(stopping(world)),
      known_(known_free(world)),
      plan_(plan_of(world)) {}

std::string PlaceCheck::problem(const Mover& robot, const Pose& X_WM) const {
  const glm::dvec2 p{X_WM.x, X_WM.y};
  if (plan_ != nullptr) {
    const glm::dvec2 at = base::rotate(-plan_->X_WM.yaw, p - glm::dvec2{plan_->X_WM.x, plan_->X_WM.y});
    if (2.0 * std::abs(at.x) > plan_->size.x || 2.0 * std::abs(at.y) > plan_->size.y)
      return "outside '" + plan_->name + "'";
  }
  const Heights heights = heights_of(robot, X_WM.z);
  if (winding_number(walls_, p, [&](const Segment& wall) { return heights.meet(wall); }) != 0) return "within a wall";
  const std::uint32_t model = model_in(walls_, robot, X_WM);
  if (model != kNone) return "partly in a wall of '" + world_.models[model].name + "'";
  return is_known(known_, p) ? "" : "in the unknown area of the map";
}

std::string PlaceCheck::start_problem(const Mover& robot) const {
  const Pose& X = robot.X_WM;
  std::string where = robot.is_tag ? "" : problem(robot, X);
  const bool moves_in_height = !robot.dynamics.name.empty();
  if (where.empty() && moves_in_height && X.z < ground_.height({X.x, X.y}, X.z) - 0.1)
    where = fmt::format("{:g} m high, below the ground", X.z);
  return where.empty() ? ""
                       : fmt::format("'{}' starts at ({:g}, {:g}), {}; expected a 'pose' in free space", robot.name,
                                     X.x, X.y, where);
}

std::vector<Disc> places_of_tags(std::span<const Mover> movers) {
  std::vector<Disc> places;
  for (const Mover& mover : movers)
    if (mover.is_tag && !mover.absent) places.push_back({{mover.X_WM.x, mover.X_WM.y}, mover.radius});
  return places;
}

struct FreeSpace::Area {
  WallTree walls;
  Region region;
  std::string file, name;  // of the world, of the robot
  double radius, clear;    // [m]
  Pose start;              // of the robot
};

FreeSpace::FreeSpace(const World& world, const Mover& robot) {
  const std::vector<Segment> known = known_free(world);
  WallTree walls(walls_at_height(world, robot, known));
  Region region = reachable(known, walls, robot);
  area_ = std::make_unique<const Area>(
      Area{std::move(walls), std::move(region), world.file, robot.name, robot.radius, clear_radius(robot), robot.X_WM});
}

FreeSpace::FreeSpace(FreeSpace&&) noexcept = default;
FreeSpace& FreeSpace::operator=(FreeSpace&&) noexcept = default;
FreeSpace::~FreeSpace() = default;

std::vector<Pose> FreeSpace::poses(const World& world, std::uint32_t count, std::uint64_t seed,
                                   std::span<const Disc> tags) const {
  const Area& area = *area_;
  const Region& region = area.region;
  const Ground ground(world.ramps, world.terrain);
  PlacedRobots crowd(std::min<std::size_t>(count, region.cells.size()), 2.0 * area.radius + kPlaceMargin);
  std::vector<Pose> poses;
  const auto draw = [&](std::uint32_t k) {
    for (std::uint32_t attempt = 0; attempt < kAttempts && !region.cells.empty(); ++attempt) {
      const base::RandomKey key{.seed = seed, .stream = base::RandomStream::placement, .a = k, .b = attempt};
      const auto [which, turn] = base::random_uniform(key, 0);
      const auto [x, y] = base::random_uniform(key, 1);
      const glm::dvec2 centre =
          region.centre(region.cells[static_cast<std::size_t>(which * static_cast<double>(region.cells.size()))]);
      const glm::dvec2 p = centre + region.cell * glm::dvec2{x - 0.5, y - 0.5};
      if (!clear_of_walls(area.walls, p, area.clear) || !clear_of_tags(tags, p, area.clear) || !crowd.clear(p))
        continue;
      crowd.add(p);
      poses.push_back(ground.stand(area.start, {p.x, p.y, 0.0, M_PI * (2.0 * turn - 1.0)}));
      return true;
    }
    return false;
  };
  for (std::uint32_t k = 0; k < count; ++k) {
    if (draw(k)) continue;
    throw base::InputError(area.file, 0,
                           "placed " + std::to_string(k) + " of " + std::to_string(count) + " robots like '" +
                               area.name + "': no free space is left; make the world larger or request fewer");
  }
  return poses;
}

std::vector<Pose> free_poses(const World& world, const Mover& robot, std::uint32_t count, std::uint64_t seed) {
  return FreeSpace(world, robot).poses(world, count, seed, places_of_tags(world.movers));
}

}  // namespace sf::world
