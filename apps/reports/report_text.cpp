#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/reports/mesh_report.h"
#include "apps/reports/rate_warnings.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/hash.h"
#include "raycast/casters.h"
#include "sensors/accuracy.h"
#include "sensors/magnetic_field/truncation.h"

namespace sf::apps {

namespace {

std::string rate(double per_second) {
  return per_second >= 1e6 ? fmt::format("{:.1f} million/s", per_second * 1e-6) : fmt::format("{:.0f}/s", per_second);
}

std::string device_text(const RunReport& f) {
  return f.device + (f.software ? " (software: computed on the CPU)" : "");
}

std::string sensors_text(const sensors::SensorSet& sensor_set) {
  std::string text;
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    std::size_t elements = 0;
    for (const sensors::SensorSpec& sensor : group.rows) elements += sensor.elements;
    const std::string list = group.type->list.empty() ? "" : fmt::format(" ({} {} in all)", elements, group.type->list);
    text += row(group.type->name, "{}{}", group.rows.size(), list);
  }
  return text;
}

std::string accuracy_text(const world::World& world, const sensors::SensorSet& sensor_set) {
  std::string text;
  for (const sensors::AccuracyStatement& s : sensors::accuracy_statements(world, sensor_set))
    text += row(text.empty() ? "accuracy" : "", accuracy_statement_text(s));
  return text;
}

std::string rates_text(const world::World& world, const sensors::SensorSet& sensor_set) {
  std::string rates;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    rates += (rates.empty() ? "" : ", ") + rate_text(group);
  const std::vector<std::string> between = types_between_ticks(sensor_set, world.interval);
  return row("rates", rates) +
         (between.empty() ? "" : row("", "also read between ticks: {}", fmt::join(between, ", ")));
}

std::string paint_text(const world::World& world) {
  if (world.lane_markings.empty()) return "";
  const double cell = world.road_resolution;
  return row("paint", "{}, sensed {}", counted(world.lane_markings.size(), "stripe"),
             cell > 0.0 ? fmt::format("as a raster of {:g} m", cell) : "exactly");
}

std::string earth_text(const world::World& world) {
  const glm::dvec3 gauss = 1e4 * world.earth_field;
  if (gauss == glm::dvec3{}) return "";
  return row("Earth's field", "[{:.4g} {:.4g} {:.4g}] Gauss, of {:.4g} Gauss", gauss.x, gauss.y, gauss.z,
             glm::length(gauss));
}

std::string magnets_text(const world::World& world) {
  const std::size_t magnets = count_magnets(world);
  if (magnets == 0) return "";
  if (world.magnet_cutoff == 0.0) return row("magnets", "{}, without cutoff", magnets);
  const sensors::MagnetSummary facts = sensors::summarize_magnets(world);
  return row("magnets", "{}, cut off at {:g} m", magnets, facts.cutoff_m) +
         row("", "the omitted field is at most {} T ({} Gauss), {:g} m above the ground", rounded_up(facts.bound_T),
             rounded_up(1e4 * facts.bound_T), facts.height_m);
}

std::string street_text(const world::World& world) {
  const std::size_t docks = count_docks(world), walls = world.emitters.size() - docks;
  std::string text;
  if (!world.lights.empty()) text += row("traffic lights", world.lights.size());
  if (docks > 0) text += row("docks", docks);
  if (walls > 0) text += row("virtual walls", walls);
  if (!world.lamps.empty()) text += row("lamps", world.lamps.size());
  if (!world.heat_sources.empty()) text += row("heat sources", world.heat_sources.size());
  if (!world.floor_holes.empty())
    text += row("holes", "{}, visible to cliff sensors and lidars", world.floor_holes.size());
  if (!world.paths.empty()) text += row("paths", world.paths.size());
  return text;
}

}  // namespace

std::string accuracy_statement_text(const sensors::AccuracyStatement& s) {
  const std::string_view unit = sensors::unit_of(*s.type);
  const std::string quiet = std::isinf(s.bound.error) ? "no bound" : "within " + bound_text(s.bound.error, unit);
  std::string error = quiet;
  if (s.sigma > 0.0 && std::isfinite(s.bound.error))
    error = fmt::format("no bound, noise{}; without noise {}",
                        std::isinf(s.sigma) ? "" : " of sigma " + quantity_text(s.sigma, unit), quiet);
  return fmt::format("{} {}, {}{}{}", counted(s.sensors, s.type->name), sensors::word_of(*s.type, s.mode), error,
                     s.bound.condition.empty() ? "" : ": ", s.bound.condition);
}

