#include "apps/reports/robot_report.h"

#include <cmath>

#include <fmt/format.h>

#include "apps/reports/control_report.h"
#include "apps/reports/text.h"

namespace sf::apps {

namespace {

/// Returns readings by type: "laser 120, laneedge 30".
std::string types_text(const server::LinkCounts& link) {
  std::string text;
  for (const auto& [type, count] : link.whole) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", type, count);
  return text.empty() ? "it has no sensors" : text;
}

std::string injected_text(const netio::DelayCounts& counts) {
  return fmt::format("{} passed, {} lost{}", counts.passed, counts.lost,
                     counts.full > 0 ? fmt::format(", {} too many at once", counts.full) : "");
}

std::string direct_text(const netio::DirectV2vCounts& direct) {
  std::string text =
      row("direct V2V", "{} sent; {}", counted(direct.sent.sent, "packet"), netio::packet_counts_text(direct.packets));
  text += row("", "{}, {} out of radio range, {} of its own", counted(direct.duplicates, "duplicate"), direct.far,
              direct.own);
  if (direct.sent.failed + direct.sent.dropped > 0)
    text += row("  not sent", "{} failed ({}), {} dropped", direct.sent.failed, direct.sent.first_failure,
                direct.sent.dropped);
  if (direct.over_rate > 0) text += row("  unread", counted(direct.over_rate, "packet") + ": too many at once");
  if (direct.socket_drops > 0)
    text += row("", counted(direct.socket_drops, "packet") + " dropped by the operating system");
  return text;
}

std::string link_text(const server::LinkCounts& link) {
  const netio::ReceiverCounts& in = link.readings;
  std::string text = row("packets sent", link.sent.sent);
  if (link.sent.failed + link.sent.dropped > 0)
    text += row("packets not sent", "{} failed ({}), {} dropped", link.sent.failed, link.sent.first_failure,
                link.sent.dropped);
  text += row("readings", types_text(link));
  text += row("sensor packets", netio::packet_counts_text(in.packets));
  if (link.images) text += row("images", "{} whole, {} invalid", link.images->whole, link.images->invalid);
  if (link.stale > 0) text += row("", counted(link.stale, "reading") + " of a stale state");
  text += row("", "{} late, {}, {} lost", in.late, counted(in.duplicates, "duplicate"), in.lost);
  if (in.jumps > 0) text += row("", counted(in.jumps, "packet") + " implausibly far ahead");
  if (link.socket_drops > 0) text += row("", counted(link.socket_drops, "packet") + " dropped by the operating system");
  if (in.restarts > 0) text += row("", counted(in.restarts, "sensor") + " restarted");
  text += row("V2V and START", netio::packet_counts_text(link.packets));
  if (link.direct) text += direct_text(*link.direct);
  if (link.out.lost + link.in.lost > 0) {
    text += row("injected link, out", injected_text(link.out));
    text += row("  in", injected_text(link.in));
  }
  return text;
}

std::string own_state_text(const server::OwnStateStats& own) {
  std::string text;
  if (own.cameras) text += row("positions", "{} by TAG packets", netio::packet_counts_text(own.counts.packets));
  const control::LocalizationError& e = own.errors;
  if (e.steps > 0)
    text += row("position error", "RMS {:.1f} mm, largest {:.1f} mm and {:.2f} degrees", 1e3 * e.rms(), 1e3 * e.max,
                e.yaw_max * 180.0 / M_PI);
  text += std::isfinite(own.sigma) ? row("  estimated", "{:.1f} mm (standard deviation, at the end)", 1e3 * own.sigma)
                                   : row("  estimated", "never located");
  const estimation::Calibration& c = own.calibration;
  if (own.gyro)
    text += row("gyro", "bias {:.2f} ± {:.2f} degrees/s", c.gyro_bias.value * 180.0 / M_PI,
                c.gyro_bias.sigma * 180.0 / M_PI);
  if (own.gps) text += row("gps", "used");
  if (own.wheels)
    text += row("wheels", "left scale {:.4f} ± {:.4f}, right scale {:.4f} ± {:.4f}, track {:.1f} ± {:.1f} mm",
                c.left_scale.value, c.left_scale.sigma, c.right_scale.value, c.right_scale.sigma, 1e3 * c.track.value,
                1e3 * c.track.sigma);
  return text;
}

std::string real_robot_text(const server::RealRobotStats& real) {
  const server::RealRobotCounts& c = real.counts;
  std::string text = row("real robot", "{}: {}, {} wrong, {} outside frames, {}; started {}, line opened {}", real.type,
                         counted(c.frames, "frame"), c.wrong, counted(c.skipped_bytes, "byte"),
                         counted(c.timeouts, "timeout"), counted(c.starts, "time"), counted(c.lines, "time"));
  std::string sensors, facts;
  for (const auto& [type, count] : real.readings)
    sensors += fmt::format("{}{} {}", sensors.empty() ? "" : ", ", type, count);
  for (const server::RobotFact& fact : real.facts)
    facts += fmt::format("{}{} {:g}", facts.empty() ? "" : ", ", fact.name, fact.value);
  if (!sensors.empty()) text += row("  own sensors", sensors);
  if (!facts.empty()) text += row("  reported", facts);
  return text;
}

}  // namespace

std::string robot_client_text(const server::RobotClientStats& f) {
  std::string text = f.answered ? "" : fmt::format("No packets from the farm at {}.\n", f.farm);
  if (!f.started) text += "The start signal did not arrive.\n";
  text += row("robot", "{} (id {}), {}{}", f.robot, f.id, f.controller, f.done ? ": done" : "");
  text += row("ran", "{:.2f} s, {}", f.wall_s, counted(f.steps, "step"));
  text += link_text(f.link);
  if (f.map) {
    text += row("own map", "{} entered, {} sent in {}", counted(f.map->scans, "scan"), counted(f.map->maps, "map"),
                counted(f.map->sent.sent, "packet"));
    if (f.map->sent.failed + f.map->sent.dropped > 0)
      text += row("", "{} failed ({}), {} dropped", f.map->sent.failed, f.map->sent.first_failure, f.map->sent.dropped);
  }
  if (f.team) {
    text += row("team", "{} sent, {} of measurements ({} again); {} received, {} of measurements",
                counted(f.team->sent, "packet"), f.team->pieces, f.team->repeated, f.team->received,
                counted(f.team->changes, "set"));
    if (f.team->foreign + f.team->malformed + f.team->full + f.team->cut > 0)
      text +=
          row("", "{} of another area, {} malformed, {} beyond the limit, {} cut", counted(f.team->foreign, "packet"),
              counted(f.team->malformed, "set"), counted(f.team->full, "robot"), counted(f.team->cut, "claim"));
  }
  if (f.real) text += real_robot_text(*f.real);
  if (f.listens_for_spat)
    text += row("SPaT", "{}, {} of other lights or MAP, {} invalid", counted(f.lights.messages, "message"),
                f.lights.others, f.lights.invalid);
  if (f.lights.packets > 0) text += row("V2I", "{} of lights", counted(f.lights.packets, "packet"));
  if (f.lights.silences > 0)
    text += row("  silent", counted(f.lights.silences, "time") + " that a received light fell silent");
  text += row("driven", "{:.3f} m, to {:.3f}, {:.3f} m, {:.1f} degrees", f.distance_m, f.pose.x, f.pose.y,
              f.pose.yaw * 180.0 / M_PI);
  if (!f.stop_reason.empty()) text += row("stands still", f.stop_reason);
  if (f.own) text += own_state_text(*f.own);
  if (f.drives + f.drives_ignored > 0)
    text += row("remote commands", "{} followed, {} ignored", f.drives, f.drives_ignored);
  text += row("contacts", "{} that began", f.contacts);
  if (f.stops > 0) text += row("stopped", counted(f.stops, "time") + " for lack of readings or positions");
  if (f.dropped.processor + f.dropped.network > 0)
    text += row("dropped by farm", "{} for lack of processor time, {} for lack of bytes",
                counted(f.dropped.processor, "reading"), f.dropped.network);
  if (f.lines_left_out > 0) text += row("log", counted(f.lines_left_out, "line") + " left out");
  if (f.error.steps > 0) text += row("control error", error_summary_text(f.error));
  return text;
}

}  // namespace sf::apps
