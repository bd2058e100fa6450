// Path following of the thesis: one robot on one lane, by the painted edge or by magnets, with P or PI control.

#include <fmt/format.h>

#include <filesystem>

#include "scenarios/experiment.h"
#include "scenarios/path_report.h"
#include "scenarios/thesis_tables.h"
#include "sensors/sensor_type.h"
#include "viz/field_figure.h"
#include "viz/path_figure.h"
#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

constexpr double kTopToArray =
    0.075;  // [m] height of the magnetometers above the tops of the magnets (thesis, figure 37)

std::string draw_paths(const ExperimentContext& context, const std::vector<Trial>& trials, const world::World& world) {
  std::vector<viz::Track> tracks;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    viz::Track track = trials[k].tracks.front();
    track.name = fmt::format("trial {}", k + 1);
    tracks.push_back(std::move(track));
  }
  const std::string file = in_folder(context, "trajectories.png");
  viz::draw_along_paths(
      world, tracks, "Trajectories: " + context.scenario.name,
      fmt::format("plant {}, {} from seed {}", plant_name(context.scenario.plant.value_or(Plant::ideal)),
                  counted(trials.size(), "trial"), context.options.seed),
      file);
  return file;
}

std::string draw_errors(const ExperimentContext& context, const std::vector<Trial>& trials, std::string_view unit) {
  viz::SeriesOptions figure{.title = "Control error: " + context.scenario.name};
  viz::Panel panel{.y_name = fmt::format("error [{}]", unit)};
  for (std::size_t k = 0; k < trials.size(); ++k)
    panel.series.push_back({fmt::format("trial {}", k + 1), trials[k].times, trials[k].counts.front().errors});
  figure.panels.push_back(std::move(panel));
  const std::string file = in_folder(context, "errors.png");
  viz::draw_series(figure, file);
  return file;
}

/// Draws figure 37: six magnets in a line. Returns an empty list if their world file is missing.
std::vector<std::string> draw_field_line(const ExperimentContext& context) {
  const std::filesystem::path worlds = std::filesystem::path(context.scenario.world).parent_path().parent_path();
  const std::string six = (worlds / "six_magnets.world").string();
  if (!std::filesystem::exists(six)) return {};
  const world::World world = world::load_world(six, {.sensors = sensors::world_file_words()});
  const viz::FieldView view = viz::field_view(world, {.height = kTopToArray});
  const viz::FieldSamples samples = viz::sample_field(world, context.device, view, {});
  const std::string file = in_folder(context, "field.png");
  viz::draw_field(world, view, samples, file);
  return {file};
}

/// [s] Returns the time from the first to the last control error of a trial.
double driven(const Trial& trial) { return trial.times.empty() ? 0.0 : trial.times.back() - trial.times.front(); }

std::string report_of(const ExperimentContext& context, const std::vector<Trial>& trials, const ThesisTable& table) {
  std::vector<ErrorStatistics> statistics;
  std::string ends;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    statistics.push_back(trials[k].errors.front());
    ends += fmt::format("| {} | {:.1f} | {} | {} | {} | {:.4f} |\n", k + 1, driven(trials[k]), statistics.back().count,
                        trials[k].counts.front().contacts, trials[k].done ? "yes" : "**no**",
                        trials[k].counts.front().travelled);
  }
  return fmt::format(
      "# {}\n"
      "\n"
      "{}\n"
      "\n"
      "Table {} of the thesis, all eight columns:\n"
      "\n"
      "{}\n"
      "| trial | time on the path [s] | errors | contacts | end reached | driven [m] |\n"
      "|---|---|---|---|---|---|\n"
      "{}\n"
      "## Why these results differ from the thesis'\n"
      "\n"
      "{}\n"
      "\n"
      "More in docs/experiments.md. `statistics.csv` has the numbers, `trial-<k>/` each run whole (`sensorfarm "
      "plot`).\n",
      context.scenario.name, setup_of(context, {}), table.number, table_of(statistics, table), ends,
      context.type.reasons);
}

std::vector<std::string> run_path(const ExperimentContext& context) {
  const ThesisTable& table = *thesis_table(context.scenario.name);
  const std::vector<Trial> trials = run_trials(context, {});
  if (!reports(context)) return {};
  const world::World world = world_of(context.scenario);
  std::vector<ErrorStatistics> statistics;
  for (const Trial& trial : trials) statistics.push_back(trial.errors.front());
  std::vector<std::string> files{in_folder(context, "statistics.csv"), in_folder(context, "report.md")};
  write_text(files[0], csv_of(statistics));
  write_text(files[1], report_of(context, trials, table));
  files.push_back(draw_paths(context, trials, world));
  files.push_back(draw_errors(context, trials, table.unit));
  if (table.unit == "Gauss")
    for (const std::string& file : draw_field_line(context)) files.push_back(file);
  return files;
}

constexpr std::string_view kEdgeReasons =
    "The plant: for any P loop the mean error is the bend's angle over gain and time, (pi/2) / (kp T), so a robot that "
    "executes commands unchanged has twice the thesis' mean; the thesis drove through Player's driver of the Create, "
    "which halves radii and so doubles the gain, and with it (plant `thesis`) means and deviations agree. The extremes "
    "do not: the thesis' robot was off to the left by twice as much, and once by 0.871 m, which is impossible in a "
    "lane of half a metre. Its lane widths are not printed; those used here are 0.50, 0.60 and 0.45 m, and where they "
    "change the error jumps by half the change. Its delays and noise are not printed either; those used here were "
    "chosen to match the magnets' tables, not these. The overshoot in the bend is the P law's own, not the line fit's: "
    "the experiment `sweeps` shows both.";
constexpr std::string_view kMagnetReasons =
    "The gains: the thesis prints kp = 0.01 and ki = 0.006 without a unit; those used here (0.09 and 0.0055 rad/s per "
    "Gauss, doubled by the driver) follow from its means, which for any P loop are (pi/2) / (kp T). The printed ratio "
    "of the two is impossible: whatever their unit, such a loop has a mean near 0 and is unstable with the delay that "
    "the thesis mentions. The delay of about one second was chosen to reproduce the oscillation in these tables. "
    "Differences remain in the extremes, up to half of the thesis' to the left: its pattern of magnets and the "
    "disturbances of its laboratory are known only from a figure, while this world has a plain row with 2 mGauss of "
    "noise.";

}  // namespace

extern const ExperimentType lane_edge_p_experiment, lane_edge_pi_experiment, magnet_p_experiment, magnet_pi_experiment;

constinit const ExperimentType lane_edge_p_experiment{
    .name = "lane-edge-p",
    .summary = "path following by the painted edge, P (thesis: table 1, figure 33)",
    .plant = Plant::thesis,
    .reasons = kEdgeReasons,
    .run = run_path,
};
constinit const ExperimentType lane_edge_pi_experiment{
    .name = "lane-edge-pi",
    .summary = "the same, PI (table 2, figure 34)",
    .plant = Plant::thesis,
    .reasons = kEdgeReasons,
    .run = run_path,
};
constinit const ExperimentType magnet_p_experiment{
    .name = "magnet-p",
    .summary = "path following by magnets in the road, P (table 3, figures 37 and 38)",
    .plant = Plant::thesis,
    .reasons = kMagnetReasons,
    .run = run_path,
};
constinit const ExperimentType magnet_pi_experiment{
    .name = "magnet-pi",
    .summary = "the same, PI (table 4, figure 39)",
    .plant = Plant::thesis,
    .reasons = kMagnetReasons,
    .run = run_path,
};

}  // namespace sf::scenarios
