#include "sensors/own_surroundings.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::sensors {

namespace {

constexpr double kPieceOfLoop = 1.0;          // [m] smallest length of a ray whose box is searched in one step
constexpr double kMostOutlinePieces = 256.0;  // largest number of pieces of a ray

std::vector<world::Segment> seen_by_lasers(const world::World& world) {
  std::vector<world::Segment> walls;
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls),
               [](const world::Segment& wall) { return wall.seen_by_laser; });
  return walls;
}

}  // namespace

/// A ray and its first hit.
struct OwnSurroundings::Nearest {
  std::uint32_t self;
  base::Pose from;
  glm::dvec2 origin, direction;
  raycast::ClosestHit best;
  std::uint32_t model = base::kNoHit;

  /// Ids are models. A tie between two models is resolved in favour of the smaller number.
  void meet(glm::dvec2 a, glm::dvec2 b, std::uint32_t id) {
    raycast::intersect({{a.x, a.y, b.x, b.y}, id}, origin, direction, best);
    model = best.id;
  }
  glm::dvec2 at(double t) const { return origin + t * direction; }
};

OwnSurroundings::OwnSurroundings(const raycast::SensorContext& context)
    : world_(context.world), copies_(context.world), states_(context.states), walls_(seen_by_lasers(context.world)) {
  for (const world::Mover& mover : world_.movers) largest_ = std::max(largest_, mover.radius);
}

void OwnSurroundings::place_movers() { grid_.build(states_, std::max(1.0, 2.0 * largest_), copies_); }

void OwnSurroundings::meet_walls(Nearest& nearest, double from, double to) const {
  base::Box box = base::box_of(nearest.at(from), nearest.at(to));
  // Larger than the rounding errors of both ends.
  const double margin = 1e-6 + 1e-12 * (std::abs(nearest.origin.x) + std::abs(nearest.origin.y) + to);
  box.min -= margin, box.max += margin;
  walls_.any(box, [&](const world::Segment& wall) {
    if (wall.z_min <= nearest.from.z && nearest.from.z < wall.z_max) nearest.meet(wall.a, wall.b, wall.model);
    return false;
  });
}

void OwnSurroundings::meet_movers(Nearest& nearest) const {
  const double reach = nearest.best.range + largest_;
  const auto meet = [&](std::uint32_t row) {
    const world::Mover& mover = world_.movers[row];
    const base::Pose& X_WM = states_[row].X_WM;
    if (row == nearest.self || base::is_absent(X_WM)) return false;
    const double height = nearest.from.z - X_WM.z;
    for (const world::Segment& side : mover.body)
      if (side.seen_by_laser && side.z_min <= height && height < side.z_max)
        nearest.meet(base::transform(X_WM, side.a), base::transform(X_WM, side.b), side.model);
    return false;
  };
  grid_.any(nearest.origin, reach, meet, copies_.copy_of(nearest.self));
}

sensorfarm::Hit OwnSurroundings::cast(std::uint32_t self, const base::Pose& from, double range) const {
  Nearest nearest{self, from, {from.x, from.y}, base::direction(from.yaw), {range}};
  const double piece = std::max(kPieceOfLoop, range / kMostOutlinePieces);
  for (double t = 0.0; t < nearest.best.range; t += piece)
    meet_walls(nearest, t, std::min(t + piece, nearest.best.range));
  meet_movers(nearest);
  return {nearest.best.range, nearest.model};
}

}  // namespace sf::sensors
