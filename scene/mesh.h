#pragma once
// Surfaces of a rigid body, or of the static world, as convex polygons.

#include <array>
#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <glm/ext/vector_float2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "world/material.h"

namespace sf::scene {

/// Corners of a flat, convex face, in order around it; each a row in `Mesh::vertices`. A triangle repeats its last
/// corner. Visible from both sides.
using Face = std::array<std::uint32_t, 4>;

inline std::uint32_t corners_of(const Face& face) { return face[2] == face[3] ? 3 : 4; }

/// Texture coordinates (world::MeshTextures) of a face's first three corners. They are affine over the face.
using FaceCoordinates = std::array<glm::vec2, 3>;

/// Invariant: the distance of a face's corners from its plane is below 1e-13 of its size plus 4 roundings of its
/// coordinates; no face has an area of 0.
struct Mesh {
  std::vector<glm::dvec3> vertices;      ///< [m] in the body's frame, finite
  std::vector<Face> faces;               ///< fewer than 2^31
  std::vector<std::uint32_t> owners;     ///< per face: row in `world::World::models`; empty: Instance::owner
  std::vector<std::uint32_t> materials;  ///< per face: row in a table of the caller, or world::kNoMaterial; empty: none
  std::vector<FaceCoordinates> coordinates;  ///< per face; empty: none

  /// Appends a face with new vertices. @param corners three or four @param owner nullopt: the mesh has no owners
  void add(std::span<const glm::dvec3> corners, std::optional<std::uint32_t> owner);
};

/// Plane of a face: `normal` . (x - point) = 0.
struct Plane {
  glm::dvec3 normal;  ///< unit vector
  glm::dvec3 point;   ///< [m] first corner
};

Plane plane_of(const Mesh& mesh, const Face& face);

/// Returns for each vertex the row of one vertex with its coordinates, which are compared exactly.
std::vector<std::uint32_t> equal_vertices(const Mesh& mesh);

/// An edge of a face.
struct FaceEdge {
  std::uint32_t low, high;  ///< its ends, of equal_vertices; equal if it has no length
  std::uint32_t face, k;    ///< from the face's corner k to the next
  bool forward;             ///< from `low` to `high`
};
/// Returns the edges of all faces by their ends, then by face, so that those of neighbours are next to each other.
/// @param equal of equal_vertices
std::vector<FaceEdge> edges_of(const Mesh& mesh, std::span<const std::uint32_t> equal);
/// Calls `visit(edges)` for each pair of ends in the result of edges_of.
template <class Visit>
void for_each_edge(std::span<const FaceEdge> edges, const Visit& visit) {
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    visit(edges.subspan(i, end - i));
  }
}

}  // namespace sf::scene
