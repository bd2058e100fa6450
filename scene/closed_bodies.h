#pragma once
// Bodies whose surface is closed and does not meet itself. A beam that starts outside of such a body meets one of its
// front faces before any of its back faces, which need not be drawn.

#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <vector>

#include "scene/mesh.h"

namespace sf::scene {

/// An axis-aligned box; empty: low > high.
struct Bounds {
  glm::dvec3 low{HUGE_VAL}, high{-HUGE_VAL};  ///< [m]

  void add(glm::dvec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
  void add(const Bounds& box) { low = glm::min(low, box.low), high = glm::max(high, box.high); }
};

/// Sides of a mesh's faces.
struct FaceSides {
  /// Per face: 1 if its corners are counter-clockwise seen from outside of its closed body, -1 if clockwise, 0 if it
  /// has none.
  std::vector<std::int8_t> outward;
  std::vector<std::uint32_t> body;  ///< per face: row in `bounds`
  std::vector<Bounds> bounds;       ///< of the faces' bodies
};

/// Finds bodies: faces that are connected by edges. One is closed if each of its edges belongs to two faces, it can be
/// oriented and has a volume, and its faces certainly have no points in common but the edges and corners that they
/// share. Coordinates of corners are compared exactly. Bodies of many faces that overlap along each axis are left open,
/// so that the time stays below a few times the tree's.
FaceSides find_closed_bodies(const Mesh& mesh);

}  // namespace sf::scene
