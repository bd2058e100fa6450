#pragma once
// Images of level ground with paint, computed pixel by pixel.

#include <functional>

#include "base/lens.h"
#include "base/rigid_transform.h"
#include "vision/image.h"
#include "vision/lane_tracker.h"

namespace sf::vision {

/// A camera 0.3 m above the ground, 0.1 m ahead of the robot, that looks down by 32 degrees.
struct GroundCamera {
  unsigned width = 320, height = 240;
  base::Lens lens{{160.0, 160.0}, {159.5, 119.5}, {}, false};
  base::RigidTransform X_RC{base::rotation_of(0.0, 0.5585, 0.0), {0.1, 0.0, 0.3}};
};

/// Brightness at a point [m] of the ground, in the robot's frame.
using Ground = std::function<std::uint8_t(glm::dvec2)>;

/// Returns a grey image, each pixel the mean of `parts` x `parts` beams; sky is bright.
inline Image image_of(const GroundCamera& camera, const Ground& ground, int parts = 4) {
  Image image{static_cast<int>(camera.width), static_cast<int>(camera.height), 1, {}};
  const base::LensImage lens(camera.lens, camera.width, camera.height);
  for (int v = 0; v < image.height; ++v)
    for (int u = 0; u < image.width; ++u) {
      double sum = 0.0;
      for (int k = 0; k < parts * parts; ++k) {
        const glm::dvec2 at{u + (k % parts + 0.5) / parts - 0.5, v + (k / parts + 0.5) / parts - 0.5};
        const auto n = lens.direction(at);
        const glm::dvec3 beam = n ? camera.X_RC.R * glm::dvec3(1.0, -n->x, -n->y) : glm::dvec3(1.0);
        const double depth = -camera.X_RC.p.z / beam.z;
        sum += beam.z < 0.0 ? ground(glm::dvec2(camera.X_RC.p) + depth * glm::dvec2(beam)) : 220.0;
      }
      image.pixels.push_back(static_cast<std::uint8_t>(sum / (parts * parts) + 0.5));
    }
  return image;
}

/// White edges of 15 mm on grey ground.
inline Ground painted(const Lane& lane) {
  return [lane](glm::dvec2 p) -> std::uint8_t {
    const double from = std::abs(std::abs(left_of_middle(lane, p)) - 0.5 * lane.width);
    return from < 0.0075 ? 240 : 165;
  };
}

}  // namespace sf::vision