std::string device_list_text(const gpu::DeviceList& list) {
  std::string text;
  for (std::size_t i = 0; i < list.devices.size(); ++i) {
    const gpu::DeviceInfo& d = list.devices[i];
    const bool host = d.name == gpu::kHostDevice;
    text += fmt::format("{} {}  {}\n", d.chosen ? "*" : " ", host ? " " : std::to_string(i), d.name);
    text += host ? fmt::format("     {}, {}\n", d.kind, d.driver)
                 : fmt::format("     {}, Vulkan {}, {}{}\n", d.kind, d.api, d.driver,
                               d.software ? " (software: computed on the CPU)" : "");
    text += fmt::format("     self-check {}\n", d.self_check);
    if (d.chosen) text += fmt::format("     rays are cast by: {}\n", raycast::describe_caster(d.software));
    text += d.chosen ? "     chosen\n" : fmt::format("     refused: {}\n", d.reason);
  }
  return text;
}

std::string world_report_text(const world::World& world, const sensors::SensorSet& sensor_set) {
  const std::size_t robots = count_robots(world);
  const world::Extent& e = world.extent;
  std::string text = warnings_text(world.warnings);
  text += fmt::format("{}\n", world.name.empty() ? world.file : world.name);
  text += row("models", world.models.size());
  text += row("robots", robots);
  if (world.movers.size() > robots) text += row("tags", world.movers.size() - robots);
  text += sensor_set.groups().empty()
              ? row("sensors", "none")
              : sensors_text(sensor_set) + rates_text(world, sensor_set) + accuracy_text(world, sensor_set);
  text += row("wall segments", world.walls.size());
  text += surfaces_text(world);
  text += paint_text(world) + magnets_text(world) + earth_text(world) + street_text(world);
  if (!world.shapes.empty()) text += row("shapes", world.shapes.size());
  text += row("extent", "x {:.3f} to {:.3f} m, y {:.3f} to {:.3f} m", e.x_min, e.x_max, e.y_min, e.y_max);
  text += row("tick", "{:g} s", world.interval);
  for (const auto& [type, count] : world.unmodelled) text += row("kept as bodies", "{} x {}", count, type);
  text += row("hash", base::hash_hex(world.hash));
  text += row("warnings", world.warnings.size());
  return text;
}

