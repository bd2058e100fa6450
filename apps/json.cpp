#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/facts.h"
#include "base/hash.h"

namespace sf::apps {

namespace {

using Json = nlohmann::ordered_json;

/// Names are whatever bytes a world file holds: what is no UTF-8 is replaced.
std::string dump(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string print(const Json& json) { return dump(json, 2) + "\n"; }

std::string metres(double value) { return std::isfinite(value) ? fmt::format("{:.9f}", value) : "null"; }

Json pose_json(const base::Pose& X) { return {X.x, X.y, base::wrap_angle(X.yaw)}; }

Json reasons(const netio::Counts& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < netio::kReasons; ++i) {
    const auto reason = static_cast<netio::Reason>(i);
    if (counts[reason] > 0) json[std::string(name(reason))] = counts[reason];
  }
  return json;
}

std::size_t count_robots(const world::World& world) {
  std::size_t robots = 0;
  for (const world::Mover& mover : world.movers) robots += !mover.is_tag;
  return robots;
}

}  // namespace

std::string json_of(const gpu::Survey& survey) {
  Json rows = Json::array();
  for (const gpu::DeviceFacts& d : survey.devices)
    rows.push_back({{"name", d.name},
                    {"driver", d.driver},
                    {"api", d.api},
                    {"kind", d.kind},
                    {"software", d.software},
                    {"chosen", d.chosen},
                    {"reason", d.reason}});
  Json json{{"devices", rows}};
  if (!survey.problem.empty()) json["problem"] = survey.problem;
  return print(json);
}

std::string json_of(const world::World& world) {
  std::size_t lasers = 0;
  for (const world::Mover& mover : world.movers) lasers += mover.lasers.size();
  Json warnings = Json::array();
  for (const world::Warning& w : world.warnings)
    warnings.push_back({{"file", w.file}, {"line", w.line}, {"message", w.message}});
  std::size_t segments = world.walls.size();
  for (const world::Mover& mover : world.movers) segments += mover.body.size();
  const world::Extent& e = world.extent;
  return print({{"world", world.name},
                {"models", world.models.size()},
                {"robots", count_robots(world)},
                {"tags", world.movers.size() - count_robots(world)},
                {"sensors", {{"laser", lasers}}},
                {"segments", world.walls.size()},
                {"segments_with_movers", segments},
                {"magnets", world.magnets},
                {"extent", {e.x_min, e.y_min, e.x_max, e.y_max}},
                {"interval_s", world.interval},
                {"kept", world.kept},
                {"hash", base::hash_text(world.hash)},
                {"warnings", warnings}});
}

std::string json_of(const RunFacts& f) {
  Json json{{"device", f.device},
            {"software_device", f.software},
            {"robots", f.robots},
            {"ticks", f.ticks},
            {"simulated_s", f.simulated_s},
            {"wall_s", f.wall_s},
            {"real_time_factor", f.wall_s > 0.0 ? f.simulated_s / f.wall_s : 0.0},
            {"rays", f.farm.rays},
            {"rays_per_s", f.wall_s > 0.0 ? static_cast<double>(f.farm.rays) / f.wall_s : 0.0},
            {"readings", f.farm.readings},
            {"lanes_in_doubt", f.farm.doubts},
            {"cells_built", f.farm.cells_built},
            {"contacts", f.contacts},
            {"hash", base::hash_text(f.hash)},
            {"interrupted", f.interrupted},
            {"stages_s",
             {{"move", f.move_s},
              {"place", f.farm.place_s},
              {"lists", f.farm.lists_s},
              {"device", f.farm.device_s},
              {"collect", f.farm.collect_s},
              {"out", f.out_s}}}};
  if (f.sent)
    json["packets"] = {{"sent", f.outbox.sent},
                       {"bytes", f.outbox.sent_bytes},
                       {"failed", f.outbox.failed},
                       {"dropped", f.outbox.dropped},
                       {"first_failure", f.outbox.first_failure}};
  if (f.received) json["received"] = reasons(f.inbox);
  if (!f.recording.empty()) {
    json["recording"] = f.recording;
    json["recording_bytes"] = f.recorded_bytes;
  }
  return print(json);
}

std::string json_of(const netio::Summary& s) {
  return print({{"packets", s.datagrams},
                {"bytes", s.bytes},
                {"good", s.good},
                {"rays", s.rays},
                {"lost", s.lost},
                {"duplicates", s.duplicates},
                {"reordered", s.reordered},
                {"ports", s.ports},
                {"silent_ports", s.silent_ports},
                {"by_reason", reasons(s.counts)}});
}

std::string json_of(const world::World& world, const base::ReadingBlock& reading) {
  const world::Mover& mover = world.movers[reading.mover];
  const world::Laser& laser = mover.lasers[reading.sensor];
  const Json head{{"robot", mover.name}, {"sensor", reading.sensor},        {"sensor_name", laser.name},
                  {"kind", "laser"},     {"pose", pose_json(reading.X_WM)}, {"sensor_pose", pose_json(reading.X_WS)}};
  // Beams are lines of their own, with as many decimals as a ruler will ever need: nlohmann/json prints no fixed
  // number.
  std::string text = dump(head);
  text.back() = ',';
  text += "\n\"beams\": [";
  for (std::uint32_t i = 0; i < reading.values.size(); ++i) {
    const std::uint32_t hit = reading.hits[i];
    text += fmt::format("{}\n  {{\"bearing_rad\": {:.12f}, \"range_m\": {}, \"hit\": {}}}", i == 0 ? "" : ",",
                        world::bearing_of(laser, i), metres(reading.values[i]),
                        hit == base::kNoHit ? "null" : dump(world.models[hit].name));
  }
  return text + "\n]}\n";
}

}  // namespace sf::apps
