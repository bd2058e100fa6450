#pragma once
// Assembles maps from datagrams that may be lost, duplicated or late. Accepts any bytes. Memory is bounded by the
// largest valid map (kMaxWords).
//
// Each part carries its position in the map, so it is used on arrival. Lost parts keep the content of the previous map.
// A late part of an older map is ignored. A restarted sender, whose sequence begins at 0 again, is accepted when parts
// of two older maps arrive, the second newer than the first, without a current part in between.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maps/grid.h"
#include "maps/map_packets.h"

namespace sf::maps {

/// Result of adding a datagram.
enum class MapPartStatus {
  incomplete,   ///< used; parts of its map are missing
  complete,     ///< used; all parts of its map have arrived
  duplicate,    ///< copy of an earlier part
  late,         ///< part of an older map; ignored
  contradicts,  ///< has the current map's sequence but another geometry; ignored
  orphan,       ///< thesis' form: a second half without a matching first half
  faulty,       ///< malformed
};

/// Assembles the maps of one sender. Single-threaded.
class MapAssembler {
 public:
  /// Adds a payload in the farm's form. @param sequence from its header
  MapPartStatus add_part(std::uint32_t sequence, std::span<const std::uint8_t> payload);
  /// Adds a datagram in the thesis' form. The datagram lacks the map's position and cell size, so left, top and cell of
  /// `place` are used.
  MapPartStatus add_plain_part(std::span<const std::uint8_t> datagram, const GridGeometry& place = {});

  /// Returns the newest content of each word; null before the first part.
  const OccupancyGrid* map() const { return map_ ? &*map_ : nullptr; }
  bool true_poses() const { return true_poses_; }            ///< built from true poses (farm's form)
  std::uint64_t complete_maps() const { return complete_; }  ///< number of complete maps
  std::uint64_t incomplete_maps() const {
    return incomplete_;
  }  ///< number of maps with lost parts, excluding the current map

 private:
  void begin(std::uint32_t sequence, const GridGeometry& geometry, std::uint32_t parts);
  /// Assigns a part to the current map, or starts a newer map with it.
  std::optional<MapPartStatus> place(std::uint32_t sequence, const GridGeometry& geometry, std::uint32_t parts);
  MapPartStatus arrived(std::uint32_t part);

  std::optional<OccupancyGrid> map_;
  std::uint32_t sequence_ = 0;
  std::uint32_t missing_ = 0;                  ///< missing parts of the current map
  std::vector<bool> here_;                     ///< one per part; true once it has arrived
  std::optional<std::uint32_t> old_sequence_;  ///< of the last late part, if no current part has arrived since
  bool true_poses_ = false;
  std::uint64_t complete_ = 0;
  std::uint64_t incomplete_ = 0;
};

}  // namespace sf::maps
