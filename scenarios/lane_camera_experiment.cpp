// Lane keeping by a camera's images alone, against the lane edge sensor on the same lane: lenses, blur, noise, rates.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenarios/experiment.h"
#include "scenarios/lane_camera_runs.h"
#include "scenarios/lane_picture.h"
#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

/// Results of all trials of one variant.
struct LaneResult {
  std::size_t trials = 0, arrived = 0, left_lane = 0, steps = 0, measured = 0;
  double abs_offset = 0.0, max_offset = 0.0, square_heading = 0.0;  ///< sums over steps, and largest value
  double square_error = 0.0, max_error = 0.0;                       ///< over steps with an error
  double seconds = 0.0;
};

void add_run(const LaneRun& run, LaneResult& result) {
  ++result.trials, result.arrived += run.arrived, result.left_lane += run.left_lane;
  result.steps += run.offsets.size(), result.seconds += run.seconds;
  for (std::size_t i = 0; i < run.offsets.size(); ++i) {
    result.abs_offset += std::abs(run.offsets[i]);
    result.max_offset = std::max(result.max_offset, std::abs(run.offsets[i]));
    result.square_heading += run.headings[i] * run.headings[i];
    if (!std::isfinite(run.errors[i])) continue;
    ++result.measured;
    result.square_error += run.errors[i] * run.errors[i];
    result.max_error = std::max(result.max_error, std::abs(run.errors[i]));
  }
}

/// Returns the columns of both tables, in SI units.
std::array<double, 6> lane_numbers(const LaneResult& r) {
  const auto n = static_cast<double>(r.steps), measured = static_cast<double>(r.measured);
  return {r.abs_offset / n, r.max_offset,      std::sqrt(r.square_heading / n), std::sqrt(r.square_error / measured),
          r.max_error,      1.0 - measured / n};
}

std::string lane_camera_csv(const std::vector<LaneResult>& results) {
  std::string text =
      "variant,trials,arrived,left_lane,offset_abs_mean_m,offset_abs_max_m,heading_rms_rad,error_rms_m,error_abs_max_m,"
      "without_lane,seconds\n";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const LaneResult& r = results[i];
    const auto v = lane_numbers(r);
    text += fmt::format("\"{}\",{},{},{},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.4f},{:.1f}\n", lane_variants()[i].name,
                        r.trials, r.arrived, r.left_lane, v[0], v[1], v[2], v[3], v[4], v[5], r.seconds);
  }
  return text;
}

std::string lane_camera_report(const ExperimentContext& context, const std::vector<LaneResult>& results) {
  std::string text = fmt::format(
      "# A lane kept by a camera\n\n{}\n\nTrue distance of the robot's origin from the middle of its lane and heading "
      "relative to it; error of the measured offset ahead of the robot, by which it steers.\n\n"
      "| | mean distance [mm] | largest [mm] | heading, RMS [deg] | error, RMS [mm] | largest [mm] | without a lane "
      "| arrived |\n|---|---|---|---|---|---|---|---|\n",
      setup_of(context, {}));
  for (std::size_t i = 0; i < results.size(); ++i) {
    const auto v = lane_numbers(results[i]);
    text += fmt::format("| {} | {:.1f} | {:.1f} | {:.2f} | {:.1f} | {:.1f} | {:.1f} % | {} of {} |\n",
                        lane_variants()[i].name, 1e3 * v[0], 1e3 * v[1], v[2] * 180.0 / M_PI, 1e3 * v[3], 1e3 * v[4],
                        100.0 * v[5], results[i].arrived, results[i].trials);
  }
  return text + "\n" + std::string(context.type.reasons) + "\n";
}

viz::Series along_lane(const LaneRun& run, const std::vector<double>& values, std::string_view name) {
  viz::Series series{std::string(name), run.s, {}};
  for (const double value : values) series.values.push_back(1e3 * value);
  return series;
}

std::vector<std::string> run_lane_camera(const ExperimentContext& context) {
  if (!reports(context)) return {};
  std::vector<LaneResult> results(lane_variants().size());
  viz::SeriesOptions figure{.title = "A lane kept by a camera",
                            .subtitle = fmt::format("seed {}", context.options.seed),
                            .panels = {{.y_name = "distance from the middle [mm]"}, {.y_name = "measured error [mm]"}},
                            .x_name = "along the lane [m]"};
  const double runs = static_cast<double>(results.size()) * context.options.trials;
  for (std::size_t i = 0; i < results.size(); ++i)
    for (std::uint32_t k = 0; k < context.options.trials; ++k) {
      const LaneVariant& variant = lane_variants()[i];
      if (context.progress)
        context.progress((static_cast<double>(i) * context.options.trials + k) / runs, std::string(variant.name));
      Scenario scenario = context.scenario;
      scenario.seed = context.options.seed + k;
      const LaneRun run = run_lane(scenario, variant, context.device, context.options.threads, context.options.stop);
      add_run(run, results[i]);
      if (k > 0 || !variant.drawn) continue;
      figure.panels[0].series.push_back(along_lane(run, run.offsets, variant.name));
      figure.panels[1].series.push_back(along_lane(run, run.errors, variant.name));
    }
  const std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "report.md"),
                                       in_folder(context, "errors.png"), in_folder(context, "view.png")};
  write_text(files[0], lane_camera_csv(results));
  write_text(files[1], lane_camera_report(context, results));
  viz::draw_series(figure, files[2]);
  draw_lane_view(context.scenario, lane_variants()[1], context.device, files[3]);
  return files;
}

constexpr std::string_view kLaneCameraReasons =
    "All rows at one speed have the same law and gain, so they differ by their sensors. The lane edge sensor fits a "
    "straight line to the bend. The camera's errors are largest where the lane's curvature changes: its arc is then a "
    "mean of both pieces. Wide lenses, distorted or not, show more of the lane near the car and are better. Between "
    "images the lane moves with the commands, so one image per second is enough. With 30 % of noise the image is full "
    "of lines, and the car takes a wrong lane. At 0.5 m/s the gain is at its limit, and the distance from the middle "
    "is that of the law. In crossings, 1.2 m without paint, the car drives by its commands until it sees the next "
    "lane.";

}  // namespace

extern const ExperimentType lane_camera_experiment;

constinit const ExperimentType lane_camera_experiment{
    .name = "lane-camera",
    .summary = "lane keeping by a camera's images alone, by lens, blur, noise and rate, and by the lane edge sensor",
    .reasons = kLaneCameraReasons,
    .run = run_lane_camera,
};

}  // namespace sf::scenarios
