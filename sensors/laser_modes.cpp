#include "sensors/laser_modes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/elementary.h"
#include "base/tilted_pose.h"
#include "raycast/ray_caster.h"
#include "scene/rasterizer.h"
#include "sensors/accuracy.h"

namespace sf::sensors {

namespace {

/// Settings of each mode.
struct ModeSettings {
  std::uint32_t skip = 1;  ///< one of this many beams is cast
  bool single = false;
};
constexpr ModeSettings kModeSettings[] = {{1}, {1, true}, {2}, {4}, {8}};
static_assert(std::size(kModeSettings) == std::size(kLaserModes));

}  // namespace

CastLaser cast_laser(const world::World& world, const LaserSettings& laser) {
  const std::uint8_t row = mode_of("laser", kLaserModes, laser.accuracy, world);
  const ModeSettings& mode_settings = kModeSettings[row];
  CastLaser cast{laser, mode_settings.single, row, {}};
  cast.laser.resolution = std::min(laser.resolution * mode_settings.skip, std::max(1u, laser.samples - 1));
  const double step = laser.samples > 1 ? laser.fov / (laser.samples - 1) : 0.0;
  for (std::uint32_t k = 0; mode_settings.skip > 1 && k <= cast.laser.resolution; ++k)
    cast.sines.push_back(base::sin(k * step));
  return cast;
}

base::RigidTransform laser_mount(const SensorSet& sensor_set, const base::ReadingBlock& reading) {
  return mount_of(sensor_set.settings_of<CastLaser>(reading.type, reading.mover)[reading.sensor].laser);
}

Reaches reaches_of(const world::World& world) {
  Reaches reaches;
  const auto add = [&](const world::Segment& s) { reaches.longest = std::max(reaches.longest, length(s.b - s.a)); };
  for (const world::Segment& wall : world.walls) add(wall);
  for (const world::Mover& mover : world.movers) std::for_each(mover.body.begin(), mover.body.end(), add);
  const world::Extent& e = world.extent;
  reaches.farthest = std::max({std::abs(e.x_min), std::abs(e.x_max), std::abs(e.y_min), std::abs(e.y_max)});
  return reaches;
}

double laser_bound(double range_max, bool single, double longest, double farthest) {
  return raycast::exact_bound(range_max, longest, farthest) + (single ? raycast::single_bound(range_max) : 0.0);
}

ErrorBound bound_of_laser(const world::World& world, const ParsedSensors& sensors, std::size_t row) {
  const CastLaser& cast = sensors.settings_as<CastLaser>()[row];
  const Reaches reaches = reaches_of(world);
  const double planar =
      laser_bound(cast.laser.range_max, cast.single, reaches.longest, reaches.farthest + cast.laser.range_max);
  const bool in_scene = !world.terrain.empty() || cast.laser.scan_time > 0.0 || !base::is_level(cast.laser.tilt) ||
                        !world.movers[sensors.rows[row].mover].dynamics.name.empty();
  return {in_scene ? std::max(planar, scene::kRangeError) : planar,
          "cast beams that do not graze and are not nearer than range_min; the others are flagged"};
}

}  // namespace sf::sensors
