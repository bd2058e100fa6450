// `calibrate`: a camera's intrinsics from images of a chessboard.

#include <fmt/format.h>

#include "apps/commands.h"
#include "apps/text.h"
#include "base/error.h"
#include "vision/opencv.h"
#include "vision/testbed.h"

namespace sf::apps {

namespace {

constexpr std::size_t kMostImages = 200;  // bounds memory and time; more add little

std::vector<vision::Image> read_images(const std::string& from) {
  const auto source = vision::opencv().open_source(from, 0, 0, 0.0);
  if (source->is_live()) throw base::InputError(from, 0, "is a device; expected a folder of images or a video");
  std::vector<vision::Image> images;
  for (vision::Image image; source->next(image); images.push_back(image))
    if (images.size() == kMostImages)
      throw base::InputError(from, 0,
                             fmt::format("has more than {} images; expected fewer, all different", kMostImages));
  return images;
}

}  // namespace

int calibrate(const CalibrateOptions& options) {
  const std::vector<vision::Image> images = read_images(options.images);
  const vision::Calibration found = vision::opencv().calibrate(images, static_cast<int>(options.columns),
                                                               static_cast<int>(options.rows), options.square);
  vision::Camera camera;
  camera.name = options.name;
  camera.intrinsics = found.intrinsics;
  std::string text = fmt::format("# Residual {:.3f} px RMS.\n", found.residual);
  for (std::size_t i = 0; i < found.residuals.size(); ++i)
    text += found.residuals[i] ? fmt::format("# Image {}: {:.3f} px\n", i + 1, *found.residuals[i])
                               : fmt::format("# Image {}: no chessboard\n", i + 1);
  print(text + vision::camera_section(camera));
  print_message("position and orientation are not calibrated: replace them by the camera's place in the world");
  return 0;
}

}  // namespace sf::apps
