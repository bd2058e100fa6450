#include "scenarios/monitor_runs.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "base/files.h"
#include "base/time.h"
#include "control/lane_corridors.h"
#include "control/own_localization.h"
#include "scenarios/run_metrics.h"
#include "scenarios/simulation.h"

namespace sf::scenarios {

namespace {

using base::FaultKind;
using estimation::InputState;
using enum estimation::MonitoredInput;

constexpr estimation::MonitoredInput kMonitored[] = {encoder, gyro, gps};
constexpr double kFarthestLane = 1.0;  // [m] distance of a car off all lanes

constexpr MonitorCase kCases[] = {
    {encoder, FaultKind::bias, 0.3, 1.0, "", "0.3 m, left"},
    {encoder, FaultKind::drift, 0.05, 1.0, "", "0.05 m/s, left"},
    {encoder, FaultKind::drift, 0.05, 1.0, "right_m", "0.05 m/s, both"},
    {encoder, FaultKind::scale, 1.1, 1.0, "", "1.1, left"},
    {encoder, FaultKind::stuck, 0.0, 1.0, "", ""},
    {encoder, FaultKind::spikes, 0.2, 0.2, "", "0.2 m, 20 %, left"},
    {encoder, FaultKind::noise, 0.02, 1.0, "", "20 mm, left"},
    {encoder, FaultKind::quantization, 0.05, 1.0, "", "50 mm, left"},
    {encoder, FaultKind::swap, 0.0, 1.0, "", "left and right"},
    {encoder, FaultKind::dropout, 0.0, 1.0, "", "all"},
    {encoder, FaultKind::delay, 0.8, 1.0, "", "0.8 s"},
    {gyro, FaultKind::bias, 0.1, 1.0, "", "0.1 rad/s"},
    {gyro, FaultKind::drift, 0.01, 1.0, "", "0.01 rad/s²"},
    {gyro, FaultKind::scale, 1.5, 1.0, "", "1.5"},
    {gyro, FaultKind::stuck, 0.0, 1.0, "", ""},
    {gyro, FaultKind::spikes, 1.0, 0.2, "", "1 rad/s, 20 %"},
    {gyro, FaultKind::noise, 0.1, 1.0, "", "0.1 rad/s (60 times)"},
    {gyro, FaultKind::quantization, 0.2, 1.0, "", "0.2 rad/s"},
    {gyro, FaultKind::dropout, 0.0, 1.0, "", "all"},
    {gyro, FaultKind::delay, 0.8, 1.0, "", "0.8 s"},
    {gps, FaultKind::bias, 3.0, 1.0, "", "3 m, x"},
    {gps, FaultKind::drift, 0.2, 1.0, "", "0.2 m/s, x"},
    {gps, FaultKind::scale, 1.2, 1.0, "", "1.2, x"},
    {gps, FaultKind::stuck, 0.0, 1.0, "", ""},
    {gps, FaultKind::spikes, 5.0, 0.3, "", "5 m, 30 %, x"},
    {gps, FaultKind::noise, 2.0, 1.0, "", "2 m (9 times), x"},
    {gps, FaultKind::quantization, 2.0, 1.0, "", "2 m, x"},
    {gps, FaultKind::swap, 0.0, 1.0, "", "x and y"},
    {gps, FaultKind::dropout, 0.0, 1.0, "", "all"},
    {gps, FaultKind::delay, 0.8, 1.0, "", "0.8 s"},
};

bool loses_time(FaultKind kind) { return kind == FaultKind::dropout || kind == FaultKind::delay; }

/// Appends the fault of a robot.
void add_fault(const MonitorCase& fault, const std::string& robot, std::vector<farm::Fault>& to) {
  farm::Fault own{.kind = fault.kind,
                  .robot = robot,
                  .type = std::string(input_name(fault.input)),
                  .amount = fault.amount,
                  .from = kFaultFrom,
                  .until = kFaultUntil,
                  .probability = fault.probability};
  if (fault.kind == FaultKind::swap)
    own.swapped_columns =
        fault.input == encoder ? std::vector<std::string>{"left_m", "right_m"} : std::vector<std::string>{"x_m", "y_m"};
  to.push_back(own);
  if (fault.also.empty()) return;
  own.column = fault.also;
  to.push_back(own);
}

/// The states that a car's monitor stated so far.
struct MonitoredStates {
  std::array<InputState, estimation::kMonitoredInputs> last{};
  bool wrong = false;  ///< another input was stated to be faulty during the fault
};

/// Returns the squared error of x, y and yaw in units of its covariance, divided by 3.
double pose_nees(const estimation::Estimate& estimate, const base::Pose& truth) {
  const auto& P = estimate.covariance;
  const auto at = [&](int i, int k) { return P[i * estimation::kComponents + k]; };
  const glm::dmat3 covariance{
      {at(0, 0), at(0, 1), at(0, 2)}, {at(1, 0), at(1, 1), at(1, 2)}, {at(2, 0), at(2, 1), at(2, 2)}};
  const glm::dvec3 e{estimate.X_WM.x - truth.x, estimate.X_WM.y - truth.y,
                     base::wrap_angle(estimate.X_WM.yaw - truth.yaw)};
  return glm::dot(e, glm::inverse(covariance) * e) / 3.0;
}

/// Returns whether the input, and no other, is stated to be faulty.
bool isolates(const estimation::LocalizationMonitor& monitor, estimation::MonitoredInput faulty) {
  return std::ranges::all_of(kMonitored, [&](estimation::MonitoredInput input) {
    return (monitor.state(input) == InputState::faulty) == (input == faulty);
  });
}

void note_healthy(const estimation::LocalizationMonitor& monitor, MonitoredStates& states, MonitoredCar& car) {
  bool suspected = false, faulty = false;
  for (const auto input : kMonitored) {
    const InputState now = monitor.state(input),
                     before = std::exchange(states.last[static_cast<std::size_t>(input)], now);
    const auto bad = [](InputState state) { return state == InputState::suspected || state == InputState::faulty; };
    suspected = suspected || (bad(now) && !bad(before));
    faulty = faulty || (now == InputState::faulty && before != now);
  }
  car.suspicions += suspected, car.alarms += faulty;
  car.healthy += 0.1;
  const auto keep = [&](std::size_t k, double value) { car.largest[k] = std::max(car.largest[k], value); };
  for (std::size_t k = 0; k < estimation::kRelations; ++k) {
    const auto& of = monitor.statistic(static_cast<estimation::MonitorRelation>(k));
    keep(k, of.fast), keep(estimation::kRelations + k, of.slow);
  }
  keep(2 * estimation::kRelations, std::abs(monitor.roughness()));
}

void note_fault(const estimation::LocalizationMonitor& monitor, const MonitorCase& fault, double time,
                MonitoredStates& states, MonitoredCar& car) {
  const bool untimely = loses_time(fault.kind);
  const InputState own = monitor.state(fault.input);
  const bool is_isolated = own == InputState::faulty || (untimely && own == InputState::absent);
  if (time < kFaultUntil) {
    const double since = time - kFaultFrom;
    bool other = false, suspected = false;
    for (const auto input : kMonitored) {
      other = other || (input != fault.input && monitor.state(input) == InputState::faulty);
      suspected = suspected || monitor.state(input) == InputState::suspected;
    }
    if ((is_isolated || other || suspected) && std::isnan(car.detected)) car.detected = since;
    if ((is_isolated || other) && std::isnan(car.isolated)) car.isolated = since;
    states.wrong = states.wrong || other;
    car.correct = !states.wrong && std::isfinite(car.isolated);
  } else if (std::isnan(car.handed_back) && own == InputState::good) {
    car.handed_back = time - kFaultUntil;
  }
}

}  // namespace

std::span<const MonitorCase> monitor_cases() { return kCases; }

std::string_view input_name(estimation::MonitoredInput input) {
  return std::array<std::string_view, 3>{"encoder", "gyro", "gps"}[static_cast<std::size_t>(input)];
}

namespace {

bool is_car(const world::Mover& mover) { return mover.name.starts_with("roomba"); }

Scenario monitor_scenario(const ExperimentContext& context, std::uint64_t seed, bool monitored) {
  Scenario scenario = context.scenario;
  if (!monitored) {
    std::string text = base::read_text(scenario.file);
    const std::string with = "monitor = true";
    text.replace(text.find(with), with.size(), "monitor = false");
    scenario = parse_scenario(scenario.file, text);
    scenario.plant = context.scenario.plant;
  }
  scenario.seed = seed;
  return scenario;
}

}  // namespace

std::size_t monitored_cars(const ExperimentContext& context) {
  const world::World world = world_of(context.scenario);
  return static_cast<std::size_t>(std::ranges::count_if(world.movers, is_car));
}

std::vector<MonitoredCar> run_monitored(const ExperimentContext& context, std::uint64_t seed, bool monitored,
                                        std::span<const std::optional<std::size_t>> faults) {
  const Scenario scenario = monitor_scenario(context, seed, monitored);
  const world::World world = world_of(scenario);
  SimulationOptions options = simulation_of(scenario, world);
  options.threads = context.options.threads;
  std::vector<MonitoredCar> cars;
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    if (!is_car(world.movers[row])) continue;
    cars.push_back({.seed = seed, .name = world.movers[row].name, .fault = faults[rows.size()]});
    rows.push_back(row);
    if (cars.back().fault) add_fault(kCases[*cars.back().fault], cars.back().name, options.faults);
  }
  Simulation simulation(world, context.device, std::move(options));
  const control::LaneCorridors corridors(*simulation.roads(), world, control::footprint_of(world.movers[rows[0]]));
  std::vector<MonitoredStates> states(cars.size());
  for (double time = 0.0; time < kMonitorEnd - 1e-6;) {
    if (context.options.stop && context.options.stop()) throw Interrupted();
    const base::TickRecord tick = simulation.step();
    time = 1e-9 * static_cast<double>(tick.time);
    for (std::size_t k = 0; k < cars.size(); ++k) {
      MonitoredCar& car = cars[k];
      const control::OwnLocalization& own = *control::localization_of(*simulation.controller(rows[k]));
      if (const auto* monitor = own.monitor()) {
        const bool healthy = !car.fault || time < kFaultFrom;
        if (time >= kSettled && (healthy || (time < kFaultUntil && isolates(*monitor, kCases[*car.fault].input))))
          (healthy ? car.healthy_nees : car.faulty_nees)
              .add(pose_nees(monitor->predict(tick.time).estimate, tick.reports[rows[k]].X_WM));
        if (!car.fault || time < kFaultFrom)
          note_healthy(*monitor, states[k], car);
        else
          note_fault(*monitor, kCases[*car.fault], time, states[k], car);
      }
      if (time < kFaultFrom || time >= kFaultUntil || own.is_lost()) continue;
      const base::Report& truth = tick.reports[rows[k]];
      const base::Pose estimate = own.pose_at(tick.time);
      const glm::dvec2 off{estimate.x - truth.X_WM.x, estimate.y - truth.X_WM.y};
      car.error_squares += dot(off, off);
      ++car.steps;
      if (std::abs(truth.velocity.forward) < kDriving) continue;
      const control::RoadPositions places = corridors.positions(truth.X_WM, kFarthestLane);
      const double offset = places.count == 0 ? kFarthestLane : places.begin()->offset;
      car.lane_squares += offset * offset;
      ++car.driven;
    }
  }
  return cars;
}

}  // namespace sf::scenarios
