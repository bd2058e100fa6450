#pragma once
// Bounding volume hierarchy of a mesh: nodes with sixteen children, leaves with sixteen faces. Its arrays are laid out
// for vectors of sixteen floats. Coordinates are float32 relative to a leaf's own centre, which is a double, so that
// their rounding does not depend on the distance from the origin.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <vector>

#include "scene/mesh.h"

namespace sf::scene {

inline constexpr std::uint32_t kWidth = 16;  ///< children of a node, faces of a leaf, beams of a vector

struct alignas(64) TreeNode {
  float bound[6][kWidth];      ///< [m] boxes of the children: smallest x, y, z, then largest; relative to
                               ///< SurfaceTree::centre, rounded outward. Unused children: smallest > largest
  std::int32_t child[kWidth];  ///< >= 0: row in `nodes`; else its complement is a row in `leaves`
};

struct alignas(64) TreeLeaf {
  float corner[4][3][kWidth];  ///< [m] relative to `centre`; a triangle's fourth corner is the middle of its last edge
  float normal[3][kWidth];     ///< unit vectors; unused faces: 0
  float extent[kWidth];        ///< [m] 2 r + 6 L: radius of the leaf, longest edge of the face (rasterizer.h)
  std::uint32_t face[kWidth];  ///< row in `Mesh::faces`
  double centre[3];            ///< [m] in the mesh's frame
  float radius;                ///< [m] of the sphere about the centre that contains all faces
  std::uint32_t count;         ///< of faces, in [1, 16]
  float body[6];          ///< [m] box around the closed bodies of its faces (closed_bodies.h), relative to `centre`
                          ///< and with room: smallest x, y, z, then largest
  std::uint32_t outward;  ///< bit mask of faces of closed bodies: bits 0 to 15 have their normals outward, 16 to 31
                          ///< inward. Seen from outside of the box, back faces are hidden
};

/// Immutable once built; any number of threads may read it.
struct SurfaceTree {
  Mesh mesh;
  std::vector<Plane> planes;  ///< per face
  std::vector<TreeNode> nodes;
  std::vector<TreeLeaf> leaves;
  std::int32_t root = 0;      ///< as TreeNode::child
  glm::dvec3 centre{};        ///< [m]
  double radius = 0.0;        ///< [m] of the sphere about the centre that contains the mesh
  double longest_edge = 0.0;  ///< [m]

  bool empty() const { return mesh.faces.empty(); }
};

/// Builds the tree by the surface area heuristic over the faces' centres in bins.
SurfaceTree build_tree(Mesh mesh);

}  // namespace sf::scene
