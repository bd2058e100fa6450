#pragma once
// Maps from datagrams that may be lost, come twice, or come late. Total on any bytes; memory is bounded by the largest
// map that a sound plan allows (kMostWords).
//
// The words of a map say themselves where they belong, so each is used as it comes: what was lost is shown as the map
// before had it. A late part of an older map is left out. A sender that starts counting from 0 again is believed when
// parts of a second older map come, newer than the first, with nothing current between.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maps/grid.h"
#include "maps/packets.h"

namespace sf::maps {

/// What became of a datagram.
enum class Taken {
  part,         ///< used
  whole,        ///< used, and now every part of its map is here
  duplicate,    ///< was here already
  late,         ///< of an older map: left out
  contradicts,  ///< says it belongs to the current map, but has another plan: left out
  orphan,       ///< thesis' form: a second half before any first, or of another size
  faulty,       ///< no map's part at all
};

/// One sender's map. One thread.
class Assembler {
 public:
  /// A payload of the farm's form. @param sequence from its header
  Taken take(std::uint32_t sequence, std::span<const std::uint8_t> payload);
  /// A datagram of the thesis' form. Its map lies at `place`, which the wire does not tell: of that plan, left, top and
  /// cell are taken.
  Taken take_plain(std::span<const std::uint8_t> datagram, const GridPlan& place = {});

  /// The newest of every word; null before the first part.
  const Grid* map() const { return map_ ? &*map_ : nullptr; }
  bool true_poses() const { return true_poses_; }      ///< made from where the robot was (farm's form)
  std::uint64_t whole_maps() const { return whole_; }  ///< that came in full
  std::uint64_t torn_maps() const { return torn_; }    ///< of which something was lost, the current one aside

 private:
  void begin(std::uint32_t sequence, const GridPlan& plan, std::uint32_t parts);
  /// Whether this part is of the current map, or of a newer one that is begun with it.
  std::optional<Taken> place(std::uint32_t sequence, const GridPlan& plan, std::uint32_t parts);
  Taken arrived(std::uint32_t part);

  std::optional<Grid> map_;
  std::uint32_t sequence_ = 0;
  std::uint32_t missing_ = 0;                  ///< parts of the current map
  std::vector<bool> here_;                     ///< per part
  std::optional<std::uint32_t> old_sequence_;  ///< of the last late part, if nothing current came since
  bool true_poses_ = false;
  std::uint64_t whole_ = 0;
  std::uint64_t torn_ = 0;
};

}  // namespace sf::maps
