#include "control/lane_view.h"

#include "base/error.h"

namespace sf::control {

LaneView::LaneView(const vision::GroundRaster& raster, const vision::PaintLines& lines,
                   const sensors::CameraSettings& camera)
    : raster_(raster),
      lines_(lines),
      columns_(camera.columns()),
      finder_(vision::opencv().make_paint_finder(
          raster, lines, vision::pixels_of(raster, camera.lens, camera.X_MS, camera.width, camera.height))),
      grey_{static_cast<int>(camera.width), static_cast<int>(camera.height), 1, {}} {
  SF_CHECK(camera.rgb, "a camera without colours");
  grey_.pixels.resize(std::size_t{camera.width} * camera.height);
}

// Paint is white or yellow and roads are grey: red light distinguishes both alike.
std::vector<glm::dvec2> LaneView::look(std::span<const double> values) {
  SF_CHECK(values.size() == grey_.pixels.size() * columns_, "a reading of another camera");
  for (std::size_t i = 0; i < grey_.pixels.size(); ++i)
    grey_.pixels[i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(values[i * columns_ + 1]) >> 16);
  finder_->find(grey_, ground_, paint_);
  return vision::paint_points(raster_, lines_, ground_, paint_);
}

}  // namespace sf::control
