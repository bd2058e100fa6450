#pragma once
// Triangles of files as faces of four corners, which halve what a scan draws.

#include "scene/mesh.h"

namespace sf::scene {

/// Joins pairs of triangles in one plane that have an edge, an owner and a material in common, and texture coordinates
/// of one affine map within 1e-6, if they form a convex face, those with the longest edges first. Corners and edges on
/// the outline of a pair remain.
Mesh join_triangles(Mesh mesh);

}  // namespace sf::scene
