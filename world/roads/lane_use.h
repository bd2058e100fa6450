#pragma once
// Uses of lanes, which may change during a run: a lane may be closed, reversed, or reserved for turns. Each set of uses
// has a road network of its own. Paint does not change.
//
// A reversed lane keeps the ids of its way-points, in the opposite order. An exit that led from lane A to it leads from
// it to the lane next to A that runs against A, and an exit from it to lane B leads to it from the lane next to B that
// runs against B. It has a stop line at its new end: that of the nearest lane in its direction, with the same lights,
// or else a stop sign.

#include <span>
#include <string>
#include <vector>

#include "world/roads/network.h"

namespace sf::world {

struct LaneUse {
  enum class Rule : std::uint8_t {
    open,
    closed,  ///< no route enters it; those in it drive on
    turn,    ///< at its end, routes turn by 45 degrees or more
    left,    ///< the same, to the left
    right
  };
  Rule rule = Rule::open;
  bool reversed = false;

  friend bool operator==(const LaneUse&, const LaneUse&) = default;
};

/// Returns the use with that name: "open", "closed", "turn", "left", "right", or "reversed".
/// @throws base::InputError with these words
LaneUse lane_use_of(const std::string& word);
/// Returns its name; "closed" for a closed lane of either direction.
std::string_view lane_use_name(const LaneUse& use);

/// Returns the row of the lane with a name such as "3.1".
/// @throws base::InputError with the names that exist
std::uint32_t lane_named(const RoadNetwork& network, const std::string& name);

/// Returns the network for other uses of its lanes. Takes time proportional to the size of the network.
/// @param base the network as loaded @param uses one per lane
/// @param lenient keep a reversed lane that no exit enters or leaves, and a lane for turns without such an exit at its
/// end, while others wait for their new uses
/// @throws base::InputError for them unless `lenient`, and for a reversed lane without a direction
RoadNetwork with_uses(const RoadNetwork& base, std::span<const LaneUse> uses, bool lenient = false);

}  // namespace sf::world
