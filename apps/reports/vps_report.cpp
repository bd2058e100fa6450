#include "apps/reports/vps_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/reports/text.h"
#include "base/elementary.h"

namespace sf::apps {

namespace {

constexpr double kDegrees = 180.0 / M_PI;

std::string error_row(std::string_view name, const vision::RmsError& error, double scale, std::string_view unit) {
  if (error.count == 0) return "";
  return row(name, "{:.3f} {} RMS, {:.3f} largest", scale * error.rms(), unit, scale * error.largest);
}

std::string accuracy_text(const vision::Accuracy& a) {
  return error_row("position error", a.position, 1e3, "mm") +
         error_row("heading error", a.heading, kDegrees, "degrees") + error_row("height error", a.height, 1e3, "mm") +
         error_row("velocity error", a.velocity, 1e3, "mm/s") +
         error_row("turn rate error", a.turn, kDegrees, "degrees/s") +
         row("missed, false", "{}, {} of {} reported", a.missed, a.wrong, a.position.count + a.wrong);
}

/// Returns a table of measured heights and tilts; empty without any.
std::string heights_text(const VpsReport& r) {
  std::string text;
  for (const auto& [id, tag] : r.tags) {
    if (!(tag.height_sigma > 0.0)) continue;
    text += fmt::format("{:>6} {:>9.4f} {:>9.4f}", id, tag.X_WT.z, tag.height_sigma);
    if (tag.tilt_sigma > 0.0)
      text += fmt::format(" {:>9.2f} {:>9.2f} {:>9.2f}", kDegrees * tag.roll, kDegrees * tag.pitch,
                          kDegrees * tag.tilt_sigma);
    text += "\n";
  }
  if (text.empty()) return text;
  return fmt::format("\n{:>6} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "tag", "z m", "+-", "roll deg", "pitch deg", "+-") +
         text;
}

/// Returns a table of the tags that were followed and one of the cameras.
std::string follow_text(const VpsReport& r) {
  std::string text = row("following", "{}, {}", counted(r.follow->starts, "start"), counted(r.follow->stops, "stop"));
  text +=
      fmt::format("\n{:>10} {:>8} {:>8} {:>10} {:>14}\n", "followed", "seen", "unseen", "hand-overs", "longest gap s");
  for (const auto& [id, use] : r.follow->tags)
    text += fmt::format("{:>10} {:>8} {:>8} {:>10} {:>14}\n", id, use.seen, use.unseen, use.hand_overs,
                        use.seen > 0 ? fmt::format("{:.2f}", use.longest_gap) : "-");
  text += fmt::format("\n{:>16} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "camera", "images", "whole", "parts", "asleep",
                      "unread", "pixels %");
  for (std::size_t i = 0; i < r.cameras.size(); ++i) {
    const vision::CameraUse& use = r.follow->cameras[i];
    text += fmt::format("{:>16} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9.2f}\n", r.cameras[i], use.images(), use.whole,
                        use.parts, use.asleep, use.unread, 100.0 * use.share());
  }
  return text;
}

}  // namespace

std::string vps_report_text(const VpsReport& r) {
  const auto images = static_cast<double>(r.counts.images);
  std::string text = row("cameras", r.cameras.size()) + row("images", r.counts.images);
  if (r.counts.unreadable > 0) text += row("", "{} of them unreadable", r.counts.unreadable);
  if (r.counts.frozen > 0)
    text += row("", "{} of them identical to the previous one: a camera is frozen", r.counts.frozen);
  if (r.counts.asleep > 0) text += row("", "{} of them not searched: their camera was asleep", r.counts.asleep);
  if (r.truth) {
    text += row("robots", "{} rendered, by {}", r.truth->robots, counted(r.truth->accepted, "packet"));
    if (r.truth->refused > 0)
      text += row("", "{} rejected: not V2V, or from a robot without a tag in the dictionary", r.truth->refused);
  }
  if (r.counts.images > 0)
    text += row("processing", "{:.1f} images/s, {:.1f} ms of CPU time per image", images / r.processing_s,
                1e3 * r.processing_cpu_s / images);
  text += row("sightings", "{}; {} tracked", r.counts.sightings, counted(r.tags.size(), "tag"));
  if (r.counts.unwanted > 0) text += row("", "{} of tags that are not followed", r.counts.unwanted);
  if (r.counts.unlisted > 0) text += row("", "{} with ids that the file does not list", r.counts.unlisted);
  if (r.counts.unfitted > 0) text += row("", "{} rejected: fewer than three sides with an edge", r.counts.unfitted);
  if (r.counts.misfitted > 0)
    text += row("", "{} rejected: unexpected side or shape (check tag_side, tag_height and the calibration)",
                r.counts.misfitted);
  if (r.refused > 0) text += row("", "{} rejected: too far from the tag's last position, or out of order", r.refused);
  if (r.counts.repeated > 0)
    text += row("", "{} dropped: their id was seen at another place in the same image or moment", r.counts.repeated);
  if (r.accuracy) text += accuracy_text(*r.accuracy);
  if (r.sent) {
    text += row("packets", "{} sent, {} failed", r.sent->sent, r.sent->failed + r.sent->dropped);
    if (r.unaddressed > 0) text += row("", "{} not sent: no address, or id 0", r.unaddressed);
    if (!r.sent->first_failure.empty()) text += row("", r.sent->first_failure);
  }
  if (!r.orientation.empty()) text += row("tags", r.orientation);
  if (r.follow) text += follow_text(r);
  if (r.tags.empty()) return text;
  text += fmt::format("\n{:>6} {:>9} {:>9} {:>9} {:>8} {:>10} {:>8}\n", "tag", "x m", "y m", "yaw deg", "m/s", "deg/s",
                      "states");
  for (const auto& [id, tag] : r.tags)
    text += fmt::format("{:>6} {:>9.4f} {:>9.4f} {:>9.2f} {:>8.3f} {:>10.2f} {:>8}\n", id, tag.X_WT.x, tag.X_WT.y,
                        kDegrees * tag.X_WT.yaw, base::hypot(tag.velocity.x, tag.velocity.y), kDegrees * tag.turn,
                        r.reported.at(id));
  return text + heights_text(r);
}

using Json = nlohmann::ordered_json;

static Json follow_json(const VpsReport& r) {
  Json json = {
      {"starts", r.follow->starts}, {"stops", r.follow->stops}, {"tags", Json::array()}, {"cameras", Json::array()}};
  for (const auto& [id, use] : r.follow->tags)
    json["tags"].push_back({{"id", id},
                            {"seen", use.seen},
                            {"unseen", use.unseen},
                            {"hand_overs", use.hand_overs},
                            {"longest_gap_s", use.longest_gap}});
  for (std::size_t i = 0; i < r.cameras.size(); ++i) {
    const vision::CameraUse& use = r.follow->cameras[i];
    json["cameras"].push_back({{"name", r.cameras[i]},
                               {"images", use.images()},
                               {"whole", use.whole},
                               {"parts", use.parts},
                               {"asleep", use.asleep},
                               {"unread", use.unread},
                               {"pixels_share", use.share()}});
  }
  return json;
}

std::string vps_report_json(const VpsReport& r) {
  Json json = {{"cameras", r.cameras.size()},
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
                 {"out_of_reach", r.refused},
                 {"repeated", r.counts.repeated}}}};
  if (r.accuracy) {
    const vision::Accuracy& a = *r.accuracy;
    const auto error = [](const vision::RmsError& e) { return Json{{"rms", e.rms()}, {"largest", e.largest}}; };
    json["accuracy"] = {{"position_m", error(a.position)},
                        {"heading_rad", error(a.heading)},
                        {"height_m", error(a.height)},
                        {"velocity_m_s", error(a.velocity)},
                        {"turn_rad_s", error(a.turn)},
                        {"reported", a.position.count + a.wrong},
                        {"missed", a.missed},
                        {"false", a.wrong}};
  }
  if (r.follow) json["refused"]["not_followed"] = r.counts.unwanted;
  if (r.follow) json["follow"] = follow_json(r);
  if (r.truth)
    json["truth"] = {{"robots", r.truth->robots}, {"accepted", r.truth->accepted}, {"refused", r.truth->refused}};
  if (r.sent)
    json["packets"] = {
        {"sent", r.sent->sent}, {"failed", r.sent->failed + r.sent->dropped}, {"unaddressed", r.unaddressed}};
  if (!r.orientation.empty()) json["orientation"] = r.orientation;
  json["tags"] = Json::array();
  for (const auto& [id, tag] : r.tags) {
    json["tags"].push_back({{"id", id},
                            {"time_s", tag.time},
                            {"pose", {tag.X_WT.x, tag.X_WT.y, tag.X_WT.yaw}},
                            {"velocity", {tag.velocity.x, tag.velocity.y}},
                            {"turn", tag.turn},
                            {"states", r.reported.at(id)}});
    if (tag.height_sigma > 0.0) json["tags"].back()["height_m"] = {{"mean", tag.X_WT.z}, {"sigma", tag.height_sigma}};
    if (tag.tilt_sigma > 0.0)
      json["tags"].back()["tilt_rad"] = {{"roll", tag.roll}, {"pitch", tag.pitch}, {"sigma", tag.tilt_sigma}};
  }
  return json.dump(2) + "\n";
}

}  // namespace sf::apps
