#include "scene/texture_map.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace sf::scene {

glm::dvec2 TextureMap::at(const glm::dvec3& p) const {
  return c + glm::dvec2(glm::dot(du, p - point), glm::dot(dv, p - point));
}

TextureMap texture_map(const std::array<glm::dvec3, 3>& corners, const FaceCoordinates& coordinates) {
  const glm::dvec3 a = corners[1] - corners[0], b = corners[2] - corners[0], n = glm::cross(a, b);
  const double squared = glm::dot(n, n);
  TextureMap map{.point = corners[0], .c = glm::dvec2(coordinates[0])};
  const glm::dvec3 along_a = glm::cross(b, n) / squared, along_b = glm::cross(n, a) / squared;
  const glm::dvec2 to_a = glm::dvec2(coordinates[1]) - map.c, to_b = glm::dvec2(coordinates[2]) - map.c;
  const glm::dvec3 du = to_a.x * along_a + to_b.x * along_b, dv = to_a.y * along_a + to_b.y * along_b;
  if (std::isfinite(glm::dot(du, du) + glm::dot(dv, dv))) map.du = du, map.dv = dv;
  return map;
}

TextureMap seen_texture(const SceneMesh& mesh, std::uint32_t face) {
  const Mesh& of = mesh.tree->mesh;
  const Face& f = of.faces[face - mesh.first_face];
  const TextureMap own =
      texture_map({of.vertices[f[0]], of.vertices[f[1]], of.vertices[f[2]]}, of.coordinates[face - mesh.first_face]);
  const glm::dmat3 R_SF = glm::transpose(mesh.X_FS.R);
  return {.point = {}, .c = own.at(mesh.X_FS.p), .du = R_SF * own.du, .dv = R_SF * own.dv};
}

}  // namespace sf::scene
