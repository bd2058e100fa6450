#include "scenarios/sideslip_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/random.h"
#include "robots/car_dynamics.h"

namespace sf::scenarios {

namespace {

using SideslipSignal = estimation::SideslipMeasurement::Kind;

// No farm takes part, so the streams of its sensors are free.
constexpr base::RandomStream kSignals = base::RandomStream::own_sensors;
// Draws of signals are numbered from 0; these are those of a whole trial.
constexpr std::uint32_t kCarDraw = 100, kTorqueDraw = 101;
constexpr double kSineRate = M_PI;  // [rad/s] of slalom and lane change: 0.5 Hz

double length_of(Manoeuvre manoeuvre) { return manoeuvre == Manoeuvre::slalom ? 8.5 : 5.0; }

/// Steering angle over its amplitude at a time.
double steering(Manoeuvre manoeuvre, double time) {
  const double t = time - kManoeuvreStart;
  if (t < 0.0) return 0.0;
  if (manoeuvre == Manoeuvre::step_steer) return 1.0;
  if (manoeuvre == Manoeuvre::lane_change && kSineRate * t >= 2.0 * M_PI) return 0.0;
  return base::sin(kSineRate * t);
}

SideslipMoment moment_of(const robots::CarModel& car, const robots::CarState& s, double time) {
  const robots::CarForces f = robots::car_forces(car, s);
  return {time,
          s[robots::kCarSteer],
          s[robots::kCarTorque],
          s[robots::kCarForward],
          s[robots::kCarLeft],
          s[robots::kCarTurn],
          0.5 * (robots::rim_speed(car, s, robots::kRearLeft) + robots::rim_speed(car, s, robots::kRearRight)),
          f.left,
          robots::sideslip(s),
          {f.across[robots::kFrontLeft] + f.across[robots::kFrontRight],
           f.across[robots::kRearLeft] + f.across[robots::kRearRight]}};
}

SideslipRun drive_with(const robots::CarModel& car, Manoeuvre manoeuvre, double level, double amplitude) {
  SideslipRun run;
  run.manoeuvre = manoeuvre, run.level = level, run.amplitude = amplitude;
  constexpr double kHold = 3000.0;  // [N m s/m] torque per error of the speed
  const int every = static_cast<int>(std::lround(1.0 / (kSignalRate * robots::kCarStep)));
  const int steps = static_cast<int>(std::lround(length_of(manoeuvre) / robots::kCarStep));
  robots::CarState state = robots::straight(car, kSideslipSpeed);
  for (int k = 0; k <= steps; ++k) {
    const double time = k * robots::kCarStep;
    if (k % every == 0) {
      const SideslipMoment& now = run.moments.emplace_back(moment_of(car, state, time));
      run.reached = std::max(run.reached, std::abs(now.acceleration) / robots::kGravity);
      run.peak = std::max(run.peak, std::abs(now.sideslip));
    }
    const double speed = state[robots::kCarForward];
    const double torque = kHold * (kSideslipSpeed - speed) + car.resistance(speed) * car.wheel_radius;
    state = robots::step(car, state, {amplitude * steering(manoeuvre, time), torque});
  }
  return run;
}

}  // namespace

SideslipRun drive_manoeuvre(const robots::CarModel& car, Manoeuvre manoeuvre, double level) {
  // Regula falsi (Illinois) on the amplitude; a circle that the tyres barely permit needs less than 0.3 rad.
  constexpr double kLargest = 0.3;
  double low = 0.0, high = 0.05, under = -level;
  SideslipRun run = drive_with(car, manoeuvre, level, high);
  while (run.reached < level && high < kLargest) {
    low = high, under = run.reached - level;
    high = std::min(1.4 * high, kLargest);
    run = drive_with(car, manoeuvre, level, high);
  }
  double over = run.reached - level;
  for (int round = 0; round < 20 && over >= 0.0 && std::abs(run.reached - level) > 0.005 * level; ++round) {
    const double middle = high - over * (high - low) / (over - under);
    run = drive_with(car, manoeuvre, level, middle);
    const double off = run.reached - level;
    if (off < 0.0)
      low = middle, under = off, over *= 0.5;
    else
      high = middle, over = off, under *= 0.5;
  }
  return run;
}

std::vector<SideslipSignals> signals_of(const SideslipRun& run, const SideslipErrors& errors, std::uint64_t seed) {
  const auto normal = [&](std::uint32_t signal, std::size_t k) {
    const base::RandomKey draw{seed, kSignals, signal, static_cast<std::uint32_t>(run.manoeuvre), k};
    return base::random_normal(draw, 0)[0];
  };
  const double torque_scale = 1.0 + errors.torque_scale * normal(kTorqueDraw, 0);
  std::vector<SideslipSignals> signals;
  for (std::size_t k = 0; k < run.moments.size(); ++k) {
    const SideslipMoment& now = run.moments[k];
    signals.push_back({now.time, now.steer + errors.steer * normal(0, k), now.torque * torque_scale,
                       now.rolled + errors.speed * normal(1, k), now.turn + errors.turn * normal(2, k),
                       now.acceleration + errors.acceleration * normal(3, k)});
  }
  return signals;
}

std::string signals_csv(const SideslipRun& run, std::span<const SideslipSignals> signals) {
  std::string text =
      "time_s,steer_rad,torque_n_m,speed_m_s,rate_rad_s,left_m_s2,true_sideslip_rad,true_front_n,true_rear_n\n";
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const SideslipSignals& s = signals[k];
    const SideslipMoment& truth = run.moments[k];
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", s.time, s.steer, s.torque, s.speed, s.turn, s.acceleration,
                        truth.sideslip, truth.force.front, truth.force.rear);
  }
  return text;
}

