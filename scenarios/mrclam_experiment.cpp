// Localization on public measurements of real robots: the UTIAS MRCLAM data sets.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "scenarios/experiment.h"
#include "scenarios/mrclam_runs.h"
#include "viz/localization_figure.h"
#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

constexpr std::size_t kEllipseEvery = 20;  // samples, about as many seconds

std::string_view method_of(const MrclamRow& row) { return row.smoother ? "smoother" : "filter"; }
std::string_view landmarks_of(const MrclamRow& row) {
  return kMrclamLandmarks[static_cast<std::size_t>(row.landmarks)];
}

std::string mrclam_csv(const std::vector<MrclamRow>& rows) {
  std::string text = "robot,landmarks,cooperative,method,rms_m,rms_deg,nees,samples\n";
  for (const MrclamRow& r : rows)
    text += fmt::format("{},{},{:d},{},{:.6g},{:.6g},{:.6g},{}\n", r.robot, landmarks_of(r), r.cooperative,
                        method_of(r), r.rms_m, r.rms_deg, r.nees, r.samples);
  return text;
}

/// Summarizes the rows of all robots with one setting.
std::string summary_line(std::span<const MrclamRow> rows) {
  double mean = 0.0, worst = 0.0, degrees = 0.0, least = HUGE_VAL, most = 0.0;
  std::string each;
  for (const MrclamRow& r : rows) {
    mean += r.rms_m / static_cast<double>(rows.size());
    degrees += r.rms_deg / static_cast<double>(rows.size());
    worst = std::max(worst, r.rms_m);
    least = std::min(least, r.nees);
    most = std::max(most, r.nees);
    each += fmt::format("{}{:.3f}", each.empty() ? "" : ", ", r.rms_m);
  }
  return fmt::format("| {} | {} | {} | {:.3f} | {:.3f} | {:.1f} | {:.2f} to {:.2f} | {} |\n", landmarks_of(rows[0]),
                     rows[0].cooperative ? "yes" : "no", method_of(rows[0]), mean, worst, degrees, least, most, each);
}

std::string mrclam_report(const ExperimentContext& context, const record::MrclamData& data,
                          const std::vector<MrclamRow>& rows) {
  std::string text = fmt::format(
      "# Localization on measurements of real robots (MRCLAM)\n\nData: `{}`, {}, {}. Each odometry time within the "
      "truth counts; the start pose is the true one. Errors are those of the position (mean square over time, then "
      "mean over robots); NEES is divided by 3, so 1 is consistent.\n\n| landmarks | cooperative | method | mean RMS "
      "[m] | worst robot [m] | mean RMS [deg] | NEES | RMS of each robot [m] |\n|---|---|---|---|---|---|---|---|\n",
      context.options.data, counted(data.robots.size(), "robot"), counted(data.landmarks.size(), "landmark"));
  const std::size_t robots = data.robots.size();
  for (std::size_t k = 0; k + robots <= rows.size(); k += robots) text += summary_line({&rows[k], robots});
  text +=
      "\n| robot | odometry | measurements | unknown barcodes | other subjects without data | samples |\n"
      "|---|---|---|---|---|---|\n";
  for (std::size_t k = 0; k < robots; ++k) {
    const record::MrclamRobot& r = data.robots[k];
    text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", r.subject, r.odometry.size(), r.sightings.size(),
                        r.unknown_barcodes, r.unknown_subjects, rows[k].samples);
  }
  return text + fmt::format("\n{}\n", context.type.reasons);
}

std::string draw_mrclam_track(const ExperimentContext& context, const record::MrclamData& data, const MrclamRow& row) {
  viz::LocalizationFigure figure{.title = fmt::format("Robot {}: {}", row.robot, method_of(row)),
                                 .subtitle = fmt::format("{} landmarks, {}; {:.3f} m RMS", landmarks_of(row),
                                                         row.cooperative ? "cooperative" : "alone", row.rms_m)};
  for (std::size_t k = 0; k < row.kept.size(); ++k) {
    const auto& [time, truth, estimate, nees] = row.kept[k];
    figure.truth.poses.push_back(truth);
    figure.estimate.poses.push_back(estimate.X_WM);
    const auto& P = estimate.covariance;
    if (k % kEllipseEvery == 0)
      figure.ellipses.push_back({{estimate.X_WM.x, estimate.X_WM.y}, {P[0], P[1], P[estimation::kComponents + 1]}});
  }
  for (const record::MrclamLandmark& each : data.landmarks) figure.landmarks.push_back(each.p);
  const std::string file = in_folder(context, fmt::format("track-{}-{}.png", row.robot, method_of(row)));
  viz::draw_localization(figure, file);
  return file;
}

