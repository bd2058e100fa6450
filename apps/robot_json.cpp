#include <nlohmann/json.hpp>

#include "apps/robot_facts.h"

namespace sf::apps {

namespace {

using Json = nlohmann::ordered_json;

Json reasons(const netio::Counts& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < netio::kReasons; ++i) {
    const auto reason = static_cast<netio::Reason>(i);
    if (counts[reason] > 0) json[std::string(name(reason))] = counts[reason];
  }
  return json;
}

Json injected(const netio::DelayCounts& counts) {
  return {{"passed", counts.passed}, {"lost", counts.lost}, {"full", counts.full}};
}

Json link_json(const LinkCounts& link) {
  const netio::ReceiverCounts& in = link.readings;
  return {{"sent", {{"packets", link.sent.sent}, {"failed", link.sent.failed}, {"dropped", link.sent.dropped}}},
          {"readings", link.whole},
          {"sensor_packets",
           {{"packets", in.reasons.total()},
            {"by_reason", reasons(in.reasons)},
            {"late", in.late},
            {"duplicates", in.duplicates},
            {"lost", in.lost},
            {"restarts", in.restarts}}},
          {"relayed", {{"packets", link.words.total()}, {"by_reason", reasons(link.words)}}},
          {"injected", {{"out", injected(link.out)}, {"in", injected(link.in)}}}};
}

}  // namespace

std::string json_of(const RobotFacts& f) {
  Json json{{"robot", f.robot},      {"id", f.id},         {"controller", f.controller},
            {"farm", f.farm},        {"wall_s", f.wall_s}, {"steps", f.steps},
            {"started", f.started},  {"done", f.done},     {"answered", f.answered},
            {"contacts", f.contacts}};
  json.update(link_json(f.link));
  json["distance_m"] = f.distance_m;
  json["pose"] = {f.pose.x, f.pose.y, f.pose.yaw};
  if (f.error.steps > 0)
    json["error"] = {{"steps", f.error.steps}, {"mean", f.error.mean}, {"abs_mean", f.error.abs_mean}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sf::apps
