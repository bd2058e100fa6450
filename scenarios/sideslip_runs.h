#pragma once
// Manoeuvres of a simulated car, its noisy signals, and observers of its sideslip.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robots/car_model.h"
#include "robots/estimation/sideslip.h"

namespace sf::scenarios {

/// Steering over time at 25 m/s, which the driver holds. Each begins after 0.5 s.
enum class Manoeuvre : std::uint8_t {
  step_steer,  ///< to a constant angle, for 4.5 s
  slalom,      ///< a sine of 0.5 Hz, for 8 s
  lane_change  ///< one period of it, then straight ahead for 2.5 s
};
inline constexpr std::string_view kManoeuvres[] = {"step-steer", "slalom", "lane-change"};

/// Measured outputs; steering angle and torque are inputs of all observers.
enum class SideslipSensors : std::uint8_t { none, yaw_rate, speed, both };
inline constexpr std::string_view kSideslipSensors[] = {"none", "yaw-rate", "speed", "both"};

inline constexpr double kSideslipSpeed = 25.0;  ///< [m/s]
inline constexpr double kSignalRate = 100.0;    ///< [Hz]
inline constexpr double kManoeuvreStart = 0.5;  ///< [s] errors count from then on

/// Standard deviations of noise, drawn for each sample, and of constant errors, drawn once per trial.
struct SideslipErrors {
  double steer = 1.75e-3;        ///< [rad]
  double turn = 3.5e-3;          ///< [rad/s]
  double speed = 0.05;           ///< [m/s] from wheels that are not driven
  double acceleration = 0.1;     ///< [m/s^2] across
  double torque_scale = 0.05;    ///< [-]
  double mass_scale = 0.03;      ///< [-] of the car over the observer's model, also of its inertia
  double friction_scale = 0.05;  ///< [-]
};

/// Truth of one moment.
struct SideslipMoment {
  double time = 0.0;          ///< [s]
  double steer = 0.0;         ///< [rad]
  double torque = 0.0;        ///< [N m]
  double forward = 0.0;       ///< [m/s]
  double left = 0.0;          ///< [m/s]
  double turn = 0.0;          ///< [rad/s]
  double rolled = 0.0;        ///< [m/s] mean circumferential speed of the rear wheels
  double acceleration = 0.0;  ///< [m/s^2] across
  double sideslip = 0.0;      ///< [rad]
  estimation::AxleForces force;
};

/// One manoeuvre at one level.
struct SideslipRun {
  Manoeuvre manoeuvre = Manoeuvre::step_steer;
  double level = 0.0;                   ///< [g] largest lateral acceleration asked for
  double reached = 0.0;                 ///< [g] and reached; lower where the tyres permit no more
  double amplitude = 0.0;               ///< [rad] of the steering command that gives it
  double peak = 0.0;                    ///< [rad] largest sideslip
  std::vector<SideslipMoment> moments;  ///< at kSignalRate
};

/// Drives the manoeuvre with the least steering amplitude that reaches `level` [g] > 0 within 0.5 %.
SideslipRun drive_manoeuvre(const robots::CarModel& car, Manoeuvre manoeuvre, double level);

/// What the car's sensors state of one moment.
struct SideslipSignals {
  double time = 0.0;          ///< [s]
  double steer = 0.0;         ///< [rad]
  double torque = 0.0;        ///< [N m]
  double speed = 0.0;         ///< [m/s] of the rear wheels, which are not driven
  double turn = 0.0;          ///< [rad/s]
  double acceleration = 0.0;  ///< [m/s^2] across
};
/// Returns the signals of a trial, in the order of `SideslipRun::moments`.
std::vector<SideslipSignals> signals_of(const SideslipRun& run, const SideslipErrors& errors, std::uint64_t seed);

/// Returns the signals as a table that `derive` reads, with the truth of each moment.
std::string signals_csv(const SideslipRun& run, std::span<const SideslipSignals> signals);

/// Returns the observer of a trial, which knows mass and friction only to `errors`.
estimation::SideslipModel observer_of(const robots::CarModel& car, estimation::SideslipObserver observer,
                                      const SideslipErrors& errors, std::uint64_t seed);

/// Returns the estimates of an observer that starts with the first speed of the signals, in the order of the signals.
std::vector<estimation::SideslipEstimate> observe(const estimation::SideslipModel& model, SideslipSensors sensors,
                                                  std::span<const SideslipSignals> signals);

/// One row of results.csv.
struct SideslipRow {
  Manoeuvre manoeuvre = Manoeuvre::step_steer;
  double level = 0.0, reached = 0.0;  ///< [g]
  SideslipSensors sensors = SideslipSensors::none;
  estimation::SideslipObserver observer = estimation::SideslipObserver::ekf;
  double peak_deg = 0.0;                       ///< largest sideslip
  double rms_deg = 0.0, worst_deg = 0.0;       ///< error of the sideslip, over all trials
  double front_rms_n = 0.0, rear_rms_n = 0.0;  ///< error of the lateral forces
  double nees = 0.0;  ///< mean squared error of the sideslip over its variance; NaN: none stated

  /// The criterion: errors of at most 1 degree in all trials and at most 20 % of the peak in the mean square.
  bool tracks() const { return worst_deg <= 1.0 && rms_deg <= 0.2 * peak_deg; }
};

SideslipRow evaluate(const SideslipRun& run, const robots::CarModel& car, SideslipSensors sensors,
                     estimation::SideslipObserver observer, std::uint32_t trials, std::uint64_t seed);

/// Local observability along one manoeuvre.
struct ObservabilityRow {
  Manoeuvre manoeuvre = Manoeuvre::step_steer;
  double level = 0.0;
  SideslipSensors sensors = SideslipSensors::none;
  bool linear = false;
  int least_rank = 0, most_rank = 0;
  double least = 0.0, median = 0.0;  ///< [-] effect of the sideways speed: Observability::left
  double share = 0.0;                ///< [-] of the time in which it is at least kLeastEffect
};
ObservabilityRow observability_along(const SideslipRun& run, const robots::CarModel& car, SideslipSensors sensors,
                                     bool linear);

}  // namespace sf::scenarios
