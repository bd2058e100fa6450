// Road networks as JSON, written by hand: numbers, names and warnings only.

#include <fmt/format.h>

#include <algorithm>

#include "apps/road_commands.h"

namespace sf::apps {

namespace {

/// Bytes of the UTF-8 sequence that begins at `at`; 0 where none does.
std::size_t utf8_length(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned first = byte(at);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xC0u) != 0x80u) return 0;
  const unsigned second = byte(at + 1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool out_of_range = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return overlong || out_of_range ? 0 : length;
}

/// In quotes; names are whatever bytes a file holds: what is no UTF-8 is replaced.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const std::size_t length = utf8_length(text, at);
    if (length == 0) {
      out += "\xEF\xBF\xBD";
    } else if (c == '"' || c == '\\') {
      out += std::string("\\") + c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += text.substr(at, length);
    }
    at += std::max<std::size_t>(length, 1);
  }
  return out + "\"";
}

std::string json_of(const std::vector<world::Warning>& warnings) {
  std::string json = "[";
  for (const world::Warning& w : warnings)
    json += fmt::format("{}\n    {{\"file\": {}, \"line\": {}, \"message\": {}}}", json == "[" ? "" : ",",
                        quoted(w.file), w.line, quoted(w.message));
  return json + (warnings.empty() ? "]" : "\n  ]");
}

}  // namespace

std::string json_of(const RoadReport& facts) {
  const world::RoadCounts& c = facts.network.counts;
  const world::Extent& e = facts.network.extent;
  double length = 0.0;
  for (const world::RoadLane& lane : facts.network.lanes) length += length_of(lane);
  std::string json = fmt::format("{{\n  \"network\": {},\n", quoted(facts.network.name));
  json += fmt::format(
      "  \"roads\": {{\n    \"segments\": {},\n    \"lanes\": {},\n    \"zones\": {},\n    \"spots\": {},\n"
      "    \"lane_waypoints\": {},\n    \"points\": {},\n    \"exits\": {},\n    \"stops\": {},\n"
      "    \"checkpoints\": {}\n  }},\n",
      c.segments, c.lanes, c.zones, c.spots, c.lane_waypoints, c.points, c.exits, c.stops, c.checkpoints);
  json += fmt::format("  \"lane_length_m\": {:.3f},\n  \"stripes\": {},\n  \"scale\": {},\n", length,
                      facts.lane_markings, facts.network.scale);
  json += fmt::format("  \"extent\": [{:.6f}, {:.6f}, {:.6f}, {:.6f}],\n", e.x_min, e.y_min, e.x_max, e.y_max);
  return json + fmt::format("  \"warnings\": {}\n}}\n", json_of(facts.warnings));
}

std::string json_of(const MissionReport& facts) {
  const world::Mdf& mission = facts.mission;
  std::string json =
      fmt::format("{{\n  \"mission\": {},\n  \"rndf\": {},\n", quoted(mission.name), quoted(mission.rndf_name));
  json += fmt::format("  \"checked_against\": {},\n", facts.network.empty() ? "null" : quoted(facts.network));
  json += "  \"checkpoints\": [";
  for (std::size_t i = 0; i < mission.checkpoints.size(); ++i)
    json += fmt::format("{}{}", i == 0 ? "" : ", ", mission.checkpoints[i].id);
  json += "],\n  \"speed_limits\": [";
  for (std::size_t i = 0; i < mission.speed_limits.size(); ++i) {
    const world::SpeedLimit& limit = mission.speed_limits[i];
    json += fmt::format("{}\n    {{\"id\": {}, \"least_mph\": {}, \"most_mph\": {}}}", i == 0 ? "" : ",", limit.id,
                        limit.least_mph, limit.most_mph);
  }
  json += mission.speed_limits.empty() ? "],\n" : "\n  ],\n";
  return json + fmt::format("  \"warnings\": {}\n}}\n", json_of(facts.warnings));
}

}  // namespace sf::apps
