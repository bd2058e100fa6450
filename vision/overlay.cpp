#include "vision/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sf::vision {

namespace {

using Color = std::array<std::uint8_t, 3>;
constexpr Color kTag{86, 224, 120}, kAxis{255, 160, 40}, kWall{240, 90, 90}, kMarking{110, 190, 255};
constexpr double kPiece = 0.05;  // [m] straight pieces of lines, which lenses bend

/// A line on a horizontal plane, in pieces; several marks where parts of it are not seen.
void add_line(const Camera& camera, std::span<const glm::dvec2> points, double z, Color color, int width,
              std::vector<Mark>& out) {
  Mark mark{{}, "", color, width};
  const auto flush = [&] {
    if (mark.points.size() > 1) out.push_back(mark);
    mark.points.clear();
  };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double length = glm::distance(points[i], points[i + 1]);
    const int pieces = static_cast<int>(std::clamp(std::ceil(length / kPiece), 1.0, 4096.0));
    for (int k = i == 0 ? 0 : 1; k <= pieces; ++k) {
      const glm::dvec2 p = glm::mix(points[i], points[i + 1], static_cast<double>(k) / pieces);
      const auto pixel = project(camera, {p.x, p.y, z});
      pixel ? mark.points.push_back(*pixel) : flush();
    }
  }
  flush();
}

}  // namespace

std::vector<Mark> tag_marks(const Camera& camera, std::span<const Sighting> sightings) {
  std::vector<Mark> marks;
  for (const Sighting& sighting : sightings) {
    const base::Pose& X = sighting.fit.X_WT;
    const double h = 0.5 * sighting.fit.side;
    const auto at = [&](double x, double y) { return base::transform(X, {x, y}); };
    const std::vector<glm::dvec2> square{at(-h, -h), at(h, -h), at(h, h), at(-h, h), at(-h, -h)};
    add_line(camera, square, X.z, kTag, 2, marks);
    const std::vector<glm::dvec2> arrow{at(0.0, 0.0), at(2.0 * h, 0.0), at(1.6 * h, 0.25 * h), at(2.0 * h, 0.0),
                                        at(1.6 * h, -0.25 * h)};
    add_line(camera, arrow, X.z, kAxis, 2, marks);
    const auto middle = project(camera, {X.x, X.y, X.z});
    if (!middle) continue;
    const glm::dvec2 below = *middle + glm::dvec2{-40.0, 1.1 * sighting.fit.side / sighting.fit.pixel};
    marks.push_back(
        {{below}, fmt::format("{}: {:.2f} {:.2f} m {:.0f} deg", sighting.id, X.x, X.y, X.yaw * 180.0 / M_PI), kTag, 1});
  }
  return marks;
}

std::vector<Mark> world_marks(const Camera& camera, const world::World& world) {
  std::vector<Mark> marks;
  for (const world::LaneMarking& marking : world.lane_markings) add_line(camera, marking.line, 0.0, kMarking, 2, marks);
  for (const world::Segment& wall : world.walls) {
    const std::vector<glm::dvec2> line{wall.a, wall.b};
    add_line(camera, line, wall.z_min, kWall, 1, marks);
    add_line(camera, line, wall.z_max, kWall, 2, marks);
  }
  return marks;
}

Image draw_over(const Image& grey, const std::vector<Mark>& marks) {
  Image image{grey.width, grey.height, 3, {}};
  image.pixels.reserve(3 * grey.pixels.size());
  for (const std::uint8_t value : grey.pixels) image.pixels.insert(image.pixels.end(), 3, value);
  opencv().draw(image, marks);
  return image;
}

}  // namespace sf::vision
