#pragma once
// Road networks (.rndf) and missions (.mdf) on the command line: `check` and `draw` hand them over.

#include <optional>
#include <string>
#include <vector>

#include "apps/options/options.h"
#include "world/roads/mdf.h"
#include "world/roads/network.h"

namespace sf::apps {

/// Facts of a road network, printed as JSON or text.
struct RoadReport {
  const world::RoadNetwork& network;
  std::size_t lane_markings = 0;  ///< painted lines and dashes
  const std::vector<world::Warning>& warnings;
};

/// Facts of a mission, printed as JSON or text.
struct MissionReport {
  const world::Mdf& mission;
  std::string network;  ///< file it was checked against; empty: none
  const std::vector<world::Warning>& warnings;
};

std::string json_of(const RoadReport& facts);
std::string json_of(const MissionReport& facts);
std::string text_of(const RoadReport& facts);
std::string text_of(const MissionReport& facts);

/// `check` of a .rndf (or .rdf) or .mdf file; nothing for other files.
/// @throws base::InputError for what is wrong in it, and for --rndf without a mission.
std::optional<int> check_roads(const CheckOptions& options);

/// `draw` of a .rndf (or .rdf) file; nothing for other files. @throws base::InputError likewise, and for a mission.
std::optional<int> draw_roads(const DrawOptions& options);

}  // namespace sf::apps
