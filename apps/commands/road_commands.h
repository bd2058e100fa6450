#pragma once
// Road networks (.rndf) and missions (.mdf) on the command line, called by `check` and `draw`.

#include <optional>
#include <string>
#include <vector>

#include "apps/options/options.h"
#include "world/roads/mdf.h"
#include "world/roads/network.h"

namespace sf::apps {

/// Facts about a road network, printed as JSON or text.
struct RoadReport {
  const world::RoadNetwork& network;
  std::size_t lane_markings = 0;  ///< painted lines and dashes
  const std::vector<world::Warning>& warnings;
};

/// Facts about a mission, printed as JSON or text.
struct MissionReport {
  const world::Mdf& mission;
  std::string network;  ///< file that the mission was checked against; empty: none
  const std::vector<world::Warning>& warnings;
};

std::string road_report_json(const RoadReport& facts);
std::string mission_report_json(const MissionReport& facts);
std::string road_report_text(const RoadReport& facts);
std::string mission_report_text(const MissionReport& facts);

/// Runs `check` on a .rndf (or .rdf) or .mdf file; returns nullopt for other files.
/// @throws base::InputError if the file is invalid, or --rndf is given without a mission.
std::optional<int> check_roads(const CheckOptions& options);

/// Runs `draw` on a .rndf (or .rdf) file; returns nullopt for other files. @throws base::InputError if the file is
/// invalid or a mission.
std::optional<int> draw_roads(const DrawOptions& options);

}  // namespace sf::apps
