#include "scene/mesh.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

namespace sf::scene {

void Mesh::add(std::span<const glm::dvec3> corners, std::optional<std::uint32_t> owner) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  faces.push_back({first, first + 1, first + 2, first + static_cast<std::uint32_t>(corners.size()) - 1});
  if (owner) owners.push_back(*owner);
}

Plane plane_of(const Mesh& mesh, const Face& face) {
  const glm::dvec3 p = mesh.vertices[face[0]], across = mesh.vertices[face[2]] - p;
  glm::dvec3 normal = glm::cross(mesh.vertices[face[1]] - p, across);
  if (corners_of(face) == 4) normal += glm::cross(across, mesh.vertices[face[3]] - p);
  return {glm::normalize(normal), p};
}

std::vector<std::uint32_t> equal_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size()), equal(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) {
    const glm::dvec3& p = mesh.vertices[v];
    return std::tuple(p.x, p.y, p.z);
  };
  std::ranges::sort(order, {}, key);
  for (std::size_t i = 0; i < order.size(); ++i)
    equal[order[i]] = i > 0 && key(order[i - 1]) == key(order[i]) ? equal[order[i - 1]] : order[i];
  return equal;
}

std::vector<FaceEdge> edges_of(const Mesh& mesh, std::span<const std::uint32_t> equal) {
  std::vector<FaceEdge> edges;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& face = mesh.faces[f];
    const std::uint32_t corners = corners_of(face);
    for (std::uint32_t k = 0; k < corners; ++k) {
      const std::uint32_t a = equal[face[k]], b = equal[face[(k + 1) % corners]];
      edges.push_back({std::min(a, b), std::max(a, b), f, k, a < b});
    }
  }
  std::ranges::sort(edges, {}, [](const FaceEdge& e) { return std::tuple(e.low, e.high, e.face, e.k); });
  return edges;
}

}  // namespace sf::scene
