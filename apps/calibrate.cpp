// `calibrate`: a camera's intrinsics from images of a chessboard.

#include "vision/calibration.h"

#include <fmt/format.h>

#include "apps/commands.h"
#include "apps/progress_line.h"
#include "apps/text.h"
#include "base/error.h"
#include "vision/testbed.h"

namespace sf::apps {

namespace {

vision::Chessboard board_of(const CalibrateOptions& options) {
  if (!options.charuco.empty() && options.marker >= options.square)
    throw base::InputError(fmt::format("--marker {:g} is no tag inside a square of --square {:g}; expected less",
                                       options.marker, options.square));
  return {static_cast<int>(options.columns), static_cast<int>(options.rows), options.square, options.charuco,
          options.marker};
}

vision::Calibration calibrate_shown(const CalibrateOptions& options) {
  const auto source = vision::opencv().open_source(options.images, 0, 0, 0.0);
  // The number of a video's images is not known before its end.
  const double images = static_cast<double>(source->size() > 0 ? source->size() : vision::kMaxCalibrationImages);
  Progress progress("calibrating");
  return vision::calibrate(*source, options.images, board_of(options), [&](std::size_t done) {
    progress.show(static_cast<double>(done) / images, counted(done, "image"));
  });
}

}  // namespace

int calibrate(const CalibrateOptions& options) {
  const vision::Calibration found = calibrate_shown(options);
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
