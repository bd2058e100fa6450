#pragma once
// Calibrates a camera from the images of a source.

#include <functional>
#include <string>

#include "vision/opencv.h"

namespace sf::vision {

// Limits on the work that a folder of images may cause: more or larger images add little.
inline constexpr std::size_t kMaxCalibrationImages = 200;
inline constexpr std::int64_t kMaxCalibrationPixels = std::int64_t{1} << 31;  ///< of all images in total
inline constexpr std::size_t kMaxCalibrationCorners = 200'000;                ///< of all boards in total

/// Reads all images, one at a time. Counts an unreadable image as one without a board.
/// @param from name of the source, for errors
/// @param progress called after each image with the number of images so far; may be empty
/// @throws base::InputError for a device, images of different sizes, images beyond the limits above, and a board found
/// in fewer than three images
Calibration calibrate(ImageSource& images, const std::string& from, const Chessboard& board,
                      const std::function<void(std::size_t)>& progress);

}  // namespace sf::vision
