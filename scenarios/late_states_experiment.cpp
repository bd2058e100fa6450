// Lane keeping with states that reach the farm late: true, newest, and filtered states.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "scenarios/experiment.h"
#include "scenarios/lane_errors.h"
#include "viz/path_figure.h"

namespace sf::scenarios {

namespace {

struct States {
  const char* name;
  bool late;
  bool filter;
  bool second;  ///< late by the link of `lane-edge-p` instead of the scenario's link
};
constexpr std::array kStates{States{"true", false, false, false}, States{"newest", true, false, false},
                             States{"filtered", true, true, false}, States{"newest, 1 s late", true, false, true},
                             States{"filtered, 1 s late", true, true, true}};
constexpr netio::LinkModel kSecond{.delay = 0.9, .jitter = 0.2, .loss = 0.01};

/// One row: means over the trials, and the worst trial.
struct Row {
  States states;
  double speed = 0.0;  ///< [m/s]
  double kp = 0.0;     ///< 0: the controller's default
  LaneErrors mean;     ///< `max_abs` and `left_lane`: the worst
  bool all_done = true;
  viz::Track track;  ///< of the first trial
};

Scenario scenario_of(const ExperimentContext& context, const Row& row, std::uint64_t seed) {
  Scenario scenario = context.scenario;
  scenario.seed = seed;
  std::vector<control::Setting> settings{{"speed", row.speed, ""}};
  if (row.kp > 0.0) settings.push_back({"kp", row.kp, ""});
  scenario.actor.controller.settings = {"controller 'lane-keeping'", std::move(settings)};
  if (!row.states.late) return scenario.states.reset(), scenario;
  scenario.states->filter = row.states.filter;
  if (row.states.second) scenario.states->link = kSecond;
  return scenario;
}

void measure(const ExperimentContext& context, Row& row) {
  for (std::uint32_t k = 0; k < context.options.trials; ++k) {
    const Scenario scenario = scenario_of(context, row, context.options.seed + k);
    const world::World world = disturbed_world(scenario, {});
    const Trial trial = run_trial(scenario, world, context.device, trial_options(context));
    const LaneErrors errors = lane_errors(trial.tracks.front(), world.paths.front());
    row.mean.mean_abs += errors.mean_abs / context.options.trials;
    row.mean.amplitude += errors.amplitude / context.options.trials;
    row.mean.max_abs = std::max(row.mean.max_abs, errors.max_abs);
    row.mean.left_lane = row.mean.left_lane || errors.left_lane;
    row.all_done = row.all_done && trial.done;
    if (k == 0) row.track = trial.tracks.front();
  }
  row.track.name = row.states.name;
}

std::vector<Row> all_rows() {
  std::vector<Row> rows;
  for (const double kp : {0.0, 0.5})
    for (const double speed : {0.1, 0.5})
      for (const States& states : kStates) rows.push_back({.states = states, .speed = speed, .kp = kp});
  return rows;
}

std::string gain_of(const Row& row) { return row.kp > 0.0 ? fmt::format("{:g}", row.kp) : "own"; }

std::string csv_of(const std::vector<Row>& rows) {
  std::string text = "kp,speed,states,abs_mean,amplitude,abs_max,left_lane,end_reached\n";
  for (const Row& r : rows)
    text += fmt::format("{},{:g},\"{}\",{:.6g},{:.6g},{:.6g},{:d},{:d}\n", gain_of(r), r.speed, r.states.name,
                        r.mean.mean_abs, r.mean.amplitude, r.mean.max_abs, r.mean.left_lane, r.all_done);
  return text;
}

std::string report_of(const ExperimentContext& context, const std::vector<Row>& rows) {
  const StateLinkOptions& states = *context.scenario.states;
  std::string text = fmt::format(
      "# Lane keeping with late states\n\n{}\n\nStates at {:g} Hz, {:g} to {:g} s late, {:g} % of them lost; `1 s "
      "late`: {:g} to {:g} s, {:g} %. Errors are true distances of the robot's origin from the lane's middle; the "
      "amplitude is that on the first straight. kp `own`: the controller's default.\n\n| kp | m/s | states | mean abs "
      "[mm] | amplitude [mm] | largest [mm] | left its lane | end reached |\n|---|---|---|---|---|---|---|---|\n",
      setup_of(context, {}), states.rate, states.link.delay, states.link.delay + states.link.jitter,
      100.0 * states.link.loss, kSecond.delay, kSecond.delay + kSecond.jitter, 100.0 * kSecond.loss);
  for (const Row& r : rows)
    text += fmt::format("| {} | {:g} | {} | {:.1f} | {:.1f} | {:.0f} | {} | {} |\n", gain_of(r), r.speed, r.states.name,
                        1e3 * r.mean.mean_abs, 1e3 * r.mean.amplitude, 1e3 * r.mean.max_abs,
                        r.mean.left_lane ? "**yes**" : "no", r.all_done ? "yes" : "**no**");
  return text + fmt::format("\n## What it shows\n\n{}\n", context.type.reasons);
}

std::string draw(const ExperimentContext& context, const std::vector<Row>& rows, double speed) {
  std::vector<viz::Track> tracks;
  for (const Row& row : rows)
    if (row.speed == speed && row.kp == 0.0) tracks.push_back(row.track);
  const std::string file = in_folder(context, fmt::format("trajectories-{:g}.png", speed));
  viz::draw_along_paths(
      world_of(context.scenario), tracks, fmt::format("Lane keeping at {:g} m/s with late states", speed),
      fmt::format("plant {}, seed {}", plant_name(*context.scenario.plant), context.options.seed), file);
  return file;
}

std::vector<std::string> run_late_states(const ExperimentContext& context) {
  if (!context.scenario.states || world_of(context.scenario).paths.empty())
    throw base::InputError(context.scenario.file, 0, "'late-states' requires [states] and a path( ... ) in its world");
  std::vector<Row> rows = all_rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (context.progress)
      context.progress(static_cast<double>(i) / static_cast<double>(rows.size()), rows[i].states.name);
    measure(context, rows[i]);
  }
  if (!reports(context)) return {};
  std::vector<std::string> files{in_folder(context, "late-states.csv"), in_folder(context, "report.md")};
  write_text(files[0], csv_of(rows));
  write_text(files[1], report_of(context, rows));
  for (const double speed : {0.1, 0.5}) files.push_back(draw(context, rows, speed));
  return files;
}

constexpr std::string_view kLateReasons =
    "A tenth of a second does not stop a robot at 0.5 m/s: with its own gain it keeps its lane equally well with the "
    "newest states and the true ones, since extrapolation from the arrival errs along the path, which hardly affects "
    "the distance to the edge. The filter removes part of the oscillation that late states add. With the thesis' gain "
    "the robot leaves the lane at 0.5 m/s with any states, even the true ones: a P law needs an error of v / (R k) in "
    "the bend. With states one second late the controller's own gain fails with and without the filter; figures of "
    "runs that left their lane are not comparable. With the thesis' gain and speed, the filter removes nine tenths of "
    "the error added by the delay of one second, and more than half of the amplitude.";

}  // namespace

extern const ExperimentType late_states_experiment;

constinit const ExperimentType late_states_experiment{
    .name = "late-states",
    .summary = "lane keeping at 0.1 and 0.5 m/s with true, late and filtered states",
    .plant = Plant::thesis,
    .reasons = kLateReasons,
    .run = run_late_states,
};

}  // namespace sf::scenarios
