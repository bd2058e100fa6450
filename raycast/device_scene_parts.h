#pragma once
// Definitions shared by the sources of raycast::DeviceScene.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "raycast/device_scene.h"
#include "raycast/sector_lists.h"

namespace sf::raycast {

/// Older Mesa versions silently end a loop after 65 535 iterations. These limits keep the sum over all loops of a lane
/// below that: a search visits each chunk once, and the 64-bit decision visits each entry once per beam of the lane.
/// Scans with longer lists run on the host.
inline constexpr std::uint32_t kMaxWallChunks = 2'800;  ///< per sector
inline constexpr std::uint32_t kMaxMoverChunks = 1'000;
static_assert((kMaxWallChunks + kMaxMoverChunks) * (1 + SF_BEAMS_PER_LANE * SF_CHUNK) + 16 < 65'535);

/// Memory limit of all lists: 80 bytes per chunk of the pool. Scans that exceed it run on the host.
inline constexpr std::uint32_t kMaxPoolChunks = 1u << 24;
inline constexpr std::uint32_t kChunkTexels = 4;
inline constexpr std::uint32_t kMaxMoverTexels = 1u << 25;
inline constexpr std::uint32_t kMinMoverTexels = 1u << 10;  ///< guaranteed for each view

/// Texels of one outline block and its padding entry, which faces away from every viewer.
inline constexpr std::uint32_t kBlockTexels = kBlock + 1;
inline constexpr std::uint32_t kMaxOutlineBlocks = 0xFFFFu / kBlockTexels;
inline constexpr ListEntry kPaddingEntry{0.0f, -1e15f, 0.5f, 0.0f};

/// A mover that may be visible from a view.
struct DeviceScene::NearbyMover {
  float nearest;  ///< [m]
  float radius;   ///< [m]
  std::uint32_t mover;
  float bearing, half;                 ///< [rad] of its disc, in the world frame
  std::uint32_t first = 0, count = 0;  ///< entries that face the view, in `Scratch::mover_entries`
  std::uint32_t row = 0;               ///< of `DeviceScene::mover_rows`
};

/// Detects crowds by the sum of the discs' squared radii. For discs that overlap little, the sum is at most a few times
/// the squared radius of the disc that contains them all.
class CrowdMeasure {
 public:
  /// Adds a disc at this distance from a fixed point. @return true in a crowd
  bool add(float radius, float distance) {
    sum_ += radius * radius;
    largest_ = std::max(largest_, radius);
    const float reach = distance + 2.0f * largest_;
    return sum_ > 4.0f * reach * reach;
  }

 private:
  float sum_ = 0.0f, largest_ = 0.0f;
};

/// Scratch of one thread that builds lists.
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
  bool crowded = false;  ///< movers overlap; no lists are built, since the host scans crowds at a bounded cost
  std::uint64_t movers_in_range = 0, movers_visible = 0;

  void add(std::vector<CandidateWall>& found, double spread, SectorLists& sectors);
  std::uint32_t append(std::span<const std::uint32_t> items);
};

constexpr std::uint32_t chunks_of(std::size_t entries) {
  return static_cast<std::uint32_t>((entries + SF_CHUNK - 1) / SF_CHUNK);
}

}  // namespace sf::raycast
