#pragma once
// Meshes of files as bodies of models (`mesh "FILE"`).

#include <string>
#include <vector>

#include "world/meshes/triangles.h"
#include "world/world.h"

namespace sf::world {

/// Reads a file. The ending of its name selects the reader. The y axis of glTF, which is up, becomes z.
/// @throws base::InputError with the line or the element
Triangles read_triangles(const std::string& file);

/// The box that contains a mesh.
struct MeshBox {
  glm::dvec3 low{}, high{};  ///< [m]
  glm::dvec3 size() const { return high - low; }
};
MeshBox box_of(const std::vector<glm::dvec3>& vertices);

/// Returns the convex outline of a mesh, seen from above, as the sides of a solid that extends from its lowest to its
/// highest vertex. An upright plane gives a thin wall, and a mesh without a height gives none. Leaves out corners
/// within 0.1 % of the mesh's size of the remaining outline.
std::vector<Segment> outline_from_above(const std::vector<glm::dvec3>& vertices);

}  // namespace sf::world
