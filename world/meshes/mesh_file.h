#pragma once
// Meshes of files as bodies of models (`mesh "FILE"`).

#include <string>
#include <vector>

#include "world/meshes/triangles.h"
#include "world/world.h"

namespace sf::world {

/// Returns the ending of a file's name in small letters, such as ".stl".
std::string ending_of(const std::string& file);

/// Reads a file by the ending of its name, such as .stl or .urdf. The y axis of glTF, which is up,
/// becomes z.
/// @throws base::InputError with the place in the file
Triangles read_triangles(const std::string& file);

/// The box that contains a mesh.
struct MeshBox {
  glm::dvec3 low{}, high{};  ///< [m]
  glm::dvec3 size() const { return high - low; }
};
MeshBox box_of(const std::vector<glm::dvec3>& vertices);

/// Returns the convex outline of all vertices, seen from above, as the sides of a solid from the lowest to the highest
/// one; a thin wall for an upright plane, none for a mesh without a height. Corners nearer than 0.1 % of its size to
/// the outline of the others are left out.
std::vector<Segment> outline_from_above(const std::vector<glm::dvec3>& vertices);

}  // namespace sf::world
