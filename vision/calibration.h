#pragma once
// Calibration of a camera from the images of a source.

#include <functional>
#include <string>

#include "vision/opencv.h"

namespace sf::vision {

// Bounds of the work that a folder of images may demand: more images, or images of more pixels, add little.
inline constexpr std::size_t kMaxCalibrationImages = 200;
inline constexpr std::int64_t kMaxCalibrationPixels = std::int64_t{1} << 31;  ///< of all images together
inline constexpr std::size_t kMaxCalibrationCorners = 200'000;                ///< of all boards together

/// Reads all images, one at a time. An image that cannot be read counts as one without a board.
/// @param from name of the source, for errors
/// @param progress called after each image with the number of images so far; may be empty
/// @throws base::InputError for a device, images of different sizes, more of them than the bounds above, and a board
/// that is found in fewer than three images
Calibration calibrate(ImageSource& images, const std::string& from, const Chessboard& board,
                      const std::function<void(std::size_t)>& progress);

}  // namespace sf::vision
