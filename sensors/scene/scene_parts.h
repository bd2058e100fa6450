#pragma once
// What the sources of sensors::Scene share among themselves.

#include <cstdint>

#include "sensors/scene/scene.h"

namespace sf::sensors {

/// Loops of one lane together stay below the 65 535 turns after which older Mesa ends them silently: a search visits
/// each chunk once, a decision each entry once for each of a lane's beams.
inline constexpr std::uint32_t kMostWallChunks = 2'800;  ///< per sector
inline constexpr std::uint32_t kMostMoverChunks = 1'000;
static_assert((kMostWallChunks + kMostMoverChunks) * (1 + SF_BEAMS_PER_LANE * SF_CHUNK) + 16 < 65'535);

/// @throws base::InputError when a sector list of `what` has more than `most` chunks.
void refuse_if_too_long(std::uint32_t chunks, std::uint32_t most, const char* what);

/// One family with what serves it.
struct Scene::FamilyTables {
  Family family;
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

}  // namespace sf::sensors
