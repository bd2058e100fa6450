#include "bench/report.h"

#include <fmt/format.h>

#include <fstream>

#include "base/error.h"
#include "base/hash.h"

namespace sf::bench {

void write(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text;
  if (!out.flush())
    throw base::InputError(file, 0, "cannot be written: name a folder that exists with --results=FOLDER");
}

std::string heading(std::string_view rate) {
  return fmt::format("{:<36} {:>9} {:>9} {:>9} {:>7} {:>7}", "method", "wall ms", "cpu ms", rate, "ratio", "(cpu)");
}

std::string row(const Timing& timing, double count) {
  return fmt::format("{:<36} {:>9.2f} {:>9.2f} {:>9.2f} {:>7.2f} {:>7.2f}", timing.method, 1e3 * timing.typical.wall_s,
                     1e3 * timing.typical.cpu_s, 1e-6 * count / timing.typical.wall_s, timing.ratio, timing.cpu_ratio);
}

namespace {

/// Quotes a CSV field that may contain a comma.
std::string quoted(const std::string& text) { return "\"" + text + "\""; }

std::string scans_csv(const std::vector<Comparison>& scans) {
  std::string text =
      "scene,method,robots,rays,range_m,wall_ms_median,cpu_ms_median,mrays_per_s,ratio_to_embree,"
      "cpu_ratio_to_embree,max_error_m,hash\n";
  for (const Comparison& o : scans)
    for (const MethodResult& e : o.method_results)
      text += fmt::format("{},{},{},{},{},{:.3f},{:.3f},{:.2f},{:.3f},{:.3f},{:.3g},{}\n", quoted(o.scene),
                          quoted(e.method), o.robots, o.rays, o.range_m, 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s,
                          mrays_per_s(o.rays, e.typical), e.ratio, e.cpu_ratio, e.accuracy.max_error_m,
                          base::hash_hex(e.hash));
  return text;
}

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

std::string ticks_csv(const std::vector<TickResult>& ticks) {
  std::string text =
      "scene,what,robots,rays,range_m,wall_ms_median,cpu_ms_median,mrays_per_s,real_time_factor,move_ms,place_ms,"
      "lists_ms,device_ms,collect_ms,decide_ms,beams_in_doubt,cells_built_per_tick,max_error_m,hash\n";
  for (const TickResult& d : ticks) {
    const Stages s = stages_of(d);
    text += fmt::format(
        "{},{},{},{},{},{:.3f},{:.3f},{:.2f},{:.1f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.4f},"
        "{:.1f},{:.3g},{}\n",
        quoted(d.scene), d.what, d.robots, d.rays, d.range_m, 1e3 * d.typical.wall_s, 1e3 * d.typical.cpu_s,
        mrays_per_s(d.rays, d.typical), d.interval_s / d.typical.wall_s, s.move, s.place, s.lists, s.device, s.collect,
        s.decide, s.doubts, s.cells, d.accuracy.max_error_m, base::hash_hex(d.hash));
  }
  return text;
}

std::string facts_csv(const std::vector<Measurement>& facts) {
  std::string text = "what,value,unit\n";
  for (const Measurement& f : facts) text += fmt::format("{},{:.4g},{}\n", quoted(f.what), f.value, f.unit);
  return text;
}

}  // namespace

void write_csv(const Book& book, const std::string& folder) {
  if (!book.scans.empty()) write(folder + "/scans.csv", scans_csv(book.scans));
  if (!book.ticks.empty()) write(folder + "/ticks.csv", ticks_csv(book.ticks));
  if (!book.facts.empty()) write(folder + "/facts.csv", facts_csv(book.facts));
  if (!book.prices.empty()) write(folder + "/prices.csv", facts_csv(book.prices));
}

std::string tables(const Book& book) {
  std::string text;
  for (const Comparison& o : book.scans) {
    text += fmt::format("\n{}: {} robots, {} rays, {} m\n{}  max err m  hash\n", o.scene, o.robots, o.rays, o.range_m,
                        heading("Mrays/s"));
    for (const MethodResult& e : o.method_results)
      text += row(e, static_cast<double>(o.rays)) +
              fmt::format(" {:>10.1e}  {}\n", e.accuracy.max_error_m, base::hash_hex(e.hash));
  }
  if (!book.ticks.empty())
    text += fmt::format(
        "\nwhole ticks\n{:<34} {:>8} {:>8} {:>8} {:>6} | {:>6} {:>6} {:>7} {:>7} {:>7} {:>6} | {:>6} {:>7} {:>8}\n", "",
        "wall ms", "cpu ms", "Mrays/s", "x real", "move", "place", "lists", "device", "collect", "decide", "uncert",
        "cells/t", "max err");
  for (const TickResult& d : book.ticks) {
    const Stages s = stages_of(d);
    text += fmt::format(
        "{:<34} {:>8.2f} {:>8.2f} {:>8.1f} {:>6.1f} | {:>6.2f} {:>6.2f} {:>7.2f} {:>7.2f} {:>7.2f} {:>6.2f} | "
        "{:>5.2f}% {:>7.1f} {:>8.1e}\n",
        fmt::format("{} {} {}, {} m", d.scene, d.robots, d.what, d.range_m), 1e3 * d.typical.wall_s,
        1e3 * d.typical.cpu_s, mrays_per_s(d.rays, d.typical), d.interval_s / d.typical.wall_s, s.move, s.place,
        s.lists, s.device, s.collect, s.decide, 100.0 * s.doubts, s.cells, d.accuracy.max_error_m);
  }
  if (!book.facts.empty()) text += "\nsingle figures\n";
  for (const Measurement& f : book.facts) text += fmt::format("{:<60} {:>10.4g} {}\n", f.what, f.value, f.unit);
  if (!book.prices.empty()) text += "\ncost of features\n";
  for (const Measurement& f : book.prices) text += fmt::format("{:<88} {:>10.4g} {}\n", f.what, f.value, f.unit);
  return text;
}

}  // namespace sf::bench
