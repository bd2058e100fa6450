#include "bench/report.h"

#include <fmt/format.h>

#include <fstream>
#include <map>

#include "base/error.h"
#include "base/hash.h"

namespace sf::bench {

std::string heading(std::string_view rate) {
  return fmt::format("{:<36} {:>9} {:>9} {:>9} {:>7} {:>7}", "method", "wall ms", "cpu ms", rate, "ratio", "(cpu)");
}

std::string row(const Timing& timing, double count) {
  return fmt::format("{:<36} {:>9.2f} {:>9.2f} {:>9.2f} {:>7.2f} {:>7.2f}", timing.method, 1e3 * timing.typical.wall_s,
                     1e3 * timing.typical.cpu_s, 1e-6 * count / timing.typical.wall_s, timing.ratio, timing.cpu_ratio);
}

namespace {

void write(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text;
  if (!out.flush())
    throw base::InputError(file, 0, "cannot be written: name a folder that exists with --results=FOLDER");
}

/// Quotes a CSV field that may contain a comma.
std::string quoted(const std::string& text) { return "\"" + text + "\""; }

/// Mean durations of a tick's stages [ms], and shares of special cases.
struct Stages {
  double move, place, lists, device, collect, decide, doubts, cells;
};

Stages stages_of(const TickResult& d) {
  const auto n = static_cast<double>(d.ticks.size());
  const auto rays = static_cast<double>(d.stages.work.rays);
  return {1e3 * d.move_s,
          1e3 * d.stages.place_s / n,
          1e3 * d.stages.lists_s / n,
          1e3 * d.stages.device_s / n,
          1e3 * d.stages.collect_s / n,
          1e3 * d.decide_s,
          static_cast<double>(d.stages.work.uncertain) / rays,
          static_cast<double>(d.stages.work.cells_built) / n};
}

}  // namespace

Report scan_report(const Comparison& o) {
  Report report{"scans", "",
                "scene,method,robots,rays,range_m,wall_ms_median,cpu_ms_median,mrays_per_s,ratio_to_embree,"
                "cpu_ratio_to_embree,max_error_m,hash"};
  report.text = fmt::format("\n{}: {} robots, {} rays, {} m\n{}  max err m  hash\n", o.scene, o.robots, o.rays,
                            o.range_m, heading("Mrays/s"));
  const auto csv = [&](const MethodResult& e) {
    return fmt::format("{},{},{},{},{},{:.3f},{:.3f},{:.2f},{:.3f},{:.3f},{:.3g},{}\n", quoted(o.scene),
                       quoted(e.method), o.robots, o.rays, o.range_m, 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s,
                       mrays_per_s(o.rays, e.typical), e.ratio, e.cpu_ratio, e.accuracy.max_error_m,
                       base::hash_hex(e.hash));
  };
  add_methods(report, o.method_results, csv, [&](const MethodResult& e) {
    return row(e, static_cast<double>(o.rays)) +
           fmt::format(" {:>10.1e}  {}\n", e.accuracy.max_error_m, base::hash_hex(e.hash));
  });
  return report;
}

Report tick_report(const TickResult& d) {
  const Stages s = stages_of(d);
  const double factor = d.interval_s / d.typical.wall_s, wall = 1e3 * d.typical.wall_s, cpu = 1e3 * d.typical.cpu_s;
  return {"ticks",
          fmt::format("\nwhole ticks\n{:<34} {:>8} {:>8} {:>8} {:>6} | {:>6} {:>6} {:>7} {:>7} {:>7} {:>6} | {:>6} "
                      "{:>7} {:>8}\n",
                      "", "wall ms", "cpu ms", "Mrays/s", "x real", "move", "place", "lists", "device", "collect",
                      "decide", "uncert", "cells/t", "max err"),
          "scene,what,robots,rays,range_m,wall_ms_median,cpu_ms_median,mrays_per_s,real_time_factor,move_ms,place_ms,"
          "lists_ms,device_ms,collect_ms,decide_ms,beams_in_doubt,cells_built_per_tick,max_error_m,hash",
          fmt::format("{},{},{},{},{},{:.3f},{:.3f},{:.2f},{:.1f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.4f},"
                      "{:.1f},{:.3g},{}\n",
                      quoted(d.scene), d.what, d.robots, d.rays, d.range_m, wall, cpu, mrays_per_s(d.rays, d.typical),
                      factor, s.move, s.place, s.lists, s.device, s.collect, s.decide, s.doubts, s.cells,
                      d.accuracy.max_error_m, base::hash_hex(d.hash)),
          fmt::format("{:<34} {:>8.2f} {:>8.2f} {:>8.1f} {:>6.1f} | {:>6.2f} {:>6.2f} {:>7.2f} {:>7.2f} {:>7.2f} "
                      "{:>6.2f} | {:>5.2f}% {:>7.1f} {:>8.1e}\n",
                      fmt::format("{} {} {}, {} m", d.scene, d.robots, d.what, d.range_m), wall, cpu,
                      mrays_per_s(d.rays, d.typical), factor, s.move, s.place, s.lists, s.device, s.collect, s.decide,
                      100.0 * s.doubts, s.cells, d.accuracy.max_error_m)};
}

Report measurement_report(const std::string& file, const std::vector<Measurement>& measurements) {
  Report report{file, file == "prices" ? "\ncost of features\n" : "\nsingle figures\n", "what,value,unit"};
  for (const Measurement& f : measurements) {
    report.rows += fmt::format("{},{:.4g},{}\n", quoted(f.what), f.value, f.unit);
    report.text += fmt::format("{:<88} {:>10.4g} {}\n", f.what, f.value, f.unit);
    report.counters.emplace_back(f.what, f.value);
  }
  return report;
}

void write_csv(const std::vector<Report>& reports, const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const Report& report : reports) {
    std::string& file = files.try_emplace(report.file, report.columns + "\n").first->second;
    file += report.rows;
  }
  for (const auto& [name, text] : files) write(fmt::format("{}/{}.csv", folder, name), text);
}

std::string tables(const std::vector<Report>& reports) {
  std::map<std::string, std::string> files;
  for (const Report& report : reports) files.try_emplace(report.file, report.title).first->second += report.text;
  std::string text;
  for (const auto& [name, table] : files) text += table;
  return text;
}

}  // namespace sf::bench
