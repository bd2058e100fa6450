#pragma once
// Draws over a camera's image: tags with their ids and poses, and the outlines of a virtual world.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/tag_detector.h"
#include "vision/tracker.h"
#include "world/world.h"

namespace sf::vision {

/// Returns marks for each tag: its fitted square projected back into the image, an arrow along its x axis, its id and
/// pose, and its speed if `tracked` has its id.
std::vector<Mark> tag_marks(const Camera& camera, std::span<const Sighting> sightings,
                            std::span<const TrackedTag> tracked = {});

/// A line on a horizontal plane in the world.
struct PlaneLine {
  std::vector<glm::dvec2> points;  ///< [m]
  double z = 0.0;                  ///< [m]
  std::array<std::uint8_t, 3> color{};
  int width = 1;  ///< [px]
};

/// Projects lines into the camera's picture and clips them to it.
std::vector<Mark> line_marks(const Camera& camera, std::span<const PlaneLine> lines);

/// Projects walls and lane markings of a world into the camera's picture and clips them to it.
std::vector<Mark> world_marks(const Camera& camera, const world::World& world);

/// Draws the marks in colour over the grey image.
Image draw_over(const Image& grey, const std::vector<Mark>& marks);

}  // namespace sf::vision
