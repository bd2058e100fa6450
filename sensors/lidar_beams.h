#pragma once
// World-file settings of lidars: where their beams point, and presets of real devices.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/rigid_transform.h"
#include "scene/beam_pattern.h"
#include "sensors/lidar_echoes.h"
#include "world/world.h"

namespace sf::sensors {

inline constexpr std::uint32_t kMostLidarBeams =
    world::kMostTableBeams;  ///< of one lidar, parts of diverging beams included
inline constexpr std::uint32_t kMostBeamParts = 64;
inline constexpr std::size_t kMostBeamTimes = 10'000;  ///< different ones in a rolling scan
inline constexpr std::uint32_t kMostChannels = 1'024;
inline constexpr double kLongestLidarRange = 1e5;  ///< [m]

/// Beams of all lidars with the same settings.
struct LidarBeams {
  std::vector<glm::dvec3> directions;  ///< unit vectors in the sensor's frame; ring by ring, each counter-clockwise
  std::vector<double> times;           ///< [s] <= 0, per beam, relative to the reading; empty: all are cast at its time
  std::uint32_t channels = 1;          ///< rings; beams per ring: directions.size() / channels
  std::uint32_t parts = 1;             ///< per beam
  std::vector<std::uint32_t> cast;     ///< beams that are cast, ascending; empty: all
  std::vector<glm::dvec2> between;     ///< of the other beams: weights, as interpolation_weights (lidar_modes.h)
  std::vector<glm::dvec3> part_directions;  ///< of all parts of the cast beams, beam by beam; empty: `directions`
  scene::BeamPattern pattern;               ///< of the parts, which have their places in all, or
  bool in_place = false;                    ///< those of their beams

  /// [ns] from the first beam of a rolling scan to its reading; 0: all are cast at once.
  std::int64_t duration() const;
  const std::vector<glm::dvec3>& cast_directions() const {
    return part_directions.empty() ? directions : part_directions;
  }
  /// Directions by the pattern's places.
  const std::vector<glm::dvec3>& placed_directions() const { return in_place ? directions : cast_directions(); }
};

/// Settings of one lidar.
struct LidarSettings {
  base::RigidTransform X_MS;  ///< sensor in the mover's frame
  EchoSettings echo;          ///< range_max is at most kLongestLidarRange
  std::uint8_t mode = 0;      ///< row of kLidarModes
  std::shared_ptr<const LidarBeams> beams;
};

inline constexpr std::string_view kLidarKeys[] = {
    "preset",    "channels",  "columns",         "fov",     "fov_v",      "range_min",  "elevations", "azimuth_offsets",
    "range",     "range_max", "noise",           "pose6",   "directions", "rolling",    "scan_time",  "intensity",
    "incidence", "returns",   "intensity_range", "detects", "dropout",    "divergence", "beam_parts", "separation"};

/// Bounds the beams of all sensors of a kind in a world, and what they may meet (require_mesh_places).
class BeamBudget {
 public:
  static constexpr std::size_t kMost = 100'000'000;
  /// @param sensors in the plural  @param fewer remedies for an error, in its words
  BeamBudget(const world::World& world, std::string_view sensors, std::string_view fewer)
      : world_(world), sensors_(sensors), fewer_(fewer) {}
  /// @throws base::InputError, at the key, if there are more than kMost now, and for too many triangles of meshes
  void add(const world::Sensor& sensor, std::string_view key, std::size_t beams);

 private:
  const world::World& world_;
  std::string_view sensors_, fewer_;
  std::size_t used_ = 0;
};

/// Reads the settings of lidars. Lidars with equal beams share them.
class LidarReader {
 public:
  /// @throws base::InputError with file and line for invalid settings
  LidarSettings read(const world::World& world, const world::Sensor& sensor);

 private:
  /// @param skip casts every so many columns of rings
  std::shared_ptr<const LidarBeams> beams_of(const world::World& world, const world::Sensor& sensor,
                                             std::uint32_t skip);

  /// With their description.
  std::vector<std::pair<std::vector<double>, std::shared_ptr<const LidarBeams>>> known_;
};

}  // namespace sf::sensors
