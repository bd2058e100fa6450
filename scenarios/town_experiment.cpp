// Experiments on whole testbeds: all robots drive; counts contacts, checkpoints and stops.

#include <fmt/format.h>

#include "scenarios/experiment.h"
#include "viz/map_figure.h"
#include "viz/town_figure.h"
#include "viz/trajectory_figure.h"
#include "world/fields.h"

namespace sf::scenarios {

namespace {

std::string_view type_of(const Sighting& sighting) { return words_of(world::Fiducial::Type::marker)[sighting.type]; }

std::string csv_of(const std::vector<Trial>& trials) {
  std::string text = "trial,robot,driven_m,contacts,checkpoints,full_stops,reds_passed,mean_abs_error_m\n";
  for (std::size_t k = 0; k < trials.size(); ++k)
    for (std::size_t i = 0; i < trials[k].tracks.size(); ++i) {
      const RobotMetrics& counts = trials[k].counts[i];
      const bool has = trials[k].errors[i].count > 0;
      text += fmt::format("{},{},{:.6g},{},{},{},{},{}\n", k + 1, trials[k].tracks[i].name, counts.travelled,
                          counts.contacts, counts.goals.passed, counts.stops, counts.red_lights_passed,
                          has ? fmt::format("{:.6g}", trials[k].errors[i].abs_mean) : "");
    }
  return text;
}

std::string sightings_csv(const ExperimentContext& context, const std::vector<Trial>& trials) {
  const world::World world = world_of(context.scenario);
  std::string text = "trial,id,type,robot,time_s,x_m,y_m\n";
  for (std::size_t k = 0; k < trials.size(); ++k)
    for (const Sighting& s : trials[k].sightings)
      text += fmt::format("{},{},{},{},{:.6g},{:.6g},{:.6g}\n", k + 1, s.id, type_of(s), world.movers[s.mover].name,
                          s.time, s.p.x, s.p.y);
  return text;
}

std::string sightings_table(const ExperimentContext& context, const std::vector<Trial>& trials) {
  const world::World world = world_of(context.scenario);
  if (world.fiducials.empty()) return "";
  std::string text =
      "\n## Fiducials found\n\n| trial | found | id | type | robot | time [s] | place [m] |\n"
      "|---|---|---|---|---|---|---|\n";
  for (std::size_t k = 0; k < trials.size(); ++k)
    for (const Sighting& s : trials[k].sightings)
      text +=
          fmt::format("| {} | {} of {} | {} | {} | {} | {:.1f} | {:.2f}, {:.2f} |\n", k + 1, trials[k].sightings.size(),
                      world.fiducials.size(), s.id, type_of(s), world.movers[s.mover].name, s.time, s.p.x, s.p.y);
  return text;
}

std::string report_of(const ExperimentContext& context, const std::vector<Trial>& trials) {
  std::string text = fmt::format("# {}\n\n{}\n", context.scenario.name, setup_of(context, {}));
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const Trial& trial = trials[k];
    text += fmt::format(
        "\n## Trial {}: {:.0f} s simulated in {:.1f} s ({:.0f} x real time); controllers and motion {:.1f} s of it\n\n"
        "| robot | driven [m] | contacts | checkpoints | full stops | red lights passed |\n|---|---|---|---|---|---|\n",
        k + 1, trial.simulated, trial.wall, trial.simulated / std::max(trial.wall, 1e-9), trial.decided);
    for (std::size_t i = 0; i < trial.tracks.size(); ++i)
      text += fmt::format("| {} | {:.2f} | {} | {} | {} | {} |\n", trial.tracks[i].name, trial.counts[i].travelled,
                          trial.counts[i].contacts, trial.counts[i].goals.passed, trial.counts[i].stops,
                          trial.counts[i].red_lights_passed);
  }
  text += sightings_table(context, trials);
  return text + fmt::format("\n## Comparison with the thesis\n\n{}\n", context.type.reasons);
}

std::string draw_own_map(const ExperimentContext& context, const Trial& trial, std::size_t number) {
  viz::MapFigure figure{fmt::format("Merged map of trial {}", number), "", {}};
  for (const viz::Track& track : trial.tracks) figure.places.push_back({track.name, track.poses.back()});
  const std::string file = in_folder(context, fmt::format("map-{}.png", number));
  viz::draw_map(*trial.own_map, figure, file);
  return file;
}

std::vector<std::string> run_town(const ExperimentContext& context) {
  const std::vector<Trial> trials = run_trials(context, {});
  if (!reports(context)) return {};
  std::vector<std::string> files{in_folder(context, "statistics.csv"), in_folder(context, "report.md")};
  write_text(files[0], csv_of(trials));
  write_text(files[1], report_of(context, trials));
  const world::World world = world_of(context.scenario);
  if (!world.fiducials.empty())
    write_text(files.emplace_back(in_folder(context, "fiducials.csv")), sightings_csv(context, trials));
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (trials[k].own_map) files.push_back(draw_own_map(context, trials[k], k + 1));
    files.push_back(in_folder(context, fmt::format("trajectories-{}.png", k + 1)));
    if (world.road_files.empty())
      viz::draw_trajectories(world, trials[k].tracks, files.back());
    else
      viz::draw_town(world, trials[k].tracks, {trials[k].simulated, trials[k].rows, trials[k].follows}, files.back());
  }
  return files;
}

constexpr std::string_view kTownReasons =
    "The thesis names SimVille as the testbed and gives no numbers of traffic in it, so nothing here is compared. "
    "Contacts and red lights passed must be zero; metres and checkpoints measure the flow of traffic and depend on the "
    "order in which robots meet. The plant is `ideal` by default, since the thesis has no numbers here that its driver "
    "would explain. The mean error of a robot on a route is its distance from the middle of its lane; convoys and "
    "pedestrians have none.";
constexpr std::string_view kMagicReasons =
    "The thesis names MiniMAGIC as the testbed and gives no numbers, so nothing here is compared. Contacts must be "
    "zero: Pioneers explore as a team, check the area that their outline sweeps, and obstacles stop while a Pioneer is "
    "ahead of them. The plant is `ideal` by default, since Player's driver of the Create is not a Pioneer's. Trials "
    "differ by the robots' start poses and by noise.";

}  // namespace

extern const ExperimentType simville_experiment, simville_merge_experiment, minimagic_experiment;

constinit const ExperimentType simville_experiment{
    .name = "simville",
    .summary = "town traffic: fifty robots on routes, lights, stop signs, a convoy",
    .plant = Plant::ideal,
    .reasons = kTownReasons,
    .run = run_town,
};
constinit const ExperimentType simville_merge_experiment{
    .name = "simville-merge",
    .summary = "a robot merges into a convoy, another overtakes a slow one",
    .plant = Plant::ideal,
    .reasons = kTownReasons,
    .run = run_town,
};
constinit const ExperimentType minimagic_experiment{
    .name = "minimagic",
    .summary = "Pioneers explore among buildings and obstacles that move",
    .plant = Plant::ideal,
    .reasons = kMagicReasons,
    .run = run_town,
};

}  // namespace sf::scenarios
