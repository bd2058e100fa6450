// Area mapping of the thesis: its obstacle avoidance as described there, compared with the explorer.

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "maps/map_text.h"
#include "scenarios/coverage.h"
#include "scenarios/experiment.h"
#include "scenarios/visible_area.h"
#include "viz/map_figure.h"
#include "viz/trajectory_figure.h"

namespace sf::scenarios {

namespace {

constexpr SupervisorSettings kSupervisor{.patience = 5.0};

/// A method of mapping the area.
struct Entrant {
  std::string name;
  control::ControllerConfig controller;
  SupervisorSettings supervisor;
  bool looks_about = false;  ///< whether it turns back and forth to look around, which is not a dead end
};

/// Result of one trial.
struct Mapped {
  std::string entrant;
  std::uint32_t trial = 0;
  double simulated = 0.0;  ///< [s]
  bool done = false;
  std::uint64_t contacts = 0;
  std::uint32_t interventions = 0;
  std::optional<std::uint32_t> dead_ends;  ///< nullopt: not counted
  double stuck = 0.0;                      ///< [s]
  double travelled = 0.0;                  ///< [m]
  Coverage seen;
  double wrong = 0.0;  ///< [-] of the known cells
};

std::string count_text(const std::optional<std::uint32_t>& count, const char* none) {
  return count ? std::to_string(*count) : none;
}

std::string csv_of(const std::vector<Mapped>& rows) {
  std::string text =
      "controller,trial,seconds,done,contacts,helped,dead_ends,stuck_s,driven_m,cells,missed,coverage,disagreement\n";
  for (const Mapped& m : rows)
    text += fmt::format("{},{},{:.1f},{},{},{},{},{:.1f},{:.4g},{},{},{:.6f},{:.5f}\n", m.entrant, m.trial, m.simulated,
                        m.done ? 1 : 0, m.contacts, m.interventions, count_text(m.dead_ends, ""), m.stuck, m.travelled,
                        m.seen.wanted, m.seen.missed, m.seen.coverage(), m.wrong);
  return text;
}

std::string report_of(const ExperimentContext& context, const std::vector<Mapped>& rows) {
  std::string text = fmt::format(
      "# {}\n"
      "\n"
      "{}\n"
      "\n"
      "The robot builds the map at its own poses, with cells of 3 cm. `cells missed` are cells that are visible as "
      "free from a collision-free pose connected to the start, but unexplored in the map. `wrong` is the part of known "
      "cells that are free here and occupied in that reference, or the other way round (cells on walls' faces go "
      "either way).\n"
      "\n"
      "`scrapes` are contacts that began. `by hand`: a supervisor takes a robot that has been stuck in contact for "
      "{:g} s, puts it back {:g} m along its path and turns it by {:.0f} degrees away from the contact. A `dead end`: "
      "the direction of turns in place (its own or by hand) reversed {} times within a body's length; it lasts until "
      "the robot is farther away than that. `stuck` is the time in dead ends or stopped in contact. `explore` turns "
      "back and forth to look around, so dead ends are not counted there.\n"
      "\n"
      "| controller | trial | time [s] | done | scrapes | by hand | dead ends | stuck [s] | driven [m] | cells missed "
      "| wrong |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n",
      context.scenario.name, setup_of(context, {}), kSupervisor.patience, kSupervisor.back,
      kSupervisor.turn * 180.0 / M_PI, kReversals);
  for (const Mapped& m : rows)
    text += fmt::format("| {} | {} | {:.0f} | {} | {} | {} | {} | {:.0f} | {:.1f} | {} | {:.2f} % |\n", m.entrant,
                        m.trial, m.simulated, m.done ? "yes" : "no", m.contacts, m.interventions,
                        count_text(m.dead_ends, "-"), m.stuck, m.travelled, coverage_text(m.seen), 100.0 * m.wrong);
  return text + fmt::format("\n## Comparison with the thesis\n\n{}\n", context.type.reasons);
}

Mapped mapped_of(const Entrant& entrant, std::uint32_t number, const Trial& trial,
                 const maps::OccupancyGrid& reference) {
  const RobotMetrics& counts = trial.counts.front();
  const DeadEndDetector& ends = trial.dead_ends.front();
  return {.entrant = entrant.name,
          .trial = number,
          .simulated = trial.simulated,
          .done = trial.done,
          .contacts = counts.contacts,
          .interventions = trial.interventions.front(),
          .dead_ends = entrant.looks_about ? std::nullopt : std::optional(ends.count()),
          .stuck = entrant.looks_about ? ends.standing_in_contact() : ends.stuck(),
          .travelled = counts.travelled,
          .seen = coverage_of(trial.maps.front(), reference),
          .wrong = disagreement(trial.maps.front(), reference)};
}

/// Runs the trials of one method and appends their rows; writes tracks and maps.
void run_with(const ExperimentContext& context, const Entrant& entrant, std::vector<Mapped>& rows,
              std::vector<std::string>& files) {
  Scenario scenario = context.scenario;
  scenario.actor.controller = entrant.controller;
  ExperimentOptions options = context.options;
  options.out = in_folder(context, entrant.name);
  const ExperimentContext own{context.type, scenario, options, context.device, context.progress};
  const std::vector<Trial> trials = run_trials(own, {.maps = true, .supervisor = entrant.supervisor});
  if (!reports(context)) return;
  const world::World world = world_of(scenario);
  std::vector<viz::Track> tracks;
  const sensors::SensorSet sensor_set(world);
  VisibleArea reference(world, sensor_set);
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const Trial& trial = trials[k];
    const maps::OccupancyGrid& seeable = reference.of(trial.mapped.front(), trial.maps.front().geometry);
    rows.push_back(mapped_of(entrant, static_cast<std::uint32_t>(k + 1), trial, seeable));
    tracks.push_back(trial.tracks.front());
    tracks.back().name = fmt::format("trial {}", k + 1);
  }
  files.push_back(in_folder(context, entrant.name + "-trajectories.png"));
  viz::draw_trajectories(world, tracks, files.back(), "trial");
  files.push_back(in_folder(context, entrant.name + "-map.txt"));
  write_text(files.back(), maps::grid_text(trials.front().maps.front()));
  files.push_back(in_folder(context, entrant.name + "-map.png"));
  const viz::Track& track = trials.front().tracks.front();
  viz::draw_map(trials.front().maps.front(),
                {.title = "Map of trial 1: " + entrant.name, .places = {{track.name, track.poses.back()}}},
                files.back());
}

std::vector<Entrant> entrants_of(const Scenario& scenario) {
  const control::ControllerConfig& controller = scenario.actor.controller;
  return {{controller.name, controller, {}},
          {controller.name + "-supervised", controller, kSupervisor},
          {"explore", {"explore", 0.0, {}}, {}, true}};
}

std::vector<std::string> run_mapping(const ExperimentContext& context) {
  std::vector<Mapped> rows;
  std::vector<std::string> files{in_folder(context, "statistics.csv"), in_folder(context, "report.md")};
  for (const Entrant& entrant : entrants_of(context.scenario)) run_with(context, entrant, rows, files);
  if (!reports(context)) return {};
  write_text(files[0], csv_of(rows));
  write_text(files[1], report_of(context, rows));
  return files;
}

constexpr std::string_view kMappingReasons =
    "The thesis gives no numbers of its mapping; its maps are figures 44 and 45. Its avoidance as described considers "
    "only the front third of its view: a point 0.10 to 0.165 m off the axis leaves that third before the disc of the "
    "robot has passed, so it scrapes. Its control logic then waits for the bumper to be released, which was done by a "
    "supervisor in the laboratory; without one it waits forever, so results are given without and with a supervisor. "
    "It has no goal either: it maps the areas that it happens to pass, and never finishes. The plant, by default "
    "Player's driver of the Create, changes little: the avoidance drives straight or turns in place, which that driver "
    "changes little, and `explore` has no contacts and misses no cells with either.";

}  // namespace

extern const ExperimentType mapping_experiment;

constinit const ExperimentType mapping_experiment{
    .name = "mapping",
    .summary = "mapping an area by laser, with the thesis' obstacle avoidance and with an explorer (figures 44, 45)",
    .plant = Plant::thesis,
    .reasons = kMappingReasons,
    .run = run_mapping,
};

}  // namespace sf::scenarios
