#pragma once
// Assembles maps from datagrams that may be lost, duplicated or late. Accepts any bytes; memory is bounded by the
// largest valid map (kMaxWords).
//
// Each part has its position in the map, so it is used on arrival; lost parts keep the content of the previous map. A
// late part of an older map is ignored. A restarted sender, whose sequence begins at 0 again, is accepted when parts of
// a second older map arrive, newer than the first, without a current part between.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maps/grid.h"
#include "maps/map_packets.h"

namespace sf::maps {

/// Result for a datagram.
enum class MapPartStatus {
  incomplete,   ///< used; parts of its map are missing
  complete,     ///< used; all parts of its map have arrived
  duplicate,    ///< a copy of an earlier part
  late,         ///< of an older map: ignored
  contradicts,  ///< has the current map's sequence and another geometry: ignored
  orphan,       ///< thesis' form: a second half without a first one, or of another size
  faulty,       ///< malformed
};

/// Assembles the maps of one sender. One thread.
class MapAssembler {
 public:
  /// Adds a payload of the farm's form. @param sequence from its header
  MapPartStatus add_part(std::uint32_t sequence, std::span<const std::uint8_t> payload);
  /// Adds a datagram of the thesis' form. Its bytes lack the map's position and cell size: left, top and cell of
  /// `place` are used.
  MapPartStatus add_plain_part(std::span<const std::uint8_t> datagram, const GridGeometry& place = {});

  /// The newest content of each word; null before the first part.
  const OccupancyGrid* map() const { return map_ ? &*map_ : nullptr; }
  bool true_poses() const { return true_poses_; }            ///< made from true poses (farm's form)
  std::uint64_t complete_maps() const { return complete_; }  ///< number of complete maps
  std::uint64_t incomplete_maps() const {
    return incomplete_;
  }  ///< number of maps with lost parts, without the current one

 private:
  void begin(std::uint32_t sequence, const GridGeometry& geometry, std::uint32_t parts);
  /// Assigns a part to the current map, or begins a newer map with it.
  std::optional<MapPartStatus> place(std::uint32_t sequence, const GridGeometry& geometry, std::uint32_t parts);
  MapPartStatus arrived(std::uint32_t part);

  std::optional<OccupancyGrid> map_;
  std::uint32_t sequence_ = 0;
  std::uint32_t missing_ = 0;                  ///< missing parts of the current map
  std::vector<bool> here_;                     ///< per part
  std::optional<std::uint32_t> old_sequence_;  ///< of the last late part, when no current part has arrived since
  bool true_poses_ = false;
  std::uint64_t complete_ = 0;
  std::uint64_t incomplete_ = 0;
};

}  // namespace sf::maps
