// A learnt model as a virtual lane sensor: the distance to the lane's edge from a magnetometer over magnets in the
// lane.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include "base/thread_pool.h"
#include "record/recording.h"
#include "scenarios/experiment.h"
#include "scenarios/identification.h"
#include "scenarios/statistics.h"
#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

// Models and their limits are fixed on the first seeds, and reported on the others.
constexpr std::uint32_t kTrainingSeeds = 50, kTestSeeds = 100;
constexpr double kModelRate = 10.0;
constexpr const char* kMiddleElement = "magnetometer.2.field_T";
constexpr double kLeastField = 5e-5;  // [T] in training: where magnets are in the lane
constexpr double kWidestLane = 0.45;  // [m] farther edges are those of other lanes, at crossings
constexpr std::uint32_t kLags[] = {1, 2}, kHidden[] = {4, 8};
constexpr ModelKind kKinds[] = {ModelKind::arx, ModelKind::network};

/// Errors [m] of the model in one run of the south loop, at the steps with a measured edge.
struct LaneSensorRow {
  std::uint64_t seed = 0;
  std::size_t steps = 0;        ///< with a measured edge
  std::vector<double> errors;   ///< of valid readings
  std::vector<double> outside;  ///< of readings outside the training range, as if they were valid
};

/// One run, as a recording in memory.
record::Recording recorded_run(const ExperimentContext& context, std::uint64_t seed) {
  Scenario scenario = context.scenario;
  scenario.seed = seed;
  TrialOptions options = trial_options(context);
  options.ranks = nullptr;  // the first rank computes everything
  options.record = in_folder(context, "run-in-progress");
  const world::World world = disturbed_world(scenario, options.disturbance);
  run_trial(scenario, world, context.device, options);
  record::Recording recording = record::open_recording(options.record);
  std::error_code ignored;
  std::filesystem::remove_all(options.record, ignored);
  return recording;
}

IdentificationSignals lane_signals(const std::string& robot, bool training) {
  return {.robot = robot,
          .inputs = {"magnetometer"},
          .output = "laneedge",
          .rate = kModelRate,
          .least = 0.0,
          .most = kWidestLane,
          .where = training ? std::vector<InputBounds>{{kMiddleElement, kLeastField, HUGE_VAL}}
                            : std::vector<InputBounds>()};
}

/// Compares the model with the measured edge, step by step, as the derived sensor computes it.
LaneSensorRow compare(const estimation::Regression& model, const estimation::SampledSignals& signals,
                      std::uint64_t seed, std::vector<viz::Panel>* panels) {
  LaneSensorRow row{.seed = seed};
  estimation::ModelRun run(model, true);
  viz::Series measured{"lane edge sensor", {}, {}}, learnt{"model", {}, {}}, valid{"valid", {}, {}};
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const double edge = signals.output_at(k);
    const auto [value, in_range] = run.step(signals.inputs_at(k), edge).value_or(estimation::ModelPrediction{NAN});
    for (viz::Series* each : {&measured, &learnt, &valid}) each->times.push_back(static_cast<double>(k) / kModelRate);
    measured.values.push_back(std::isfinite(edge) ? edge : NAN);
    learnt.values.push_back(in_range ? value : NAN);
    valid.values.push_back(in_range ? 1.0 : 0.0);
    if (!std::isfinite(edge)) continue;
    ++row.steps;
    if (std::isfinite(value)) (in_range ? row.errors : row.outside).push_back(value - edge);
  }
  if (panels != nullptr)
    *panels = {{.y_name = "distance of the edge [m]", .series = {measured, learnt}},
               {.y_name = "valid", .series = {valid}, .from_zero = true, .whole = true}};
  return row;
}

double rms(std::span<const double> errors) {
  double squares = 0.0;
  for (const double error : errors) squares += error * error;
  return errors.empty() ? NAN : std::sqrt(squares / static_cast<double>(errors.size()));
}

std::size_t within(std::span<const double> errors, double most) {
  return static_cast<std::size_t>(std::ranges::count_if(errors, [&](double e) { return std::abs(e) <= most; }));
}

std::string lane_csv(const std::vector<LaneSensorRow>& rows, double sigma) {
  std::string text = "seed,steps,valid,rms_m,within_two_sigma,outside,rms_outside_m\n";
  for (const LaneSensorRow& r : rows)
    text += fmt::format("{},{},{},{:.6g},{},{},{:.6g}\n", r.seed, r.steps, r.errors.size(), rms(r.errors),
                        within(r.errors, 2.0 * sigma), r.outside.size(), rms(r.outside));
  return text;
}

std::string candidates_text(const estimation::Selection& selection) {
  std::string text = "| model | RMS of one step [mm] | of free runs [mm] | |\n|---|---|---|---|\n";
  for (std::size_t i = 0; i < selection.candidates.size(); ++i) {
    const estimation::Candidate& each = selection.candidates[i];
    text += fmt::format("| {} | {:.2f} | {:.2f} | {} |\n", structure_name(each.structure), 1e3 * each.error.one_step,
                        1e3 * each.error.free_run, i == selection.chosen ? "chosen" : "");
  }
  return text;
}

