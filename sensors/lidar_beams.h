#pragma once
// World-file settings of lidars: where their beams point, and presets of real devices.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <memory>
#include <string_view>
#include <vector>

#include "base/rigid_transform.h"
#include "scene/beam_pattern.h"
#include "world/world.h"

namespace sf::sensors {

inline constexpr std::uint32_t kMostLidarBeams = 1'000'000;  ///< of one lidar
inline constexpr std::uint32_t kMostChannels = 1'024;
inline constexpr double kLongestLidarRange = 1e5;  ///< [m]

/// Beams of all lidars with the same settings.
struct LidarBeams {
  std::vector<glm::dvec3> directions;  ///< unit vectors in the sensor's frame; ring by ring, each counter-clockwise
  scene::BeamPattern pattern;
  std::uint32_t channels = 1;  ///< rings; beams per ring: directions.size() / channels
};

/// Settings of one lidar.
struct LidarSettings {
  base::RigidTransform X_MS;        ///< sensor in the mover's frame
  double range_min = 0.0;           ///< [m] in [0, range_max]
  double range_max = 100.0;         ///< [m] in (0, kLongestLidarRange]
  double range_sigma = 0.0;         ///< [m] >= 0, standard deviation of the range noise
  double range_proportional = 0.0;  ///< >= 0, its part that grows with the range
  std::shared_ptr<const LidarBeams> beams;
};

inline constexpr std::string_view kLidarKeys[] = {"preset", "channels",  "columns",    "fov",
                                                  "fov_v",  "range_min", "elevations", "azimuth_offsets",
                                                  "range",  "range_max", "noise",      "pose6"};

/// Reads the settings of lidars. Lidars with equal beams share them.
class LidarReader {
 public:
  /// @throws base::InputError with file and line for invalid settings
  LidarSettings read(const world::Sensor& sensor);

 private:
  std::shared_ptr<const LidarBeams> beams_of(const world::Sensor& sensor);

  /// With their description.
  std::vector<std::pair<std::vector<double>, std::shared_ptr<const LidarBeams>>> known_;
};

}  // namespace sf::sensors
