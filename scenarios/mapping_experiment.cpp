// The thesis' area mapping: its obstacle avoidance as it describes it, and the explorer that we would use instead.

#include <fmt/format.h>

#include "maps/text.h"
#include "scenarios/coverage.h"
#include "scenarios/experiment.h"
#include "viz/map_figure.h"
#include "viz/trajectory_figure.h"

namespace sf::scenarios {

namespace {

/// What came of one trial.
struct Mapped {
  std::string controller;
  std::uint32_t trial = 0;
  double simulated = 0.0;  ///< [s]
  bool done = false;
  std::uint64_t contacts = 0;
  double travelled = 0.0;  ///< [m]
  double coverage = 0.0;   ///< [-]
  double wrong = 0.0;      ///< [-] of the known cells
};

std::string csv_of(const std::vector<Mapped>& rows) {
  std::string text = "controller,trial,seconds,done,contacts,driven_m,coverage,disagreement\n";
  for (const Mapped& m : rows)
    text += fmt::format("{},{},{:.1f},{},{},{:.4g},{:.5f},{:.5f}\n", m.controller, m.trial, m.simulated, m.done ? 1 : 0,
                        m.contacts, m.travelled, m.coverage, m.wrong);
  return text;
}

std::string report_of(const Bench& bench, const std::vector<Mapped>& rows) {
  std::string text = fmt::format(
      "# {}\n\n{}\n\nThe map is made by the robot of its own pose, 3 cm a cell. Coverage is the part of all cells that "
      "could be seen free from some collision-free pose connected to the start; `wrong` is the part of known cells "
      "that "
      "are free here and occupied in that reference, or the other way round (cells on walls' faces go either way).\n\n"
      "| controller | trial | time [s] | done | contacts | driven [m] | coverage | wrong |\n"
      "|---|---|---|---|---|---|---|---|\n",
      bench.scenario.name, setup_of(bench, {}));
  for (const Mapped& m : rows)
    text +=
        fmt::format("| {} | {} | {:.0f} | {} | {} | {:.1f} | {:.1f} % | {:.2f} % |\n", m.controller, m.trial,
                    m.simulated, m.done ? "yes" : "no", m.contacts, m.travelled, 100.0 * m.coverage, 100.0 * m.wrong);
  return text + "\nThe thesis gives no numbers; its maps are figures 44 and 45. docs/experiments.md says more.\n";
}

/// Trials of one controller: rows, tracks and maps.
void run_with(const Bench& bench, const std::string& controller, std::vector<Mapped>& rows,
              std::vector<std::string>& files) {
  Scenario scenario = bench.scenario;
  if (controller != scenario.actor.plan.controller) scenario.actor.plan = {controller, 0.0, {}};
  ExperimentOptions options = bench.options;
  options.out = in_folder(bench, controller);
  const Bench own{scenario, options, bench.device, bench.progress};
  const std::vector<Trial> trials = run_trials(own, {.maps = true});
  const world::World world = world_of(scenario);
  std::vector<viz::Track> tracks;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const Trial& trial = trials[k];
    const maps::Grid reference = what_could_be_seen(world, trial.mapped.front(), trial.maps.front().plan);
    rows.push_back({controller, static_cast<std::uint32_t>(k + 1), trial.simulated, trial.done,
                    trial.counts.front().contacts, trial.counts.front().travelled,
                    coverage(trial.maps.front(), reference), disagreement(trial.maps.front(), reference)});
    tracks.push_back(trial.tracks.front());
    tracks.back().name = fmt::format("trial {}", k + 1);
  }
  files.push_back(in_folder(bench, controller + "-trajectories.png"));
  viz::draw_trajectories(world, tracks, files.back());
  files.push_back(in_folder(bench, controller + "-map.txt"));
  write_text(files.back(), maps::text_of(trials.front().maps.front()));
  files.push_back(in_folder(bench, controller + "-map.png"));
  const viz::Track& track = trials.front().tracks.front();
  viz::draw_map(trials.front().maps.front(),
                {.title = "Map of trial 1: " + controller, .places = {{track.name, track.poses.back()}}}, files.back());
}

std::vector<std::string> run_mapping(const Bench& bench) {
  std::vector<Mapped> rows;
  std::vector<std::string> files{in_folder(bench, "statistics.csv"), in_folder(bench, "report.md")};
  run_with(bench, bench.scenario.actor.plan.controller, rows, files);
  if (control::find_controller("explore") != nullptr) run_with(bench, "explore", rows, files);
  write_text(files[0], csv_of(rows));
  write_text(files[1], report_of(bench, rows));
  return files;
}

}  // namespace

extern const ExperimentKind mapping_experiment;

constinit const ExperimentKind mapping_experiment{
    .name = "mapping",
    .summary = "mapping an area by laser, with the thesis' obstacle avoidance and with an explorer (figures 44, 45)",
    .plant = Plant::ideal,
    .run = run_mapping,
};

}  // namespace sf::scenarios
