#pragma once
// How spatial sensors see the meshes of a world: which of their bodies are closed, and what keeps the others open.

#include <cstddef>
#include <optional>
#include <string>

#include "world/world.h"

namespace sf::apps {

inline constexpr std::size_t kMostExamined = 4'000'000;  ///< triangles of all meshes whose edges are examined
inline constexpr std::size_t kMostMeshRows = 20;         ///< meshes that a text lists

struct MeshReport {
  struct Faults {
    std::size_t count = 0;
    std::size_t first = 0;  ///< number of the first triangle with one, from 1, without those with an area of 0
  };
  std::size_t bodies = 0, closed = 0;  ///< parts that are connected by edges; those whose back faces are hidden
  Faults single, shared;               ///< edges of one triangle; of three or more
  Faults repeated;                     ///< triangles with the corners of an earlier one
};
MeshReport report_of(const world::Mesh& mesh);

/// Returns the reports of meshes in the order of the world's, as far as kMostExamined allows; nullopt for the others.
std::vector<std::optional<MeshReport>> mesh_reports(const world::World& world);

/// Returns rows for all meshes and for the terrain; without these, an empty text.
std::string surfaces_text(const world::World& world);

}  // namespace sf::apps
