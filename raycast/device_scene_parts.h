#pragma once
// Parts that the sources of raycast::Scene share.

#include <cstdint>
#include <span>
#include <vector>

#include "raycast/device_scene.h"
#include "raycast/sector_lists.h"

namespace sf::raycast {

/// Loops of one lane together stay below the 65 535 turns after which older Mesa ends them silently: a search visits
/// each chunk once, a decision each entry once for each of a lane's beams. Longer lists are cast on the host.
inline constexpr std::uint32_t kMaxWallChunks = 2'800;  ///< per sector
inline constexpr std::uint32_t kMaxMoverChunks = 1'000;
static_assert((kMaxWallChunks + kMaxMoverChunks) * (1 + SF_BEAMS_PER_LANE * SF_CHUNK) + 16 < 65'535);

/// Memory of all lists together, 80 bytes a chunk of the pool: what does not fit is cast on the host.
inline constexpr std::uint32_t kMaxPoolChunks = 1u << 24;
inline constexpr std::uint32_t kChunkTexels = 4;
inline constexpr std::uint32_t kMaxMoverTexels = 1u << 25;
inline constexpr std::uint32_t kMinMoverTexels = 1u << 10;  ///< that a view may have, however many there are

/// Entries of a block of an outline, and one that faces nobody.
inline constexpr std::uint32_t kBlockTexels = kBlock + 1;
inline constexpr std::uint32_t kMaxOutlineBlocks = 0xFFFFu / kBlockTexels;
inline constexpr ListEntry kPaddingEntry{0.0f, -1e15f, 0.5f, 0.0f};

/// A mover that a view may see.
struct DeviceScene::NearbyMover {
  float nearest;  ///< [m]
  std::uint32_t mover;
  float bearing, half;                 ///< [rad] of its disc, in the world
  std::uint32_t first = 0, count = 0;  ///< entries that face the view, among the scratch's
};

/// What one thread needs to make lists.
struct DeviceScene::Scratch {
  CandidateWalls walls;
  SectorLists front_facing, back_facing;
  std::vector<ListEntry> entries;
  std::vector<std::uint32_t> segment_ids;
  std::vector<float> nearest;
  std::vector<ListChunk> chunks;
  ListHead heads[SF_SECTORS];
  std::vector<NearbyMover> near;
  std::vector<std::uint16_t> mover_entries;
  std::uint64_t movers_in_range = 0, movers_visible = 0;

  void add(std::vector<CandidateWall>& found, double spread, SectorLists& sectors);
  std::uint32_t append(std::span<const std::uint32_t> items);
};

constexpr std::uint32_t chunks_of(std::size_t entries) {
  return static_cast<std::uint32_t>((entries + SF_CHUNK - 1) / SF_CHUNK);
}

}  // namespace sf::raycast
