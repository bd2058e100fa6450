#pragma once
// Images of a camera's reading, as files.

#include <cstdint>
#include <string>

#include "base/reading.h"
#include "sensors/camera.h"

namespace sf::apps {

inline constexpr std::uint32_t kLargestLabel = 65535;  ///< also of all models beyond it

enum class ImageKind { depth, labels, normals, colour };

/// Returns a PNG file. Depth: 16 bits, millimetres, saturated; 0 without a surface. Labels: 16 bits, 0 without a
/// surface, 1 for the floor and roads, 2 plus the row of the model, at most kLargestLabel. Normals: red, green and blue
/// are x, y and z in the camera's frame, -1 as 0 and 1 as 255; black without a surface.
/// @pre normals need CameraSettings::normals, colour needs CameraSettings::rgb
std::string camera_png(const sensors::CameraSettings& camera, const base::ReadingBlock& reading, ImageKind kind);

}  // namespace sf::apps
