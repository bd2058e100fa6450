#include "apps/commands/road_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/processes/stop_signals.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/files.h"
#include "viz/road_figure.h"
#include "world/roads/roads.h"

namespace sf::apps {

namespace {

using Json = nlohmann::ordered_json;

bool is_network(const std::string& file) { return base::ending_of(file) == ".rndf" || base::ending_of(file) == ".rdf"; }
bool is_mission(const std::string& file) { return base::ending_of(file) == ".mdf"; }

void append(std::vector<world::Warning>& all, const std::vector<world::Warning>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

/// [m] of all lanes
double lane_length(const world::RoadNetwork& network) {
  double length = 0.0;
  for (const world::RoadLane& lane : network.lanes) length += length_of(lane);
  return length;
}

int check_network(const CheckOptions& options) {
  std::vector<world::Warning> warnings;
  const world::RoadNetwork network = world::load_roads(options.world, warnings, options.load.strict);
  const RoadReport facts{network, world::lane_markings_of(network).size(), warnings};
  print(options.json ? road_report_json(facts) : road_report_text(facts));
  return 0;
}

int check_mission(const CheckOptions& options) {
  const world::Mdf mission = world::read_mdf(options.world, options.load.strict);
  std::vector<world::Warning> warnings = mission.warnings;
  if (!options.rndf.empty()) {
    const world::Rndf rndf = world::read_rndf(options.rndf, options.load.strict);
    append(warnings, rndf.warnings);
    append(warnings, world::check_against(mission, rndf));
  }
  const MissionReport facts{mission, options.rndf, warnings};
  print(options.json ? mission_report_json(facts) : mission_report_text(facts));
  return 0;
}

/// Names contain the bytes of a file: invalid UTF-8 is replaced.
std::string with_road_warnings(const Json& json, const std::vector<world::Warning>& warnings) {
  return with_warnings(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", warnings);
}

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

}  // namespace

std::string road_report_text(const RoadReport& facts) {
  const world::RoadNetwork& network = facts.network;
  const world::RoadCounts& c = network.counts;
  const world::Extent& e = network.extent;
  std::string text = warnings_text(facts.warnings);
  text += fmt::format("{}\n", network.name.empty() ? network.file : network.name);
  text += row("segments", c.segments);
  text += row("lanes", "{} ({:.1f} m in all)", c.lanes, lane_length(network));
  text += row("zones", c.zones);
  text += row("spots", c.spots);
  text += row("points", "{} ({} of lanes)", c.points, c.lane_waypoints);
  text += row("exits", c.exits);
  text += row("stops", c.stops);
  text += row("checkpoints", c.checkpoints);
  text += row("painted lines", facts.lane_markings);
  text += row("scale", "{:g}", network.scale);
  text += row("extent", "x {:.3f} to {:.3f} m, y {:.3f} to {:.3f} m", e.x_min, e.x_max, e.y_min, e.y_max);
  return text + row("warnings", facts.warnings.size());
}

std::string mission_report_text(const MissionReport& facts) {
  const world::Mdf& mission = facts.mission;
  std::string text = warnings_text(facts.warnings);
  text += fmt::format("{}\n", mission.name.empty() ? mission.file : mission.name);
  text += row("written for", mission.rndf_name.empty() ? "-" : mission.rndf_name);
  text += row("checked against", facts.network.empty() ? "nothing (--rndf FILE)" : facts.network);
  text += row("checkpoints", mission.checkpoints.size());
  text += row("speed limits", mission.speed_limits.size());
  return text + row("warnings", facts.warnings.size());
}

std::optional<int> check_roads(const CheckOptions& options) {
  if (is_mission(options.world)) return check_mission(options);
  if (!options.rndf.empty())
    throw base::InputError(options.world, 0, "is not a mission; use --rndf with `check` of an .mdf file");
  if (is_network(options.world)) return check_network(options);
  return std::nullopt;
}

std::optional<int> draw_roads(const DrawOptions& options) {
  if (is_mission(options.world))
    throw base::InputError(options.world, 0, "a mission cannot be drawn; draw the .rndf file that it was written for");
  if (!is_network(options.world)) return std::nullopt;
  std::vector<world::Warning> warnings;
  const world::RoadNetwork network = world::load_roads(options.world, warnings, options.load.strict);
  print_warnings(options.world, warnings);
  heed_stop("interrupted: nothing was written");
  viz::draw_roads(network, options.out, options.page);
  print_message("wrote {}", options.out);
  return 0;
}

std::string road_report_json(const RoadReport& facts) {
  const world::RoadCounts& c = facts.network.counts;
  const world::Extent& e = facts.network.extent;
  return with_road_warnings(
      {{"network", facts.network.name},
       {"roads",
        {{"segments", c.segments},
         {"lanes", c.lanes},
         {"zones", c.zones},
         {"spots", c.spots},
         {"lane_waypoints", c.lane_waypoints},
         {"points", c.points},
         {"exits", c.exits},
         {"stops", c.stops},
         {"checkpoints", c.checkpoints}}},
       {"lane_length_m", rounded(lane_length(facts.network), 1e-3)},
       {"stripes", facts.lane_markings},
       {"scale", facts.network.scale},
       {"extent", {rounded(e.x_min, 1e-6), rounded(e.y_min, 1e-6), rounded(e.x_max, 1e-6), rounded(e.y_max, 1e-6)}}},
      facts.warnings);
}

std::string mission_report_json(const MissionReport& facts) {
  Json checkpoints = Json::array(), limits = Json::array();
  for (const auto& checkpoint : facts.mission.checkpoints) checkpoints.push_back(checkpoint.id);
  for (const world::SpeedLimit& limit : facts.mission.speed_limits)
    limits.push_back({{"id", limit.id}, {"least_mph", limit.least_mph}, {"most_mph", limit.most_mph}});
  return with_road_warnings({{"mission", facts.mission.name},
                             {"rndf", facts.mission.rndf_name},
                             {"checked_against", facts.network.empty() ? Json() : Json(facts.network)},
                             {"checkpoints", checkpoints},
                             {"speed_limits", limits}},
                            facts.warnings);
}

}  // namespace sf::apps
