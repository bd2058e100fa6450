// `tradeoff`: measures the accuracy and cost of each accuracy mode of a world's sensors on this machine. Also
// implements `--auto`, which chooses modes by these measurements.

#include "apps/options/automatic_accuracy.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "apps/commands/commands.h"
#include "apps/commands/rank_run.h"
#include "apps/options/default_robot.h"
#include "apps/options/open_device.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "scenarios/experiment.h"
#include "sensors/accuracy.h"
#include "viz/tradeoff_figure.h"

namespace sf::apps {

namespace {

constexpr double kUsualMetres = 0.01;
constexpr double kUsualTesla = 1e-6;

/// Defaults to one centimetre and one microtesla.
scenarios::AccuracyTarget wish_of(const AccuracyTargetOptions& options) {
  scenarios::AccuracyTarget target = options.accuracy_target;
  if (target.least_rate > 0.0 || std::isfinite(target.metres) || std::isfinite(target.tesla)) return target;
  target.metres = kUsualMetres;
  target.tesla = kUsualTesla;
  return target;
}

/// Returns the unit in which readings of a sensor type are counted per second.
std::string_view counted_as(const std::string& sensor) {
  return sensor == "laser" ? "rays" : sensor == "laneedge" ? "edges" : sensor == "magnetometer" ? "fields" : "readings";
}

std::string target_text(const scenarios::AccuracyTarget& target) {
  if (target.least_rate > 0.0) return fmt::format("at {:g} Hz or more", target.least_rate);
  constexpr std::string_view kBy[] = {"a median error", "99 % of errors", "every error"};
  std::string text;
  if (std::isfinite(target.metres)) text += quantity_text(target.metres, "m");
  if (std::isfinite(target.tesla)) text += (text.empty() ? "" : " and ") + quantity_text(target.tesla, "T");
  return fmt::format("with {} within {}", kBy[static_cast<int>(target.by)], text);
}

std::string advice_text(const std::vector<scenarios::ModeResult>& results, const scenarios::AccuracyTarget& target) {
  return fmt::format("{} {}: --accuracy \"{}\"\n", target.least_rate > 0.0 ? "most accurate" : "fastest",
                     target_text(target), scenarios::accuracy_words(results, scenarios::select_modes(results, target)));
}

void draw(const std::string& world, const std::string& device, const std::vector<scenarios::ModeResult>& results,
          const std::string& file, const viz::Page& page) {
  std::vector<viz::TradeoffPanel> panels;
  for (const scenarios::ModeResult& g : results) {
    if (panels.empty() || panels.back().title != g.sensor)
      panels.push_back(
          {g.sensor,
           fmt::format("{} per second", counted_as(g.sensor)),
           fmt::format(
               "error of all [{}]: median, 99 %, largest; of covered elements: ring the bound, cross the largest",
               g.unit),
           {}});
    panels.back().points.push_back(
        {g.mode, g.rate, g.median, g.p99, g.max, g.front, {g.covered, g.covered_max, g.bound}});
  }
  viz::draw_tradeoff("Speed against error: " + world,
                     "whole ticks on " + device + "; blue: Pareto-optimal in speed and 99th percentile of errors",
                     panels, file, page);
}

void write(const TradeoffOptions& options, const world::World& world, const gpu::Device& device,
           const std::vector<scenarios::ModeResult>& results) {
  scenarios::make_folder(options.out);
  const std::filesystem::path folder(options.out);
  scenarios::write_text((folder / "tradeoff.csv").string(), scenarios::csv_of(results));
  draw(world.name, device.info().name, results, (folder / ("tradeoff." + options.format)).string(), options.page);
}

std::vector<scenarios::ModeResult> measure(const world::World& world, gpu::Device& device, std::uint64_t seed,
                                           unsigned threads) {
  Progress progress("measuring");
  return scenarios::tradeoff(world, device, {seed, threads, [&](double part) {
                                               progress.show(part);
                                               return !stop_requested();
                                             }});
}

}  // namespace

std::string mode_results_text(const std::vector<scenarios::ModeResult>& results) {
  std::string text =
      fmt::format("{:<36}{:<35}  {}\n", "", "--- covered by a stated bound ---", "--- errors of all ---");
  text += fmt::format("{:<13} {:<8} {:>12} {:>11} {:>11} {:>11} {:>10} {:>10} {:>10}\n", "sensor", "mode", "per second",
                      "covered", "largest", "bound", "median", "99 %", "largest");
  for (const scenarios::ModeResult& g : results)
    text += fmt::format("{:<13} {:<8} {:>12} {:>9.2f} % {:>11} {:>11} {:>10} {:>10} {:>10} {}\n", g.sensor, g.mode,
                        fmt::format("{:.4g}", g.rate), 100.0 * g.covered,
                        g.covered > 0.0 ? quantity_text(g.covered_max, g.unit) : "-", bound_text(g.bound, g.unit),
                        quantity_text(g.median, g.unit), quantity_text(g.p99, g.unit), quantity_text(g.max, g.unit),
                        g.front ? "*" : "");
  text += "* Pareto-optimal: no other mode of the type is both faster and more accurate (99th percentile)\n";
  text +=
      "A bound holds for the covered elements; the others are flagged and may have any of the errors of all.\nAll "
      "errors are measured without noise.\n\n";
  for (const scenarios::ModeResult& g : results) text += fmt::format("{:<13} {:<8} {}\n", g.sensor, g.mode, g.what);
  return text + "\n";
}

void choose_accuracy(world::World& world, gpu::Device& device, const AccuracyTargetOptions& options, std::uint64_t seed,
                     unsigned threads) {
  if (!options.automatic) return;
  install_stop_handlers();
  const scenarios::AccuracyTarget target = wish_of(options);
  const auto results = measure(world, device, seed, threads);
  if (stop_requested()) throw Incomplete("interrupted while measuring accuracy modes: nothing was run");
  const std::string words = scenarios::accuracy_words(results, scenarios::select_modes(results, target));
  print_message("measured; {}: --accuracy \"{}\"", target_text(target), words);
  sensors::set_accuracy(world, words);
}

namespace {

int measure_alone(const TradeoffOptions& options) {
  const world::World world = load_with_robots(options, options);
  gpu::Device device = open_device(options);
  install_stop_handlers();
  const scenarios::AccuracyTarget target = wish_of(options);
  const auto results = measure(world, device, options.seed, options.threads);
  if (stop_requested()) throw Incomplete("interrupted: nothing was written");
  if (results.empty()) {
    std::vector<std::string> words;
    for (const sensors::SensorType* type : sensors::sensor_types())
      if (!type->modes.empty()) words.push_back(std::string(type->word.type) + "( )");
    throw base::InputError(world.file, 0,
                           "has no sensor with more than one accuracy mode; expected one of " + join_or(words));
  }
  if (!options.out.empty()) write(options, world, device, results);
  const std::string words = scenarios::accuracy_words(results, scenarios::select_modes(results, target));
  const std::string text = options.json        ? with_warnings(mode_results_json(results, target), world.warnings)
                           : options.automatic ? words + "\n"
                                               : mode_results_text(results) + advice_text(results, target);
  print(text);
  return 0;
}

}  // namespace

int tradeoff(const TradeoffOptions& options) {
  return with_ranks([&](cluster::Ranks* ranks) {
    on_all(ranks, [&] {
      if (ranks != nullptr)
        throw base::InputError("tradeoff measures the speed of a single process: run it without mpirun");
    });
    return measure_alone(options);
  });
}

}  // namespace sf::apps