std::string lane_report(const ExperimentContext& context, const IdentificationData& data,
                        const estimation::Selection& selection, const std::vector<LaneSensorRow>& rows) {
  LaneSensorRow all;
  for (const LaneSensorRow& r : rows) {
    all.steps += r.steps;
    all.errors.insert(all.errors.end(), r.errors.begin(), r.errors.end());
    all.outside.insert(all.outside.end(), r.outside.begin(), r.outside.end());
  }
  const double sigma = selection.model.error.free_run, error = rms(all.errors);
  const auto share = [](std::size_t part, std::size_t whole) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  };
  return fmt::format(
      "# A magnetometer as a lane sensor\n\nThe distance to the lane's edge, learnt from a magnetometer over magnets: "
      "{} runs of the north loop, seeds {} to {}, {} steps at {:g} Hz. Cross-validation in five parts:\n\n{}\n"
      "On the south loop, {} runs with other seeds ({} to {}), {} steps with a measured edge:\n\n"
      "| | |\n|---|---|\n| stated standard deviation | {:.2f} mm |\n| RMS error of valid readings | {:.2f} mm |\n"
      "| mean error | {:.2f} mm |\n| mean squared error over the stated variance | {:.2f} |\n"
      "| within two standard deviations | {:.1f} % |\n| not valid: outside the training range | {:.1f} % of steps |\n"
      "| RMS error there, had they been valid | {:.1f} mm |\n\n{}\n",
      kTrainingSeeds, context.options.seed, context.options.seed + kTrainingSeeds - 1, data.signals.size(), kModelRate,
      candidates_text(selection), rows.size(), rows.front().seed, rows.back().seed, all.steps, 1e3 * sigma, 1e3 * error,
      1e3 * statistics_of(all.errors).mean, error * error / (sigma * sigma),
      share(within(all.errors, 2.0 * sigma), all.errors.size()), share(all.steps - all.errors.size(), all.steps),
      1e3 * rms(all.outside), context.type.reasons);
}

std::vector<std::string> run_lane_sensor(const ExperimentContext& context) {
  if (!reports(context)) return {};
  const auto progress = [&](std::uint32_t run, const char* what) {
    if (context.progress) context.progress(run / static_cast<double>(kTrainingSeeds + kTestSeeds + 5), what);
  };
  IdentificationData data;
  for (std::uint32_t k = 0; k < kTrainingSeeds; ++k) {
    progress(k, "training");
    add_recording(recorded_run(context, context.options.seed + k), lane_signals("roomba0", true), data);
  }
  progress(kTrainingSeeds, "identification");
  base::ThreadPool thread_pool(context.options.threads);
  estimation::SelectionOptions options{.fit = {.seed = context.options.seed}};
  if (context.options.stop) options.progress = [&](double) { return !context.options.stop(); };
  const estimation::Selection selection = estimation::select_structure(
      structures_of(kKinds, data.signals.inputs, kLags, kHidden), data.signals, options, thread_pool);
  if (context.options.stop && context.options.stop()) throw Interrupted();
  std::vector<LaneSensorRow> rows;
  std::vector<viz::Panel> panels;
  for (std::uint32_t k = 0; k < kTestSeeds; ++k) {
    progress(kTrainingSeeds + 5 + k, "test");
    const std::uint64_t seed = context.options.seed + kTrainingSeeds + k;
    IdentificationData run;
    add_recording(recorded_run(context, seed), lane_signals("roomba2", false), run);
    rows.push_back(compare(selection.model, run.signals, seed, k == 0 ? &panels : nullptr));
  }
  std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "report.md"),
                                 in_folder(context, "edge.toml"), in_folder(context, "edge.png")};
  data.model.regression = selection.model;
  write_text(files[0], lane_csv(rows, selection.model.error.free_run));
  write_text(files[1], lane_report(context, data, selection, rows));
  write_text(files[2], sensors::text_of(data.model));
  viz::draw_series({.title = "A magnetometer as a lane sensor",
                    .subtitle = fmt::format("south loop, seed {}; learnt on the north loop", rows.front().seed),
                    .panels = panels},
                   files[3]);
  return files;
}

constexpr std::string_view kLaneSensorReasons =
    "The lane edge sensor is the reference. Readings are not valid where there are no magnets (the bridge, East "
    "Street, crossings), which the training range recognizes.";

}  // namespace

extern const ExperimentType lane_sensor_experiment;

constinit const ExperimentType lane_sensor_experiment{
    .name = "lane-sensor",
    .summary = "a magnetometer as a lane sensor, learnt on one loop and used on another",
    .fixed_trials = true,
    .reasons = kLaneSensorReasons,
    .run = run_lane_sensor,
};

}  // namespace sf::scenarios
