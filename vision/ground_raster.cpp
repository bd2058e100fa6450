#include "vision/ground_raster.h"

#include <glm/geometric.hpp>

namespace sf::vision {

namespace {

/// Returns the pixel of a point in C. A lens may fold directions from outside of the image into it.
glm::dvec2 pixel_in_image(const base::Lens& lens, const base::LensImage& image, glm::dvec3 p, glm::dvec2 last) {
  if (!(p.x > 0.0)) return kUnseen;
  const glm::dvec2 n{-p.y / p.x, -p.z / p.x}, pixel = base::pixel_of(lens, n);
  if (!(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x <= last.x && pixel.y <= last.y)) return kUnseen;
  const auto back = image.direction(pixel);
  return back && glm::distance(*back, n) < 1e-6 ? pixel : kUnseen;
}

}  // namespace

std::vector<glm::dvec2> pixels_of(const GroundRaster& raster, const base::Lens& lens, const base::RigidTransform& X_RC,
                                  unsigned width, unsigned height) {
  const base::LensImage image(lens, width, height);
  const glm::dmat3 R_CR = glm::transpose(X_RC.R);
  const glm::dvec2 last{width - 1.0, height - 1.0};
  std::vector<glm::dvec2> pixels;
  for (int row = 0; row < raster.rows(); ++row)
    for (int column = 0; column < raster.columns(); ++column)
      pixels.push_back(pixel_in_image(lens, image, R_CR * (glm::dvec3(raster.place(column, row), 0.0) - X_RC.p), last));
  return pixels;
}

std::vector<glm::dvec2> paint_points(const GroundRaster& raster, const PaintLines& lines, const Image& ground,
                                     const Image& paint) {
  const int gap = static_cast<int>(lines.gap / raster.cell), widest = static_cast<int>(lines.widest / raster.cell);
  std::vector<glm::dvec2> points;
  for (int row = 0; row < paint.height; ++row) {
    const auto is_seen = [&](int column) { return column >= 0 && column<ground.width&& * ground.at(column, row)> 0; };
    int first = -1, last = -1;  // columns of the line so far
    double sum = 0.0, moment = 0.0;
    const auto end_line = [&] {
      if (first >= 0 && last - first < widest && is_seen(first - gap - 1) && is_seen(last + gap + 1))
        points.push_back(raster.place(moment / sum, row));
      first = -1;
    };
    for (int column = 0; column < paint.width; ++column) {
      const double strength = *paint.at(column, row);
      if (strength == 0.0) continue;
      if (first >= 0 && column - last - 1 > gap) end_line();
      if (first < 0) first = column, sum = moment = 0.0;
      last = column, sum += strength, moment += strength * column;
    }
    end_line();
  }
  return points;
}

}  // namespace sf::vision
