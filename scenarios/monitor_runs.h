#pragma once
// Runs of SimVille's cars with faulty sensors, for the experiment `monitor`.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robots/estimation/localization_monitor.h"
#include "scenarios/experiment.h"

namespace sf::scenarios {

inline constexpr double kSettled = 10.0;  // [s]
// [s] The faults begin when the filters know the sensors' constants, and end early enough for hand-back.
inline constexpr double kFaultFrom = 60.0, kFaultUntil = 90.0, kMonitorEnd = 120.0;

struct RunningMean {
  double sum = 0.0;
  std::size_t count = 0;
  void add(double value) { sum += value, ++count; }
  void add(const RunningMean& other) { sum += other.sum, count += other.count; }
  double mean() const { return sum / static_cast<double>(count); }  ///< NaN if empty
};

/// A fault of one sensor, possibly of two of its columns.
struct MonitorCase {
  estimation::MonitoredInput input;
  base::FaultKind kind;
  double amount = 0.0;         ///< farm::Fault::amount
  double probability = 1.0;    ///< of spikes
  std::string_view also = "";  ///< a second column with the same fault
  std::string_view size;       ///< for the table
};
std::span<const MonitorCase> monitor_cases();
std::string_view input_name(estimation::MonitoredInput input);

/// One car of one run. Statistics are those of the whole run without a fault, else of the time before it.
struct MonitoredCar {
  std::uint64_t seed = 0;
  std::string name;
  std::optional<std::size_t> fault;   ///< row of `monitor_cases`; nullopt: none
  double detected = NAN;              ///< [s] after the fault began: an input is suspected or isolated
  double isolated = NAN;              ///< [s] an input is stated to be faulty (absent, if it is lost or late)
  bool correct = false;               ///< that was the right one, and no other was during the fault
  double handed_back = NAN;           ///< [s] after the fault ended
  double lane_squares = 0.0;          ///< [m^2] sum of squared distances from the middle of the nearest lane
  double error_squares = 0.0;         ///< [m^2] sum of squared errors of the estimate
  std::size_t driven = 0, steps = 0;  ///< terms of both sums: ticks of the fault
  double healthy = 0.0;               ///< [s] without a fault, before it
  int suspicions = 0, alarms = 0;     ///< false ones in that time: suspected or faulty; faulty
  std::array<double, 2 * estimation::kRelations + 1> largest{};  ///< statistics in that time, like the thresholds
  /// NEES per dimension of the monitor's pose: from kSettled on without a fault, and while the faulty input, and no
  /// other, is stated to be faulty.
  RunningMean healthy_nees, faulty_nees;
};

/// Runs the scenario with these faults, one per car in the order of rows. @param monitored false: without the monitor,
/// so without detection
std::vector<MonitoredCar> run_monitored(const ExperimentContext& context, std::uint64_t seed, bool monitored,
                                        std::span<const std::optional<std::size_t>> faults);
/// Number of cars of the scenario.
std::size_t monitored_cars(const ExperimentContext& context);

}  // namespace sf::scenarios
