#include "sensors/illumination.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "base/elementary.h"

namespace sf::sensors {

namespace {

using world::Lamp;
using world::Segment;

double range_of(const Lamp& lamp) { return std::max(kNearestLamp, std::sqrt(lamp.intensity / kFaintest)); }

base::BoxTree reaches_of_lamps(const world::World& world) {
  std::vector<base::Box> boxes;
  for (const Lamp& lamp : world.lamps) boxes.push_back(base::box_around({lamp.X_WL.x, lamp.X_WL.y}, range_of(lamp)));
  return base::BoxTree(boxes);
}

std::vector<Segment> walls_with_shadows(const world::World& world) {
  std::vector<Segment> walls;
  if (world.lamps.empty()) return walls;
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls),
               [](const Segment& wall) { return wall.seen_by_laser; });
  return walls;
}

}  // namespace

bool crosses_sight(const glm::dvec3& from, const glm::dvec3& to, const Segment& wall) {
  const glm::dvec2 along = wall.b - wall.a, start{from.x, from.y}, end{to.x, to.y};
  const double turn = base::cross(end - start, along);
  if (turn == 0.0 || !world::segments_meet(start, end, wall.a, wall.b)) return false;
  const double part = std::clamp(base::cross(wall.a - start, along) / turn, 0.0, 1.0);
  const double height = from.z + part * (to.z - from.z);
  return wall.z_min <= height && height < wall.z_max;
}

double illuminance_of(const Lamp& lamp, const glm::dvec3& p, glm::dvec2 normal) {
  const glm::dvec3 to{lamp.X_WL.x - p.x, lamp.X_WL.y - p.y, lamp.X_WL.z - p.z};
  const double distance = glm::length(to);
  if (distance > range_of(lamp)) return 0.0;
  const double bearing = base::wrap_angle(base::atan2(-to.y, -to.x) - lamp.X_WL.yaw);
  if (lamp.fov < 2.0 * M_PI && std::abs(bearing) > 0.5 * lamp.fov) return 0.0;
  const double cosine = distance > 0.0 ? (normal.x * to.x + normal.y * to.y) / distance : 1.0;
  const double far = std::max(distance, kNearestLamp);
  return std::max(0.0, cosine) * lamp.intensity / (far * far);
}

double reach_of_lamps(const world::World& world) {
  double reach = 0.0;
  for (const Lamp& lamp : world.lamps) reach = std::max(reach, range_of(lamp));
  return reach;
}

Illumination::Illumination(const world::World& world)
    : world_(world), walls_(walls_with_shadows(world)), reaches_(reaches_of_lamps(world)) {}

double Illumination::at(const base::Pose& X_WS, const base::Pose& X_SE) const {
  base::Pose X_WE = base::compose(X_WS, X_SE);
  X_WE.z = X_WS.z + X_SE.z;
  const glm::dvec3 p{X_WE.x, X_WE.y, X_WE.z};
  const glm::dvec2 normal = base::rotate(X_WE.yaw, {1.0, 0.0});
  double sum = world_.ambient_light;
  reaches_.any(base::box_around({p.x, p.y}, 0.0), [&](std::uint32_t i) {
    const Lamp& lamp = world_.lamps[i];
    const double light = illuminance_of(lamp, p, normal);
    const glm::dvec3 from{lamp.X_WL.x, lamp.X_WL.y, lamp.X_WL.z};
    const auto hides = [&](const Segment& wall) { return wall.model != lamp.model && crosses_sight(from, p, wall); };
    if (light > 0.0 && !walls_.any(base::box_of({p.x, p.y}, {from.x, from.y}), hides)) sum += light;
    return false;
  });
  return sum;
}

}  // namespace sf::sensors