namespace {

/// Returns readings and rays, with their rates over the whole run and over the sensing time.
std::string work_text(const RunReport& f) {
  const double sensing = f.farm.place_s + f.farm.lists_s + f.farm.device_s + f.farm.collect_s;
  const auto rows = [&](const char* what, std::uint64_t count) {
    const auto per = [&](double seconds) { return rate(seconds > 0.0 ? static_cast<double>(count) / seconds : 0.0); };
    return row(what, "{}, {} of the whole run", count, per(f.wall_s)) + row("", per(sensing) + " while sensing");
  };
  const sensors::SensorStats& work = f.farm.work;
  std::string text = work.rays > 0 || work.dipoles == 0 ? rows("rays", work.rays) : "";
  if (work.dipoles > 0) text += rows("dipoles", work.dipoles);
  if (f.farm.missed > 0)
    text += row("missed", "{}, besides {}: newer ones were due at the same tick", f.farm.missed,
                counted(f.farm.readings, "reading"));
  if (f.farm.dropped > 0)
    text += row("dropped", "{}, besides {}: no processor time was left", f.farm.dropped,
                counted(f.farm.readings, "reading"));
  if (work.host_scans > 0)
    text +=
        row("cast on the host",
            "{} scans that the device cannot take: too many surfaces, terrain, or rolling in motion", work.host_scans);
  std::string faults;
  for (std::size_t kind = 0; kind < f.farm.faults.size(); ++kind)
    if (f.farm.faults[kind] > 0)
      faults += fmt::format("{}{} {}", faults.empty() ? "" : ", ", base::kFaultNames[kind], f.farm.faults[kind]);
  if (!faults.empty()) text += row("faulty readings", faults);
  if (f.farm.reused > 0)
    text += row("reused", "{} of {}: nothing had moved", f.farm.reused, counted(f.farm.readings, "reading"));
  return text;
}

/// Returns the results of the controllers.
std::string control_text(const ControlReport& f) {
  if (f.robots == 0) return "";
  std::string text = row("controller", "{}: {} of {} done", f.controller, f.done, counted(f.robots, "robot"));
  if (f.error.steps > 0) text += row("control error", error_summary_text(f.error));
  if (f.localization.steps > 0) text += row("localization error", localization_error_text(f.localization));
  if (f.has_goals) text += row("checkpoints", "{} passed", f.checkpoints);
  constexpr std::size_t kLines = 5;
  for (std::size_t i = 0; i < std::min(f.standing.size(), kLines); ++i)
    text += row(i == 0 ? "at rest at the end" : "", standing_text(f.standing[i]));
  if (f.standing.size() > kLines)
    text += row("", "and robots for {} (--json has all)", counted(f.standing.size() - kLines, "other reason"));
  return text;
}

/// Returns the number of datagrams that never reached the program.
std::string drops_text(std::uint64_t drops) {
  return row("dropped by the operating system", "{}: they arrived faster than they were read", drops);
}

std::string packets_text(const server::PublisherCounts& publisher) {
  const netio::OutboxCounts& packets = publisher.packets;
  std::string text =
      row("packets sent", "{} ({:.1f} MB)", packets.sent, static_cast<double>(packets.sent_bytes) * 1e-6);
  if (packets.failed + packets.dropped > 0)
    text +=
        row("packets not sent", "{} failed ({}), {} dropped", packets.failed, packets.first_failure, packets.dropped);
  if (publisher.dropped > 0) text += row("readings not sent", "{}: no bytes were left", publisher.dropped);
  if (publisher.not_numbers > 0) text += row("packets not built", "{}: readings with NaN", publisher.not_numbers);
  return text;
}

/// Returns the counts by verdict ("used 120, outlier 2"), the states rejected because of clocks, and the clocks.
std::string states_text(const RunReport& f) {
  std::string counts;
  const auto add = [&](std::string_view what, std::uint64_t count) {
    if (count > 0) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", what, count);
  };
  for (std::size_t k = 0; k < f.states.states.size(); ++k)
    add(name(static_cast<estimation::Verdict>(k)), f.states.states[k]);
  for (const auto refused : {estimation::ClockVerdict::future, estimation::ClockVerdict::late})
    add(fmt::format("{} by its clock", name(refused)), f.states.clocks[static_cast<std::size_t>(refused)]);
  add("beyond the limit per tick", f.states.flooded);
  std::string text = row("states", counts.empty() ? "none" : counts);
  constexpr std::size_t kLines = 5;
  for (std::size_t i = 0; i < std::min(f.clocks.size(), kLines); ++i) {
    const auto& [who, clock] = f.clocks[i];
    text += row(i == 0 ? "clocks" : "", "{} {:+.6f} s{}{}", who, 1e-9 * static_cast<double>(clock.offset),
                clock.drift_known ? fmt::format(", {:+.1f} ppm", 1e6 * clock.drift) : "",
                clock.steps > 0 ? ", stepped " + counted(clock.steps, "time") : "");
  }
  if (f.clocks.size() > kLines) text += row("", "and {} more (--json has all)", f.clocks.size() - kLines);
  return text;
}

std::string lockstep_text(const server::LockstepCounts& counts) {
  std::string text = row("commands", "{}; {} repeated, {} refused", counts.commands, counts.repeated, counts.refused);
  if (counts.fetched > 0) text += row("  datagrams", "{} sent on request", counts.fetched);
  if (counts.lost_robots > 0)
    text += row("  LEFT OUT", "{}, whose client timed out", counted(counts.lost_robots, "robot"));
  return text;
}

std::string strayed_text(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 5;
  const auto shown = std::span(names).first(std::min(names.size(), kShown));
  return row("left known space", "{}: {}{}", counted(names.size(), "robot"), fmt::join(shown, ", "),
             names.size() > kShown ? fmt::format(" and {} more (--json has all)", names.size() - kShown) : "");
}

}  // namespace

