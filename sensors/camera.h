#pragma once
// Cameras: depth, labels and normals of what each pixel sees, in the scene of lidars (docs/cameras.md).
//
// In a world file, inside a robot:
//   camera( resolution [320 240]  fov 80  range [0 50]  normals 1  pose6 [0 0 0.3 0 5 0] )
// A reading has one depth per pixel, row by row from the top left. `hits` are the labels.

#include <cstdint>
#include <memory>

#include "base/rigid_transform.h"
#include "sensors/lidar_beams.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kCamera = 45;  ///< wire id

/// Settings of one camera. It looks along its x axis; y points to the left of the image, z up.
struct CameraSettings {
  base::RigidTransform X_MS;                 ///< sensor in the mover's frame
  std::uint32_t width = 320, height = 240;   ///< [px]
  double focal_length = 0.0;                 ///< [px]
  double range_min = 0.0, range_max = 50.0;  ///< [m] of the depth along the optical axis
  bool normals = false;
  std::uint8_t mode = 0;                    ///< row of kCameraModes
  std::shared_ptr<const LidarBeams> beams;  ///< one per pixel
};

/// Principal point [px]: whole numbers are centres of pixels.
inline double centre_of(std::uint32_t pixels) { return 0.5 * (pixels - 1.0); }

inline constexpr AccuracyMode kCameraModes[] = {
    {"exact", "every pixel"},
    {"single", "every pixel, decided in 64 bits, measured in 32 bits where these are within 1 mm"},
};

extern const SensorType camera_type;

}  // namespace sf::sensors
