#pragma once
// Whether two convex, flat faces certainly have no points in common but those that they share.

#include <array>
#include <cstdint>
#include <glm/ext/vector_double3.hpp>

#include "scene/closed_bodies.h"

namespace sf::scene {

struct SweptFace {
  std::uint32_t corners = 0;              ///< 3 or 4
  std::array<std::uint32_t, 4> vertex{};  ///< equal numbers: shared corners
  std::array<glm::dvec3, 4> at{};         ///< [m] near the origin
  Bounds box;
};

bool overlap(const Bounds& a, const Bounds& b);

/// Returns true if the faces certainly meet only in a shared corner or edge, or not at all, by axes of separation (S.
/// Gottschalk et al., "OBBTree", 1996). Differences below 1e-11 of their size do not count as a distance.
bool are_apart(const SweptFace& a, const SweptFace& b);

}  // namespace sf::scene
