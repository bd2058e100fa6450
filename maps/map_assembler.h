#pragma once
// Maps from datagrams that may be lost, come twice, or come late. Total on any bytes; memory is bounded by the largest
// map that a sound plan allows (kMaxWords).
//
// The words of a map say themselves where they belong, so each is used as it comes: what was lost is shown as the map
// before had it. A late part of an older map is left out. A sender that starts counting from 0 again is believed when
// parts of a second older map come, newer than the first, with nothing current between.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maps/grid.h"
#include "maps/map_packets.h"

namespace sf::maps {

/// What became of a datagram.
enum class PartStatus {
  incomplete,   ///< used
  complete,     ///< used, and now every part of its map is here
  duplicate,    ///< was here already
  late,         ///< of an older map: left out
  contradicts,  ///< says it belongs to the current map, but has another plan: left out
  orphan,       ///< thesis' form: a second half before any first, or of another size
  faulty,       ///< no map's part at all
};

/// One sender's map. One thread.
class MapAssembler {
 public:
  /// A payload of the farm's form. @param sequence from its header
  PartStatus add_part(std::uint32_t sequence, std::span<const std::uint8_t> payload);
  /// A datagram of the thesis' form. Its map lies at `place`, which the wire does not tell: of that plan, left, top and
  /// cell are taken.
  PartStatus add_plain_part(std::span<const std::uint8_t> datagram, const GridGeometry& place = {});

  /// The newest of every word; null before the first part.
  const OccupancyGrid* map() const { return map_ ? &*map_ : nullptr; }
  bool true_poses() const { return true_poses_; }                ///< made from where the robot was (farm's form)
  std::uint64_t complete_maps() const { return complete_; }      ///< that came in full
  std::uint64_t incomplete_maps() const { return incomplete_; }  ///< of which something was lost, the current one aside

 private:
  void begin(std::uint32_t sequence, const GridGeometry& plan, std::uint32_t parts);
  /// Whether this part is of the current map, or of a newer one that is begun with it.
  std::optional<PartStatus> place(std::uint32_t sequence, const GridGeometry& plan, std::uint32_t parts);
  PartStatus arrived(std::uint32_t part);

  std::optional<OccupancyGrid> map_;
  std::uint32_t sequence_ = 0;
  std::uint32_t missing_ = 0;                  ///< parts of the current map
  std::vector<bool> here_;                     ///< per part
  std::optional<std::uint32_t> old_sequence_;  ///< of the last late part, if nothing current came since
  bool true_poses_ = false;
  std::uint64_t complete_ = 0;
  std::uint64_t incomplete_ = 0;
};

}  // namespace sf::maps
