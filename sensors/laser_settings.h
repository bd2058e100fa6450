#pragma once
// World-file settings of lasers, in both dialects of Stage:
//
//   laser( samples 180 fov 180 range_min 0 range_max 8 )
//   ranger( sensor( samples 1 fov 6 range [0 5] ) ... )      each block is a laser
//   ranger( scount N spose[i] [x y yaw] ... sview [0 5 fov] )   each transducer is a laser of one beam

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/rigid_transform.h"
#include "raycast/beams.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Settings of one laser.
struct LaserSettings : raycast::ScanSettings {
  double rate = 10.0;         ///< [Hz] > 0
  double phase = 0.0;         ///< [s] time of the first reading
  double latency = 0.0;       ///< [s] from measurement to delivery
  double scan_time = 0.0;     ///< [s] from the first beam of a rolling scan to the end of the last; 0: all at once
  std::uint8_t priority = 5;  ///< as SensorSpec::priority
  world::Accuracy accuracy;
  std::uint32_t color = 0xFF0000FFu;  ///< 0xAARRGGBB, of the field of view in figures
  base::Tilt tilt = {};               ///< of the mount (`pose6`): X_MS and this are the sensor in the mover's frame
};

/// Keys of a laser, in addition to the common ones.
inline constexpr std::string_view kLaserKeys[] = {"fov", "samples", "range_min", "range_max", "laser_color", "noise",
                                                  "resolution", "rolling", "scan_time", "pose6",
                                                  // Stage's older name of `resolution`, with the same meaning
                                                  "laser_sample_skip"};
inline constexpr std::string_view kRangerKeys[] = {"scount", "sview", "spose[]", "spose3[]", "noise", "resolution",
                                                   "rolling", "scan_time",
                                                   // accepted but not modelled
                                                   "ssize", "sraycount"};
inline constexpr std::string_view kBlockKeys[] = {"range",      "view",    "fov",       "samples", "noise",
                                                  "resolution", "rolling", "scan_time", "pose6"};
inline constexpr world::SensorKeyword kLaserWord{"laser", kLaserKeys};
inline constexpr world::SensorKeyword kRangerWord{"ranger", kRangerKeys, kBlockKeys};

/// Returns true for types that are lasers. @param type of a world::Sensor
inline bool is_laser(std::string_view type) { return type == kLaserWord.type || type == kRangerWord.type; }
inline bool has_laser(const world::Mover& mover) {
  return std::any_of(mover.sensors.begin(), mover.sensors.end(), [](const auto& each) { return is_laser(each.type); });
}

/// Returns the lasers of a mover in file order, numbered as in readings. Neighbours with the same name, such as the
/// lasers of a ranger, are renamed `name[k]`. Worlds are parsed once, into a SensorSet.
/// @throws base::InputError with file and line for an invalid setting
std::vector<LaserSettings> lasers_of(const world::Mover& mover);

/// Returns the pose of a laser in the mover's frame.
inline base::RigidTransform mount_of(const LaserSettings& laser) { return base::transform_of(laser.X_MS, laser.tilt); }

/// Refuses a laser that is mounted tilted. @param use of its scans as planar ones, e.g. "an occupancy map"
/// @throws base::InputError
void require_level(const world::World& world, const LaserSettings& laser, std::string_view use);

/// Returns a laser as a sensor, for worlds built in code. `lasers_of` restores the same settings.
world::Sensor laser_sensor(const LaserSettings& laser);

/// Reads `noise [constant proportional angular]`; no noise if it is absent.
raycast::ScanNoise scan_noise_of(const world::Sensor& sensor);

}  // namespace sf::sensors
