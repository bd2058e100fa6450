#pragma once
// Parts of rendered testbeds: tags on bodies, and clutter on the floor.

#include <cstdint>
#include <vector>

#include "vision/scene.h"
#include "vision/testbed.h"

namespace sf::vision {

inline constexpr double kTagBorder = 1.0;   ///< [cells] width of the white border around a rendered tag
inline constexpr double kBodyRadius = 1.1;  ///< [sides of the tag] radius of the dark disc under it

/// True state of one tag.
struct TrueTag {
  std::uint32_t id = 0;
  base::Pose X_WT;
  glm::dvec2 velocity;  ///< [m/s]
  double turn = 0.0;    ///< [rad/s]
};

/// Adds a tag with a white border on a dark disc. @param time [s] of the state @param side [m]
void add_tag(Scene& scene, const TrueTag& state, double time, double side, const TagPattern& pattern);

/// Returns two crossing pairs of lane markings, and black squares in white frames, which look like tags without a code.
std::vector<Patch> clutter(const Testbed& testbed, std::uint64_t seed);

/// [m] Computes the bounding box of all images' corners on the plane of the tags, at most 50 m from the origin.
void field_of_view(const Testbed& testbed, glm::dvec2& low, glm::dvec2& high);

}  // namespace sf::vision
