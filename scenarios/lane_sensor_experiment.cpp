// A learnt model as a virtual lane sensor: the distance to the lane's edge from a magnetometer over magnets in the
// lane.

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

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

/// What the model is worth on one run of the south loop.
struct LaneSensorRow {
  std::uint64_t seed = 0;
  std::size_t steps = 0;       ///< with a measured edge
  std::size_t valid = 0;       ///< of these, with a valid reading of the model
  double squares = 0.0;        ///< [m^2] sum of squared errors of valid readings
  double refused = 0.0;        ///< [m^2] the same of readings outside the training range, as if they were valid
  std::size_t refusals = 0;    ///< number of these
  std::size_t in_two = 0;      ///< valid readings with an error of at most two standard deviations
  std::vector<double> errors;  ///< [m] of valid readings
};

/// One run, as a recording in memory.
record::Recording recorded_run(const ExperimentContext& context, std::uint64_t seed) {
  Scenario scenario = context.scenario;
  scenario.seed = seed;
  TrialOptions options = trial_options(context);
  options.record = in_folder(context, "run");
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
  estimation::History history(model.structure);
  history.fill_outputs(model.output.mean);
  std::vector<double> scratch;
  viz::Series measured{"lane edge sensor", {}, {}}, learnt{"model", {}, {}}, valid{"valid", {}, {}};
  for (std::size_t k = 0; k < signals.size(); ++k) {
    history.add_inputs(signals.inputs_at(k));
    const double edge = signals.output_at(k);
    estimation::ModelPrediction prediction{NAN, false};
    if (history.complete()) prediction = estimation::predict(model, history, scratch);
    if (history.complete()) history.add_output(prediction.value);
    if (!history.outputs_known()) history.fill_outputs(model.output.mean);
    for (viz::Series* each : {&measured, &learnt, &valid}) each->times.push_back(static_cast<double>(k) / kModelRate);
    measured.values.push_back(std::isfinite(edge) ? edge : NAN);
    learnt.values.push_back(prediction.in_range ? prediction.value : NAN);
    valid.values.push_back(prediction.in_range ? 1.0 : 0.0);
    if (!std::isfinite(edge)) continue;
    ++row.steps;
    const double error = prediction.value - edge;
    if (!prediction.in_range) {
      if (std::isfinite(error)) row.refused += error * error, ++row.refusals;
      continue;
    }
    ++row.valid;
    row.squares += error * error;
    row.errors.push_back(error);
    if (std::abs(error) <= 2.0 * model.error.free_run) ++row.in_two;
  }
  if (panels != nullptr)
    *panels = {{.y_name = "distance of the edge [m]", .series = {measured, learnt}},
               {.y_name = "valid", .series = {valid}, .from_zero = true, .whole = true}};
  return row;
}

double rms(double squares, std::size_t count) { return std::sqrt(squares / static_cast<double>(count)); }

std::string lane_csv(const std::vector<LaneSensorRow>& rows) {
  std::string text = "seed,steps,valid,rms_m,within_two_sigma,outside,rms_outside_m\n";
  for (const LaneSensorRow& r : rows)
    text += fmt::format("{},{},{},{:.6g},{},{},{:.6g}\n", r.seed, r.steps, r.valid, rms(r.squares, r.valid), r.in_two,
                        r.refusals, rms(r.refused, r.refusals));
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
    all.steps += r.steps, all.valid += r.valid, all.squares += r.squares, all.in_two += r.in_two;
    all.refused += r.refused, all.refusals += r.refusals;
    all.errors.insert(all.errors.end(), r.errors.begin(), r.errors.end());
  }
  const ErrorStatistics statistics = statistics_of(all.errors);
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
      candidates_text(selection), rows.size(), rows.front().seed, rows.back().seed, all.steps,
      1e3 * selection.model.error.free_run, 1e3 * rms(all.squares, all.valid), 1e3 * statistics.mean,
      all.squares / static_cast<double>(all.valid) / std::pow(selection.model.error.free_run, 2),
      share(all.in_two, all.valid), share(all.steps - all.valid, all.steps), 1e3 * rms(all.refused, all.refusals),
      context.type.reasons);
}

std::vector<std::string> run_lane_sensor(const ExperimentContext& context) {
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
  if (!reports(context)) return {};
  std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "report.md"),
                                 in_folder(context, "edge.toml"), in_folder(context, "edge.png")};
  data.model.regression = selection.model;
  write_text(files[0], lane_csv(rows));
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
    "Street, "
    "crossings), which the training range recognizes.";

}  // namespace

extern const ExperimentType lane_sensor_experiment;

constinit const ExperimentType lane_sensor_experiment{
    .name = "lane-sensor",
    .summary = "a magnetometer as a lane sensor, learnt on one loop and used on another",
    .reasons = kLaneSensorReasons,
    .run = run_lane_sensor,
};

}  // namespace sf::scenarios
