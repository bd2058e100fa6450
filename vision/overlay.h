#pragma once
// Drawings over a camera's image: tags with their ids and poses, and the outlines of a virtual world.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/tag_detector.h"
#include "world/world.h"

namespace sf::vision {

/// The fitted square of each tag projected back into the image, an arrow along its x axis, its id and pose.
std::vector<Mark> tag_marks(const Camera& camera, std::span<const Sighting> sightings);

/// A line on a horizontal plane in the world.
struct PlaneLine {
  std::vector<glm::dvec2> points;  ///< [m]
  double z = 0.0;                  ///< [m]
  std::array<std::uint8_t, 3> color{};
  int width = 1;  ///< [px]
};

/// Lines as they would lie in front of the camera, clipped to its picture.
std::vector<Mark> line_marks(const Camera& camera, std::span<const PlaneLine> lines);

/// Walls and lane markings of a world, as they would lie in front of the camera, clipped to its picture.
std::vector<Mark> world_marks(const Camera& camera, const world::World& world);

/// The grey image with the marks, in colours.
Image draw_over(const Image& grey, const std::vector<Mark>& marks);

}  // namespace sf::vision
