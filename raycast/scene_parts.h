#pragma once
// What the sources of sensors::Scene share among themselves.

#include <cstdint>

#include "raycast/scene.h"

namespace sf::raycast {

/// Loops of one lane together stay below the 65 535 turns after which older Mesa ends them silently: a search visits
/// each chunk once, a decision each entry once for each of a lane's beams. Longer lists are cast on the host.
inline constexpr std::uint32_t kMostWallChunks = 2'800;  ///< per sector
inline constexpr std::uint32_t kMostMoverChunks = 1'000;
static_assert((kMostWallChunks + kMostMoverChunks) * (1 + SF_BEAMS_PER_LANE * SF_CHUNK) + 16 < 65'535);

/// Memory of all lists together, 84 bytes a chunk: what does not fit is cast on the host.
inline constexpr std::uint32_t kMostPoolChunks = 1u << 24;
inline constexpr std::uint32_t kMostChunksOfAllViews = 1u << 23;
inline constexpr std::uint32_t kLeastChunksOfAView = 256;  ///< that it may have, however many views there are

/// What serves one family.
struct Scene::FamilyTables {
  double range = 0.0;  ///< [m]
  double fov = 0.0;    ///< [rad]
  CellShape shape;
  const Sight* sight = nullptr;
  const Depth* depth = nullptr;
  std::uint32_t height = 0;
};

/// What one thread needs to make lists.
struct Scene::Scratch {
  Sight::Nearby nearby;
  SectorLists lists;
  Bodies::Scratch bodies;
};

}  // namespace sf::raycast
