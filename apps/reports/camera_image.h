#pragma once
// Images of a camera's reading, as files.

#include <cstdint>
#include <string>

#include "base/reading.h"
#include "sensors/camera.h"

namespace sf::apps {

inline constexpr std::uint32_t kLargestLabel = 65535;  ///< also of all models beyond it

enum class ImageKind { depth, labels, normals, colour, mono };

/// Returns whether a file to write is a JPEG, by its suffix.
bool is_jpeg(const std::string& file);

/// Returns a PNG or JPEG file. Depth: 16 bits, millimetres; 0 without a surface, too near, or from 65.5355 m. Labels:
/// 16 bits, 0 without a surface, 1 for the floor and roads, 2 plus the row of the model, at most kLargestLabel.
/// Normals: red, green and blue are x, y and z in the camera's frame, -1 as 0 and 1 as 255; black without a surface.
/// @param jpeg of colour and mono only, in the camera's quality or the default one
/// @pre normals need CameraSettings::normals, colour needs CameraSettings::rgb, mono CameraSettings::mono
std::string camera_file(const sensors::CameraSettings& camera, const base::ReadingBlock& reading, ImageKind kind,
                        bool jpeg);

/// Returns the number of pixels that show models whose label would exceed kLargestLabel.
std::uint64_t labels_beyond(const base::ReadingBlock& reading);

}  // namespace sf::apps