estimation::SideslipModel observer_of(const robots::CarModel& car, estimation::SideslipObserver observer,
                                      const SideslipErrors& errors, std::uint64_t seed) {
  const auto [mass, friction] = base::random_normal({seed, kSignals, kCarDraw}, 0);
  estimation::SideslipModel model{.car = car, .observer = observer};
  model.car.mass /= 1.0 + errors.mass_scale * mass;
  model.car.inertia /= 1.0 + errors.mass_scale * mass;
  model.car.friction.c1 /= 1.0 + errors.friction_scale * friction;
  model.car.friction.c3 /= 1.0 + errors.friction_scale * friction;
  return model;
}

std::vector<estimation::SideslipEstimate> observe(const estimation::SideslipModel& model, SideslipSensors sensors,
                                                  std::span<const SideslipSignals> signals) {
  const bool speed = sensors == SideslipSensors::speed || sensors == SideslipSensors::both;
  const bool turn = sensors == SideslipSensors::yaw_rate || sensors == SideslipSensors::both;
  estimation::SideslipState state = estimation::started(model, 0, signals[0].speed);
  std::vector<estimation::SideslipEstimate> estimates;
  for (const SideslipSignals& now : signals) {
    const auto take = [&](SideslipSignal signal, double value) {
      estimation::apply(model, {std::llround(1e9 * now.time), signal, 0, value}, state);
    };
    take(SideslipSignal::steer, now.steer);
    take(SideslipSignal::torque, now.torque);
    if (speed && !estimates.empty()) take(SideslipSignal::speed, now.speed);
    if (turn) take(SideslipSignal::turn, now.turn);
    estimates.push_back(estimation::estimate_of(model, state));
  }
  return estimates;
}

SideslipRow evaluate(const SideslipRun& run, const robots::CarModel& car, SideslipSensors sensors,
                     estimation::SideslipObserver observer, std::uint32_t trials, std::uint64_t seed) {
  SideslipRow row{run.manoeuvre, run.level, run.reached, sensors, observer, run.peak * 180.0 / M_PI};
  double samples = 0.0;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const SideslipErrors errors;
    const auto estimates =
        observe(observer_of(car, observer, errors, seed + trial), sensors, signals_of(run, errors, seed + trial));
    for (std::size_t k = 0; k < estimates.size(); ++k) {
      const SideslipMoment& truth = run.moments[k];
      if (truth.time < kManoeuvreStart) continue;
      const double slip = estimates[k].sideslip - truth.sideslip, error = slip * 180.0 / M_PI;
      const double front = estimates[k].force.front - truth.force.front;
      const double rear = estimates[k].force.rear - truth.force.rear;
      row.rms_deg += error * error;
      row.worst_deg = std::max(row.worst_deg, std::abs(error));
      row.front_rms_n += front * front, row.rear_rms_n += rear * rear;
      row.nees += slip * slip / estimates[k].covariance[0];
      samples += 1.0;
    }
  }
  for (double* sum : {&row.rms_deg, &row.front_rms_n, &row.rear_rms_n}) *sum = std::sqrt(*sum / samples);
  row.nees /= samples;
  return row;
}

ObservabilityRow observability_along(const SideslipRun& run, const robots::CarModel& car, SideslipSensors sensors,
                                     bool linear) {
  const estimation::MeasuredOutputs outputs{
      .turn = sensors == SideslipSensors::yaw_rate || sensors == SideslipSensors::both,
      .speed = sensors == SideslipSensors::speed || sensors == SideslipSensors::both};
  ObservabilityRow row{run.manoeuvre, run.level, sensors, linear, 3, 0};
  std::vector<double> effects;
  double observable = 0.0;
  for (const SideslipMoment& now : run.moments) {
    if (now.time < kManoeuvreStart) continue;
    const estimation::Observability each = estimation::observability(
        {car, linear}, {now.forward, now.left, now.turn}, {now.steer, now.torque / car.wheel_radius}, outputs);
    row.least_rank = std::min(row.least_rank, each.rank), row.most_rank = std::max(row.most_rank, each.rank);
    effects.push_back(each.left);
    observable += each.left >= estimation::kLeastEffect ? 1.0 : 0.0;
  }
  std::ranges::sort(effects);
  row.least = effects.front(), row.median = effects[effects.size() / 2];
  row.share = observable / static_cast<double>(effects.size());
  return row;
}

}  // namespace sf::scenarios