/// A component's error between minus and plus three standard deviations.
viz::Panel band_of(const MrclamRow& row, std::string name, double unit, std::size_t component) {
  viz::Series error{"error", {}, {}}, above{"+3 sigma", {}, {}}, below{"-3 sigma", {}, {}};
  for (const auto& [time, truth, estimate, nees] : row.kept) {
    const double errors[]{estimate.X_WM.x - truth.x, estimate.X_WM.y - truth.y,
                          base::wrap_angle(estimate.X_WM.yaw - truth.yaw)};
    const double sigma = std::sqrt(estimate.covariance[component * (estimation::kComponents + 1)]);
    for (viz::Series* each : {&error, &above, &below}) each->times.push_back(time);
    error.values.push_back(unit * errors[component]);
    above.values.push_back(3.0 * unit * sigma);
    below.values.push_back(-3.0 * unit * sigma);
  }
  return {.y_name = std::move(name), .series = {std::move(error), std::move(above), std::move(below)}};
}

std::string draw_mrclam_errors(const ExperimentContext& context, const MrclamRow& row) {
  viz::SeriesOptions figure{.title = fmt::format("Robot {}: errors of the {}", row.robot, method_of(row)),
                            .subtitle = fmt::format("{} landmarks, {}; mean NEES {:.2f}", landmarks_of(row),
                                                    row.cooperative ? "cooperative" : "alone", row.nees)};
  figure.panels.push_back(band_of(row, "x [m]", 1.0, 0));
  figure.panels.push_back(band_of(row, "y [m]", 1.0, 1));
  figure.panels.push_back(band_of(row, "yaw [deg]", 180.0 / M_PI, 2));
  viz::Series nees{"NEES", {}, {}};
  for (const MrclamSample& each : row.kept) {
    nees.times.push_back(each.time);
    nees.values.push_back(each.nees);
  }
  figure.panels.push_back({.y_name = "NEES / 3 [-]", .series = {std::move(nees)}, .from_zero = true});
  const std::string file = in_folder(context, fmt::format("errors-{}-{}.png", row.robot, method_of(row)));
  viz::draw_series(figure, file);
  return file;
}

std::vector<std::string> run_mrclam_experiment(const ExperimentContext& context) {
  if (!reports(context)) return {};
  const record::MrclamData data = record::read_mrclam(context.options.data);
  const auto progress = [&](double part) {
    if (context.progress) context.progress(0.9 * part, "localization");
  };
  const std::vector<MrclamRow> rows = run_mrclam(data, {}, context.options.threads, context.options.stop, progress);
  std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "report.md")};
  write_text(files[0], mrclam_csv(rows));
  write_text(files[1], mrclam_report(context, data, rows));
  for (const MrclamRow& row : rows) {
    if (row.landmarks != MrclamLandmarks::all || row.cooperative || row.kept.empty()) continue;
    files.push_back(draw_mrclam_track(context, data, row));
    files.push_back(draw_mrclam_errors(context, row));
  }
  return files;
}

constexpr std::string_view kMrclamReasons =
    "The model's constants were estimated on data set 6 and are frozen: docs/derived.md says how, and what they are "
    "worth on data that they were not fitted to.";

}  // namespace

extern const ExperimentType mrclam_experiment;

constinit const ExperimentType mrclam_experiment{
    .name = "mrclam",
    .summary = "localization by landmarks on measurements of real robots (UTIAS MRCLAM)",
    .source = ExperimentSource::measurements,
    .reasons = kMrclamReasons,
    .run = run_mrclam_experiment,
};

}  // namespace sf::scenarios
