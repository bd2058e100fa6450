#pragma once
// Hand-made magnets and magnetometers for tests and benchmarks, with analytic fields.

#include <cmath>
#include <span>
#include <vector>

#include "base/reading.h"
#include "sensors/magnetic_field/magnetic_field.h"
#include "tests/sensors/chance.h"
#include "world/world.h"

namespace sf::scenes {

inline world::Magnet magnet(glm::dvec2 p, double z = 0.0, double moment = 1.0, double radius = 0.0125) {
  return {p, z, moment, radius, 0};
}

/// Returns `count` magnets of 1 A m^2 along x, `spacing` [m] apart, the middle one at the origin.
inline world::World line(std::uint32_t count, double spacing) {
  world::World world;
  for (std::uint32_t i = 0; i < count; ++i) world.magnets.push_back(magnet({(i - 0.5 * (count - 1)) * spacing, 0.0}));
  return world;
}

/// Returns `count` magnets at random in a square of `side` [m] around the origin, all with north up, or in both
/// directions.
inline world::World sheet(std::uint32_t count, double side, std::uint64_t seed, bool both_ways = false) {
  world::World world;
  trial::Chance chance(seed);
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::dvec2 p = chance.in_square(0.5 * side);
    const bool down = both_ways && chance.below(2) == 1;
    world.magnets.push_back(magnet(p, chance.between(-0.02, 0.02), down ? -1.0 : 1.0));
  }
  return world;
}

inline world::Setting setting(const std::string& key, std::vector<double> numbers) {
  return {key, std::move(numbers), "", 1, "made.world"};
}

inline world::Setting text(const std::string& key, const std::string& value) {
  return {key, {}, value, 1, "made.world"};
}

/// Returns an array with the given elements, at `height` [m] above its mover's base, without noise.
inline world::Sensor array(const std::vector<base::Pose>& elements, double height = 0.2) {
  world::Sensor sensor;
  sensor.type = "magnetometer";
  sensor.name = "array";
  sensor.X_MS = {0.0, 0.0, height, 0.0};
  sensor.file = "made.world";
  sensor.line = 1;
  sensor.settings.push_back(setting("scount", {static_cast<double>(elements.size())}));
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const base::Pose& e = elements[i];
    sensor.settings.push_back(setting("spose3[" + std::to_string(i) + "]", {e.x, e.y, e.z, e.yaw}));
  }
  return sensor;
}

/// Returns the thesis' array of five across the robot, 0.20 m ahead, the first one on the right, for a robot that faces
/// +x.
inline world::Sensor five(double height = 0.2) {
  std::vector<base::Pose> elements;
  for (int i = 0; i < 5; ++i) elements.push_back({0.20, 0.075 * (i - 2), 0.0, 0.0});
  return array(elements, height);
}

/// Adds a robot without a body that carries `sensor`.
inline std::uint32_t add_carrier(world::World& world, const base::Pose& pose, const world::Sensor& sensor) {
  world::Mover mover;
  const auto number = static_cast<std::uint32_t>(world.movers.size());
  mover.name = "carrier" + std::to_string(number);
  mover.id = number + 1;
  mover.model = static_cast<std::uint32_t>(world.models.size());
  mover.X_WM = pose;
  world.models.push_back({mover.name, "position"});
  world.models.back().mover = number;
  mover.sensors.push_back(sensor);
  world.movers.push_back(mover);
  return number;
}

/// One element of a reading [T].
struct Element {
  double field, x, y, z;
};
inline Element element(const base::ReadingBlock& reading, std::size_t e) {
  return {reading.values[4 * e], reading.values[4 * e + 1], reading.values[4 * e + 2], reading.values[4 * e + 3]};
}

using Real = long double;

/// A field [T] with more than 64 bits.
struct Exact {
  Real x = 0, y = 0, z = 0, magnitudes = 0;
};

/// Adds the thesis' equation 1, component by component as printed there. |B| is the root of the sum of these
/// components' squares. Inside a magnet's radius, the field is that at the radius.
inline void add_exact(const world::Magnet& m, const sensors::FieldPoint& place, Exact& sum) {
  Real x = Real{place.x} - m.p.x, y = Real{place.y} - m.p.y, z = Real{place.z} - m.z;
  Real r = std::sqrt(x * x + y * y + z * z);
  if (r == 0) z = r = 1e-30L;
  const Real grown = r < m.radius ? m.radius / r : 1;
  x *= grown, y *= grown, z *= grown, r *= grown;
  const Real k = 1e-7L * m.moment / (r * r * r * r * r);
  const Real bx = k * 3 * x * z, by = k * 3 * y * z, bz = k * (2 * z * z - x * x - y * y);
  sum.x += bx, sum.y += by, sum.z += bz;
  sum.magnitudes += std::sqrt(bx * bx + by * by + bz * bz);
}

/// Returns the sum over all static magnets, or over those within `cutoff` [m] along the ground.
inline Exact exact(const world::World& world, const sensors::FieldPoint& place, double cutoff = 0.0) {
  Exact sum;
  for (const world::Magnet& m : world.magnets) {
    const double dx = place.x - m.p.x, dy = place.y - m.p.y;
    if (cutoff == 0.0 || dx * dx + dy * dy <= cutoff * cutoff) add_exact(m, place, sum);
  }
  return sum;
}

inline double apart(const Exact& b, const sensors::FieldSum& a) {
  return static_cast<double>(std::hypot(b.x - a.x, b.y - a.y, b.z - a.z));
}
inline double magnitude(const Exact& b) { return static_cast<double>(std::hypot(b.x, b.y, b.z)); }
inline double magnitude(const sensors::FieldSum& b) { return std::hypot(b.x, b.y, b.z); }

}  // namespace sf::scenes
