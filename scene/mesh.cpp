#include "scene/mesh.h"

namespace sf::scene {

void Mesh::add(std::span<const glm::dvec3> corners, std::optional<std::uint32_t> owner) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  faces.push_back({first, first + 1, first + 2, first + static_cast<std::uint32_t>(corners.size()) - 1});
  if (owner) owners.push_back(*owner);
}

}  // namespace sf::scene
