// Faulty encoders, gyros and receivers of cars that drive by their own estimates: thresholds are checked on some seeds
// without faults, and detection is reported on others, with and without the monitor.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "robots/estimation/chi_square.h"
#include "scenarios/experiment.h"
#include "scenarios/monitor_runs.h"
#include "scenarios/statistics.h"

namespace sf::scenarios {

namespace {

// Thresholds were fixed on the first seeds, and are reported on the others.
constexpr std::uint32_t kThresholdSeeds = 50, kFaultSeeds = 100;
constexpr std::size_t kStatistics = 2 * estimation::kRelations + 1;
constexpr std::string_view kStatisticNames[kStatistics] = {"turn, fast",     "wheels, fast",   "course, fast",
                                                           "reckoned, fast", "turn, slow",     "wheels, slow",
                                                           "course, slow",   "reckoned, slow", "roughness"};

/// Cars of one seed, with and without the monitor.
struct MonitoredPair {
  MonitoredCar with, without;
};

/// False alarms over the time without faults.
struct FalseAlarms {
  double hours = 0.0;
  int suspicions = 0, alarms = 0;
  std::array<double, kStatistics> largest{};
  RunningMean healthy_nees, faulty_nees;

  void add(const MonitoredCar& car) {
    hours += car.healthy / 3600.0;
    suspicions += car.suspicions, alarms += car.alarms;
    healthy_nees.add(car.healthy_nees), faulty_nees.add(car.faulty_nees);
    for (std::size_t k = 0; k < kStatistics; ++k) largest[k] = std::max(largest[k], car.largest[k]);
  }
};

/// "3 (0.6 to 8.8) per hour": the exact 95 % interval of a Poisson rate.
std::string rate_text(int count, double hours) {
  const double low = count == 0 ? 0.0 : 0.5 * estimation::chi_square_limit(2 * count, 0.975);
  const double high = 0.5 * estimation::chi_square_limit(2 * count + 2, 0.025);
  return fmt::format("{} in {:.1f} h: {:.2f} ({:.2f} to {:.2f}) per hour", count, hours, count / hours, low / hours,
                     high / hours);
}

double rms_of(double squares, std::size_t count) {
  return count == 0 ? NAN : std::sqrt(squares / static_cast<double>(count));
}

std::string monitor_csv(const std::vector<MonitoredPair>& pairs) {
  std::string text =
      "seed,robot,sensor,fault,size,detected_s,isolated_s,correct,handed_back_s,lane_rms_m,lane_rms_without_m,"
      "position_rms_m,position_rms_without_m\n";
  for (const auto& [with, without] : pairs) {
    if (!with.fault) continue;
    const MonitorCase& fault = monitor_cases()[*with.fault];
    text += fmt::format("{},{},{},{},\"{}\",{:.4g},{:.4g},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}\n", with.seed,
                        with.name, input_name(fault.input), base::kFaultNames[static_cast<std::size_t>(fault.kind)],
                        fault.size, with.detected, with.isolated, with.correct ? 1 : 0, with.handed_back,
                        rms_of(with.lane_squares, with.driven), rms_of(without.lane_squares, without.driven),
                        rms_of(with.error_squares, with.steps), rms_of(without.error_squares, without.steps));
  }
  return text;
}

/// A row of the table: all cars with one fault.
std::string fault_row(std::size_t row, const std::vector<MonitoredPair>& pairs) {
  const MonitorCase& fault = monitor_cases()[row];
  std::vector<double> delays;
  std::size_t cars = 0, isolated = 0, correct = 0;
  std::array<double, 4> squares{};
  std::array<std::size_t, 4> terms{};
  for (const auto& [with, without] : pairs) {
    if (with.fault != row) continue;
    ++cars;
    if (std::isfinite(with.detected)) delays.push_back(with.detected);
    isolated += std::isfinite(with.isolated);
    correct += with.correct;
    const MonitoredCar* const both[] = {&without, &with};
    for (const std::size_t k : {0, 1}) {
      squares[k] += both[k]->lane_squares, terms[k] += both[k]->driven;
      squares[2 + k] += both[k]->error_squares, terms[2 + k] += both[k]->steps;
    }
  }
  const auto rms = [&](std::size_t k) { return rms_of(squares[k], terms[k]); };
  return fmt::format("| {} | {} | {} | {} | {} | {:.1f} | {:.1f} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n",
                     input_name(fault.input), base::kFaultNames[static_cast<std::size_t>(fault.kind)], fault.size, cars,
                     delays.size(), percentile(delays, 0.5), percentile(delays, 0.95), isolated, correct, rms(0),
                     rms(1), rms(2), rms(3));
}

std::string threshold_rows(const FalseAlarms& fixed, const FalseAlarms& reported) {
  const estimation::MonitorThresholds limits = estimation::default_thresholds();
  std::string text = "| statistic | threshold | largest, first seeds | largest, other seeds |\n|---|---|---|---|\n";
  for (std::size_t k = 0; k < kStatistics; ++k) {
    const double limit = k < estimation::kRelations       ? limits.fast[k]
                         : k < 2 * estimation::kRelations ? limits.slow[k - estimation::kRelations]
                                                          : limits.roughness;
    text += fmt::format("| {} | {:g} | {:.1f} | {:.1f} |\n", kStatisticNames[k], limit, fixed.largest[k],
                        reported.largest[k]);
  }
  return text;
}

std::string monitor_report(const ExperimentContext& context, const FalseAlarms& fixed, const FalseAlarms& reported,
                           const std::vector<MonitoredPair>& pairs) {
  const std::uint64_t first = context.options.seed;
  std::string text = fmt::format(
      "# Faulty sensors of cars\n\nSeeds {} to {}, on which the thresholds were fixed, have no faults; seeds {} to {} "
      "have one healthy car each, and the other cars one fault each, from {:g} to {:g} s of {:g} s.\n\n{}\n"
      "False alarms, a sensor stated to be faulty: {} on the first seeds; {} on the others.\n\n"
      "Suspicions that isolated nothing: {}; {}.\n\n"
      "NEES of the pose per dimension, on the other seeds: {:.2f} without a fault ({} ticks), {:.2f} while the faulty "
      "input alone is stated to be faulty ({} ticks).\n\n",
      first, first + kThresholdSeeds - 1, first + kThresholdSeeds, first + kThresholdSeeds + kFaultSeeds - 1,
      kFaultFrom, kFaultUntil, kMonitorEnd, threshold_rows(fixed, reported), rate_text(fixed.alarms, fixed.hours),
      rate_text(reported.alarms, reported.hours), rate_text(fixed.suspicions, fixed.hours),
      rate_text(reported.suspicions, reported.hours), reported.healthy_nees.mean(), reported.healthy_nees.count,
      reported.faulty_nees.mean(), reported.faulty_nees.count);
  text +=
      "| sensor | fault | size | cars | detected | median delay [s] | 95 % [s] | isolated | correctly | lane RMS "
      "without [m] | with | position RMS without [m] | with |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t row = 0; row < monitor_cases().size(); ++row) text += fault_row(row, pairs);
  return text + "\n" + std::string(context.type.reasons) + "\n";
}

std::vector<std::string> run_monitor(const ExperimentContext& context) {
  if (!reports(context)) return {};
  const std::size_t cars = monitored_cars(context);
  const auto progress = [&](std::uint32_t k, const char* what) {
    if (context.progress) context.progress(k / static_cast<double>(kThresholdSeeds + 2 * kFaultSeeds), what);
  };
  FalseAlarms fixed, reported;
  std::vector<std::optional<std::size_t>> faults(cars);
  for (std::uint32_t k = 0; k < kThresholdSeeds; ++k) {
    progress(k, "without faults");
    for (const MonitoredCar& car : run_monitored(context, context.options.seed + k, true, faults)) fixed.add(car);
  }
  std::vector<MonitoredPair> pairs;
  std::size_t next = 0;
  for (std::uint32_t k = 0; k < kFaultSeeds; ++k) {
    progress(kThresholdSeeds + 2 * k, "faults");
    // Kinds and cars in turn.
    for (std::size_t c = 0; c < cars; ++c)
      faults[c] = c == k % cars ? std::nullopt : std::optional(next++ % monitor_cases().size());
    const std::uint64_t seed = context.options.seed + kThresholdSeeds + k;
    const std::vector<MonitoredCar> with = run_monitored(context, seed, true, faults);
    const std::vector<MonitoredCar> without = run_monitored(context, seed, false, faults);
    for (std::size_t c = 0; c < cars; ++c) {
      reported.add(with[c]);
      pairs.push_back({with[c], without[c]});
    }
  }
  const std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "report.md")};
  write_text(files[0], monitor_csv(pairs));
  write_text(files[1], monitor_report(context, fixed, reported, pairs));
  return files;
}

constexpr std::string_view kMonitorReasons =
    "A slow drift of a receiver and a common scale of both wheels change the same residuals, and cannot be told apart. "
    "A fault below the noise of the residuals is not detected, and changes the estimate little.";

}  // namespace

extern const ExperimentType monitor_experiment;

constinit const ExperimentType monitor_experiment{
    .name = "monitor",
    .summary = "faulty encoders, gyros and receivers of cars: detection, and driving with and without",
    .fixed_trials = true,
    .reasons = kMonitorReasons,
    .run = run_monitor,
};

}  // namespace sf::scenarios
