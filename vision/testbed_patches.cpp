#include "vision/testbed_patches.h"

#include <cmath>
#include <glm/common.hpp>

#include "base/random.h"

namespace sf::vision {

void add_tag(Scene& scene, const TrueTag& state, double time, double side, const TagPattern& pattern) {
  Patch body{Patch::Shape::disc, state.X_WT, time, state.velocity, state.turn};
  body.X_WP.z -= 0.02;
  body.size = glm::dvec2{2.0 * kBodyRadius * side};
  body.albedo = 0.2;
  scene.patches.push_back(body);
  Patch tag{Patch::Shape::tag, state.X_WT, time, state.velocity, state.turn};
  tag.size = glm::dvec2{side};
  tag.pattern = pattern;
  tag.border = kTagBorder;
  scene.patches.push_back(tag);
}

std::vector<Patch> clutter(const Testbed& testbed, std::uint64_t seed) {
  std::vector<Patch> patches;
  glm::dvec2 low, high;
  field_of_view(testbed, low, high);
  for (const double at : {-0.25, 0.25}) {
    Patch line;
    line.albedo = 0.85;
    line.size = {20.0, 0.03};
    line.X_WP = {0.5 * (low.x + high.x), 0.5 * (low.y + high.y) + at, 0.0, 0.0};
    patches.push_back(line);
    line.X_WP = {0.5 * (low.x + high.x) + at, 0.5 * (low.y + high.y), 0.0, M_PI / 2.0};
    patches.push_back(line);
  }
  for (std::uint32_t i = 0; i < 20; ++i) {
    const base::RandomKey key{seed, base::RandomStream::placement, 2000000 + i};
    const auto [a, b] = base::random_uniform(key, 0);
    const auto [c, d] = base::random_uniform(key, 1);
    Patch frame;
    frame.albedo = 0.85;
    frame.size = glm::dvec2{1.3 * testbed.tag.side * (0.5 + c)};
    frame.X_WP = {low.x + a * (high.x - low.x), low.y + b * (high.y - low.y), 0.0, 2.0 * M_PI * d};
    patches.push_back(frame);
    frame.albedo = 0.05;
    frame.size *= 1.0 / 1.3;
    patches.push_back(frame);
  }
  return patches;
}

void field_of_view(const Testbed& testbed, glm::dvec2& low, glm::dvec2& high) {
  low = glm::dvec2{1e9};
  high = -low;
  for (const TestbedCamera& each : testbed.cameras)
    for (const double u : {0.0, 0.5, 1.0})
      for (const double v : {0.0, 0.5, 1.0}) {
        const Intrinsics& i = each.camera.intrinsics;
        const auto p = to_plane(each.camera, {u * (i.width - 1), v * (i.height - 1)}, testbed.tag.height);
        if (!p) continue;
        low = glm::min(low, *p);
        high = glm::max(high, *p);
      }
  low = glm::max(low, glm::dvec2{-50.0});
  high = glm::min(high, glm::dvec2{50.0});
}

}  // namespace sf::vision
