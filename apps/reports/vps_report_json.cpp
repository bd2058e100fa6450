#include <nlohmann/json.hpp>

#include "apps/reports/vps_report.h"

namespace sf::apps {

using Json = nlohmann::ordered_json;

std::string vps_report_json(const VpsReport& r) {
  Json json = {{"cameras", r.cameras},
               {"images", r.counts.images},
               {"unreadable", r.counts.unreadable},
               {"frozen", r.counts.frozen},
               {"processing_s", r.processing_s},
               {"processing_cpu_s", r.processing_cpu_s},
               {"sightings", r.counts.sightings},
               {"refused",
                {{"unlisted", r.counts.unlisted},
                 {"unfitted", r.counts.unfitted},
                 {"misfitted", r.counts.misfitted},
                 {"out_of_reach", r.refused}}}};
  if (r.accuracy) {
    const vision::Accuracy& a = *r.accuracy;
    const auto error = [](const vision::RmsError& e) { return Json{{"rms", e.rms()}, {"largest", e.largest}}; };
    json["accuracy"] = {{"position_m", error(a.position)},
                        {"heading_rad", error(a.heading)},
                        {"velocity_m_s", error(a.velocity)},
                        {"turn_rad_s", error(a.turn)},
                        {"reported", a.position.count + a.wrong},
                        {"missed", a.missed},
                        {"false", a.wrong}};
  }
  if (r.truth)
    json["truth"] = {{"robots", r.truth->robots}, {"accepted", r.truth->accepted}, {"refused", r.truth->refused}};
  if (r.sent)
    json["packets"] = {
        {"sent", r.sent->sent}, {"failed", r.sent->failed + r.sent->dropped}, {"unaddressed", r.unaddressed}};
  json["tags"] = Json::array();
  for (const auto& [id, tag] : r.tags)
    json["tags"].push_back({{"id", id},
                            {"time_s", tag.time},
                            {"pose", {tag.X_WT.x, tag.X_WT.y, tag.X_WT.yaw}},
                            {"velocity", {tag.velocity.x, tag.velocity.y}},
                            {"turn", tag.turn},
                            {"states", r.reported.at(id)}});
  return json.dump(2) + "\n";
}

}  // namespace sf::apps