std::string run_report_text(const RunReport& f) {
  const double ticks = f.ticks > 0 ? static_cast<double>(f.ticks) : 1.0;
  const auto stage = [&](double seconds) { return fmt::format("{:8.3f} ms per tick", seconds * 1e3 / ticks); };
  std::string text = f.interrupted ? "Stopped before the end.\n" : "";
  text += row("device", device_text(f));
  text += row("caster", f.caster);
  text += row("robots", f.robots);
  text += row("ticks", f.ticks);
  text += row("simulated", "{:.1f} s in {:.2f} s: {:.1f} x real time", f.simulated_s, f.wall_s,
              f.wall_s > 0.0 ? f.simulated_s / f.wall_s : 0.0);
  text += work_text(f);
  if (f.contacts > 0) text += row("contacts", "{} that began", f.contacts);
  if (f.strayed && !f.strayed->empty()) text += strayed_text(*f.strayed);
  text += control_text(f.control);
  if (f.sent) text += packets_text(f.publisher);
  if (f.received) text += row("packets received", netio::packet_counts_text(f.inbox));
  if (f.lockstep) text += lockstep_text(*f.lockstep);
  if (f.socket_drops > 0) text += drops_text(f.socket_drops);
  if (f.filtered) text += states_text(f);
  const server::LightCounts& heard = f.lights.heard;
  if (heard.packets + heard.messages + heard.others + heard.invalid + heard.refused > 0)
    text += row("lights received", "{} V2I, {} SPaT; {} of others or MAP, {} invalid, {} refused", heard.packets,
                heard.messages, heard.others, heard.invalid, heard.refused);
  if (heard.silences > 0)
    text += row("  silent", counted(heard.silences, "time") + " that a received light fell silent");
  if (f.lights.sent > 0) text += row("lights sent", counted(f.lights.sent, "packet"));
  if (f.relayed.states + f.relayed.starts > 0)
    text += row("packets relayed", "{} V2V in {}, {} START", f.relayed.states, counted(f.relayed.datagrams, "datagram"),
                f.relayed.starts);
  if (f.relayed.centre > 0)
    text +=
        row("  to the control centre", "{} V2V{}", f.relayed.centre,
            f.relayed.missed > 0 ? fmt::format(", {} not sent: more than one tick's budget", f.relayed.missed) : "");
  if (f.relayed.waited > 0)
    text += row("  waited for", counted(f.relayed.waited, "time") + ": more robots request V2V than one tick serves");
  if (f.drives.sent + f.drives.dropped > 0)
    text += row("commands relayed", "{} DRIVE, {} dropped", f.drives.sent, f.drives.dropped);
  const server::FusionCounts& own = f.fusion;
  if (own.taken + own.incomplete + own.unfit + own.overtaken + own.mistimed > 0) {
    text += row("own readings", "{} taken, {} incomplete, {} overtaken, {} out of time; {} of other sensors", own.taken,
                own.incomplete, own.overtaken, own.mistimed, counted(own.unfit, "packet"));
    if (own.mapped > 0) text += row("  real walls", "in {} of simulated robots", counted(own.mapped, "reading"));
    text += row("  fused", "in {}, {:.0f} ms old in the mean, {:.0f} ms at most; too old for {}",
                counted(own.fused, "reading"), own.fused > 0 ? 1e3 * own.age_s / static_cast<double>(own.fused) : 0.0,
                1e3 * own.oldest_s, own.too_old);
  }
  if (f.lines_left_out > 0) text += row("log", counted(f.lines_left_out, "line") + " left out");
  if (!f.recording.empty())
    text += row("recording", "{} ({:.1f} MB)", f.recording, static_cast<double>(f.recorded_bytes) * 1e-6);
  if (!f.recording_error.empty()) text += row("", "INCOMPLETE: {}", f.recording_error);
  if (!f.video.file.empty()) text += row("video", "{} ({})", f.video.file, video_text(f.video));
  text += row("time: move", stage(f.move_s));
  text += row("  place movers", stage(f.farm.place_s));
  text += row("  lists, scans", stage(f.farm.lists_s));
  text += row("  device", stage(f.farm.device_s));
  text += row("  collect", stage(f.farm.collect_s));
  text += row("  send, record", stage(f.out_s));
  if (f.shared) {
    text += row("  other ranks", stage(f.shared->wait_s));
    text += row("ranks", "{}; {:.0f} bytes sent per robot and tick, slowest rank {:.2f} x the mean in sensing",
                f.shared->ranks, f.shared->bytes, f.shared->imbalance);
    if (f.shared->passed_on) text += row("tiles", "{} robots handed over between them", *f.shared->passed_on);
  }
  text += row("hash of readings", base::hash_hex(f.hash));
  return text;
}

namespace {

/// Returns readings by type: " (laser 120 with 43320 beams, laneedge 30)".
std::string shares_text(const netio::StreamSummary& summary) {
  std::string text;
  for (const sensors::SensorType* type : sensors::sensor_types()) {
    const auto found = summary.of.find(std::string(type->name));
    if (found == summary.of.end()) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", type->name, found->second.good);
    if (!type->list.empty()) text += fmt::format(" with {} {}", found->second.elements, type->list);
  }
  return text.empty() ? "" : " (" + text + ")";
}

}  // namespace

std::string stream_summary_text(const netio::StreamSummary& s) {
  std::string text = row("packets received", "{} ({:.1f} MB) on {}", s.datagrams, static_cast<double>(s.bytes) * 1e-6,
                         counted(s.ports, "port"));
  text += row("packets good", "{}{}", s.good, shares_text(s));
  text += row("packets lost", "{} ({}, {} reordered)", s.lost, counted(s.duplicates, "duplicate"), s.reordered);
  if (s.stale_states > 0) text += row("stale states", "behind {}", counted(s.stale_states, "good packet"));
  if (s.oldest_state > 0) text += row("oldest state", "{:.3g} s", 1e-9 * static_cast<double>(s.oldest_state));
  if (s.counts.dropped() > 0) text += row("by reason", netio::packet_counts_text(s.counts));
  if (s.socket_drops > 0) text += drops_text(s.socket_drops);
  if (s.silent_ports > 0) text += row("silent ports", s.silent_ports);
  return text;
}

}  // namespace sf::apps
