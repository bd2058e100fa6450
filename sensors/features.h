#pragma once
// Features: lines, corners, clusters and tags in the readings of one sensor, as a derived sensor (docs/derived.md).
//
// In a world file, inside a robot:
//   derived( type "features"  inputs ["laser"]  rate 10  most 16  shortest 0.3  widest 1  objects [4.2 1.7] )
// Input: one laser, lidar, camera, sonar, infrared or fiducial of the same robot. `most`: rows of a reading.
// `shortest`: [m] shorter straight pieces are no lines. `widest`: [m] wider remains are no clusters. `objects`: [m]
// length and width of objects, to which clusters are completed that fit; default: there are none. Of a lidar or of a
// camera's depths, features are those of the nearest echoes above the ground (sensors/beam_columns.h).
//
// A reading is `most` rows, the nearest feature to the sensor first: x and y in the frame of the robot, direction,
// `valid`, their covariance, then kind (estimation::FeatureKind), half length, id of a tag, and age: the time since the
// measurement. It has the features of the newest input reading since the last one; without any, no row is valid. Of
// sonars that fire in turn, it has the echoes of the transducers that fired since the last one.

#include "robots/estimation/scan_features.h"
#include "sensors/derived/derived_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kFeatures = 38;  ///< wire id

/// Columns of a row, also of other derived sensors' inputs.
inline constexpr std::string_view kFeatureColumns[] = {"x_m", "y_m", "direction_rad", "valid"};
inline constexpr std::size_t kFeatureNumbers = 14, kFeatureCovarianceAt = 4, kFeatureKindAt = 10;
inline constexpr std::uint32_t kMostFeatures = 22;  ///< rows: one datagram

/// Returns the features of one reading of one sensor.
class FeatureSource {
 public:
  virtual ~FeatureSource() = default;
  /// Valid until the next call.
  virtual std::span<const estimation::Feature> find(const sensorfarm::Reading& reading) = 0;
};
/// @return null for sensors other than lasers, lidars with rings, cameras, sonars, infrareds and fiducials
/// @throws base::InputError for invalid settings
std::unique_ptr<FeatureSource> feature_source(const world::World& world, const WiredInput& input,
                                              const estimation::FeatureOptions& options);

extern const SensorType features_type;

}  // namespace sf::sensors
