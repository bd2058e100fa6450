#include <fmt/format.h>

#include <cmath>

#include "apps/facts.h"
#include "base/hash.h"

namespace sf::apps {

namespace {

std::string row(const char* name, const std::string& value) { return fmt::format("  {:<18} {}\n", name, value); }

std::string rate(double per_second) {
  return per_second >= 1e6 ? fmt::format("{:.1f} million/s", per_second * 1e-6) : fmt::format("{:.0f}/s", per_second);
}

std::string device_text(const RunFacts& f) { return f.device + (f.software ? " (software: computed on the CPU)" : ""); }

/// In quotes where a comma, a quote or a line end would be misread.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string text_of(const gpu::Survey& survey) {
  std::string text;
  for (std::size_t i = 0; i < survey.devices.size(); ++i) {
    const gpu::DeviceFacts& d = survey.devices[i];
    text += fmt::format("{} {}  {}\n", d.chosen ? "*" : " ", i, d.name);
    text += fmt::format("     {}, Vulkan {}, {}{}\n", d.kind, d.api, d.driver,
                        d.software ? " (software: computed on the CPU)" : "");
    text += d.chosen ? "     chosen\n" : fmt::format("     refused: {}\n", d.reason);
  }
  return text;
}

std::string text_of(const world::World& world) {
  std::size_t lasers = 0;
  std::size_t rays = 0;
  std::size_t robots = 0;
  for (const world::Mover& mover : world.movers) {
    robots += !mover.is_tag;
    lasers += mover.lasers.size();
    for (const world::Laser& laser : mover.lasers) rays += laser.samples;
  }
  const world::Extent& e = world.extent;
  std::string text;
  for (const world::Warning& w : world.warnings) text += fmt::format("{}:{}: warning: {}\n", w.file, w.line, w.message);
  text += fmt::format("{}\n", world.name.empty() ? world.file : world.name);
  text += row("models", fmt::format("{}", world.models.size()));
  text += row("robots", fmt::format("{}", robots));
  if (world.movers.size() > robots) text += row("tags", fmt::format("{}", world.movers.size() - robots));
  text += row("lasers", fmt::format("{} ({} rays in all)", lasers, rays));
  text += row("wall segments", fmt::format("{}", world.walls.size()));
  if (world.magnets > 0) text += row("magnets", fmt::format("{} (counted only)", world.magnets));
  text += row("extent", fmt::format("x {:.3f} to {:.3f} m, y {:.3f} to {:.3f} m", e.x_min, e.x_max, e.y_min, e.y_max));
  text += row("tick", fmt::format("{:g} s", world.interval));
  for (const auto& [type, count] : world.kept) text += row("kept as bodies", fmt::format("{} x {}", count, type));
  text += row("hash", base::hash_text(world.hash));
  text += row("warnings", fmt::format("{}", world.warnings.size()));
  return text;
}

std::string text_of(const RunFacts& f) {
  const double ticks = f.ticks > 0 ? static_cast<double>(f.ticks) : 1.0;
  const auto stage = [&](double seconds) { return fmt::format("{:8.3f} ms a tick", seconds * 1e3 / ticks); };
  std::string text = f.interrupted ? "Stopped before the end.\n" : "";
  text += row("device", device_text(f));
  text += row("robots", fmt::format("{}", f.robots));
  text += row("ticks", fmt::format("{}", f.ticks));
  text += row("simulated", fmt::format("{:.1f} s in {:.2f} s: {:.1f} x real time", f.simulated_s, f.wall_s,
                                       f.wall_s > 0.0 ? f.simulated_s / f.wall_s : 0.0));
  text += row("rays", fmt::format("{}, {} of the whole run", f.farm.rays,
                                  rate(f.wall_s > 0.0 ? static_cast<double>(f.farm.rays) / f.wall_s : 0.0)));
  const double computing = f.farm.place_s + f.farm.lists_s + f.farm.device_s + f.farm.collect_s;
  text += row("", rate(computing > 0.0 ? static_cast<double>(f.farm.rays) / computing : 0.0) + " while sensing");
  if (f.contacts > 0) text += row("contacts", fmt::format("{} robot-ticks", f.contacts));
  if (f.sent) {
    text += row("packets sent",
                fmt::format("{} ({:.1f} MB)", f.outbox.sent, static_cast<double>(f.outbox.sent_bytes) * 1e-6));
    if (f.outbox.failed + f.outbox.dropped > 0)
      text += row("packets not sent",
                  fmt::format("{} failed ({}), {} dropped", f.outbox.failed, f.outbox.first_failure, f.outbox.dropped));
  }
  if (f.received) text += row("packets received", netio::text(f.inbox));
  if (!f.recording.empty())
    text += row("recording", fmt::format("{} ({:.1f} MB)", f.recording, static_cast<double>(f.recorded_bytes) * 1e-6));
  text += row("time: move", stage(f.move_s));
  text += row("  place movers", stage(f.farm.place_s));
  text += row("  sector lists", stage(f.farm.lists_s));
  text += row("  device", stage(f.farm.device_s));
  text += row("  collect", stage(f.farm.collect_s));
  text += row("  send, record", stage(f.out_s));
  text += row("hash of readings", base::hash_text(f.hash));
  return text;
}

std::string text_of(const netio::Summary& s) {
  std::string text = row("packets received", fmt::format("{} ({:.1f} MB) on {} ports", s.datagrams,
                                                         static_cast<double>(s.bytes) * 1e-6, s.ports));
  text += row("packets good", fmt::format("{} ({} rays)", s.good, s.rays));
  text += row("packets lost", fmt::format("{} ({} duplicates, {} reordered)", s.lost, s.duplicates, s.reordered));
  if (s.counts.dropped() > 0) text += row("by reason", netio::text(s.counts));
  if (s.silent_ports > 0) text += row("silent ports", fmt::format("{}", s.silent_ports));
  return text;
}

std::string place_of(const world::World& world, const base::ReadingBlock& reading) {
  const world::Mover& mover = world.movers[reading.mover];
  const base::Pose& R = reading.X_WM;
  const base::Pose& S = reading.X_WS;
  constexpr double kDegrees = 180.0 / M_PI;
  return fmt::format("{} at ({:.6f}, {:.6f}) m, {:.6f} deg; its {} at ({:.6f}, {:.6f}, {:.6f}) m, {:.6f} deg",
                     mover.name, R.x, R.y, kDegrees * base::wrap_angle(R.yaw), mover.lasers[reading.sensor].name, S.x,
                     S.y, S.z, kDegrees * base::wrap_angle(S.yaw));
}

std::string text_of(const world::World& world, const base::ReadingBlock& reading) {
  const world::Laser& laser = world.movers[reading.mover].lasers[reading.sensor];
  std::string text = "bearing_rad,range_m,hit\n";
  for (std::uint32_t i = 0; i < reading.values.size(); ++i) {
    const std::uint32_t hit = reading.hits[i];
    text += fmt::format("{:.12f},{:.9f},{}\n", world::bearing_of(laser, i), reading.values[i],
                        hit == base::kNoHit ? "" : csv_field(world.models[hit].name));
  }
  return text;
}

}  // namespace sf::apps
