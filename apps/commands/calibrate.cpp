// `calibrate`: computes a camera's intrinsics from images of a chessboard, or its pose from images of surveyed tags.

#include "vision/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/commands/commands.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/suggest.h"
#include "vision/placement.h"
#include "vision/testbed.h"
#include "vision/watched_source.h"

namespace sf::apps {

namespace {

vision::Chessboard board_of(const CalibrateOptions& options) {
  if (!options.charuco.empty() && options.marker >= options.square)
    throw base::InputError(
        fmt::format("--marker {:g} does not fit into a square of --square {:g}; expected a smaller tag", options.marker,
                    options.square));
  return {static_cast<int>(options.columns), static_cast<int>(options.rows), options.square, options.charuco,
          options.marker};
}

vision::Calibration calibrate_shown(const CalibrateOptions& options) {
  const auto source = vision::limited(vision::opencv().open_source(options.images, 0, 0, 0.0), options.images);
  // The number of images in a video is unknown until its end.
  const double images = static_cast<double>(source->size() > 0 ? source->size() : vision::kMaxCalibrationImages);
  Progress progress("calibrating");
  return vision::calibrate(*source, options.images, board_of(options), [&](std::size_t done) {
    progress.show(static_cast<double>(done) / images, counted(done, "image"));
  });
}

const vision::Camera& find_camera(const vision::Testbed& testbed, const std::string& name) {
  std::vector<std::string_view> names;
  for (const vision::TestbedCamera& each : testbed.cameras) {
    if (each.camera.name == name) return each.camera;
    names.push_back(each.camera.name);
  }
  throw base::InputError(
      fmt::format("--name: {} has no camera '{}'{}", testbed.file, name, base::expected_one_of(name, names)));
}

void warn_of_residual(const vision::Placement& found) {
  constexpr double kSuspicious = 2.0;  // [px]
  if (found.residual < kSuspicious) return;
  const auto suspect = std::min_element(found.tags.begin(), found.tags.end(), [](const auto& a, const auto& b) {
    return a.without.value_or(HUGE_VAL) < b.without.value_or(HUGE_VAL);
  });
  const std::string hint = suspect->without && *suspect->without < 0.5 * found.residual
                               ? fmt::format("; without tag {} it would be {:.3f} px: check the tag's position",
                                             suspect->id, *suspect->without)
                               : ": a position, a heading, the side of a tag or the intrinsics may be wrong";
  print_message("warning: the residual is large{}", hint);
}

int place(const CalibrateOptions& options) {
  const vision::Testbed testbed = vision::read_testbed(options.testbed);
  const vision::Camera& camera = find_camera(testbed, options.name);
  const vision::Intrinsics& i = camera.intrinsics;
  const auto source =
      vision::limited(vision::opencv().open_source(options.images, i.width, i.height, camera.rate), options.images);
  const vision::Placement found = vision::place_camera(testbed, camera, *source, options.images);
  std::string text = fmt::format("# Residual {:.3f} px RMS.\n", found.residual);
  for (const vision::TagResidual& tag : found.tags)
    text += fmt::format("# Tag {}: {:.3f} px, {:.1f} mm, in {}\n", tag.id, tag.pixels, 1e3 * tag.metres,
                        counted(tag.images, "image"));
  if (!found.unseen.empty()) text += fmt::format("# Not seen: {}\n", fmt::join(found.unseen, ", "));
  print(text + vision::camera_section(found.camera));
  warn_of_residual(found);
  return 0;
}

}  // namespace

int calibrate(const CalibrateOptions& options) {
  if (!options.testbed.empty()) return place(options);
  const vision::Calibration found = calibrate_shown(options);
  vision::Camera camera;
  camera.name = options.name;
  camera.intrinsics = found.intrinsics;
  std::string text = fmt::format("# Residual {:.3f} px RMS.\n", found.residual);
  for (std::size_t i = 0; i < found.residuals.size(); ++i)
    text += found.residuals[i] ? fmt::format("# Image {}: {:.3f} px\n", i + 1, *found.residuals[i])
                               : fmt::format("# Image {}: no chessboard\n", i + 1);
  print(text + vision::camera_section(camera));
  print_message("position and orientation are not calibrated: replace them with the camera's pose in the world");
  return 0;
}

}  // namespace sf::apps
