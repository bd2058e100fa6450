#pragma once
// Cameras: depth, labels, normals and colours of what each pixel sees, in the scene of lidars (docs/cameras.md).
//
// In a world file, inside a robot:
//   camera( resolution [320 240]  fov 80  range [0 50]  rgb 1  normals 1  pose6 [0 0 0.3 0 5 0] )
// A reading has one depth per pixel, row by row from the top left, then its colour 0xRRGGBB (grey of `mono 1`), then
// its normal, as far as asked for. `hits` are the labels.

#include <cstdint>

#include "sensors/camera_settings.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kCamera = 45;  ///< wire id

inline constexpr AccuracyMode kCameraModes[] = {
    {"exact", "every pixel"},
    {"single", "every pixel, decided in 64 bits, measured in 32 bits where these are within 1 mm"},
};

extern const SensorType camera_type;

}  // namespace sf::sensors
