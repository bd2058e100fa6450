#pragma once
// Coarser versions of meshes, for sensors that trade accuracy for speed.

#include <cstdint>
#include <span>
#include <vector>

#include "scene/surface_tree.h"
#include "world/world.h"

namespace sf::scene {

/// A mesh whose vertices are displaced by at most `displacement`.
struct MeshLevel {
  SurfaceTree tree;
  double displacement = 0.0;  ///< [m]; parts that are thinner may close or vanish
};

/// A coarser mesh, and the row of the triangle of the original for each of its own.
struct ClusteredMesh {
  world::Mesh mesh;
  std::vector<std::uint32_t> sources;
};

/// Merges all vertices in one cell of a grid into their mean, and drops triangles without an area. Every vertex moves
/// by less than the diagonal of a cell, sqrt(3) `cell` [m] (vertex clustering: Rossignac and Borrel, 1993).
ClusteredMesh clustered(const world::Mesh& mesh, double cell);

/// Returns levels by falling displacement, each half of the one before, as long as they have at most 0.7 of the mesh's
/// triangles. @param materials per triangle, as Mesh::materials; empty: none
std::vector<MeshLevel> levels_of(const world::Mesh& mesh, std::span<const std::uint32_t> materials = {});

/// Returns the coarsest level that displaces vertices by at most `allowed` [m]; `exact` if there is none.
const SurfaceTree& level_for(const std::vector<MeshLevel>& levels, double allowed, const SurfaceTree& exact);

}  // namespace sf::scene
