#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/commands/road_commands.h"
#include "apps/reports/report.h"

namespace sf::apps {

namespace {

using Json = nlohmann::ordered_json;

/// Names contain the bytes of a file: invalid UTF-8 is replaced.
std::string with_road_warnings(const Json& json, const std::vector<world::Warning>& warnings) {
  return with_warnings(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", warnings);
}

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

}  // namespace

std::string road_report_json(const RoadReport& facts) {
  const world::RoadCounts& c = facts.network.counts;
  const world::Extent& e = facts.network.extent;
  double length = 0.0;
  for (const world::RoadLane& lane : facts.network.lanes) length += length_of(lane);
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
       {"lane_length_m", rounded(length, 1e-3)},
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
