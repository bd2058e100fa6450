#pragma once
// Finds painted points on the ground around a robot in its camera's image: the input of `lane-camera`.

#include <memory>
#include <span>
#include <vector>

#include "sensors/camera_settings.h"
#include "vision/ground_raster.h"
#include "vision/opencv.h"

namespace sf::control {

/// Not thread-safe.
class LaneView {
 public:
  /// @param camera with colours, of a robot on level ground
  /// @throws base::InputError without OpenCV
  LaneView(const vision::GroundRaster& raster, const vision::PaintLines& lines, const sensors::CameraSettings& camera);

  /// Returns the middles [m] of painted lines in the robot's frame.
  /// @param values of a reading of the camera
  std::vector<glm::dvec2> look(std::span<const double> values);
  /// The last image, as a raster of the ground in red light.
  const vision::Image& ground() const { return ground_; }

 private:
  vision::GroundRaster raster_;
  vision::PaintLines lines_;
  std::size_t columns_;
  std::unique_ptr<vision::PaintFinder> finder_;
  vision::Image grey_, ground_, paint_;
};

}  // namespace sf::control
