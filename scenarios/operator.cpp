#include "scenarios/operator.h"

#include <algorithm>
#include <thread>

#include "base/elapsed.h"

namespace sf::scenarios {

namespace {

constexpr std::chrono::milliseconds kLook{20};   // interval of checks for requests while the next tick is not due
constexpr std::chrono::milliseconds kPause{33};  // interval of checks while paused

}  // namespace

Operator::Operator(bridges::Bridges& bridges, const std::atomic<bool>& stop, double speed)
    : bridges_(bridges), stop_(stop), since_(Clock::now()), measured_at_(since_) {
  state_.speed = speed;
}

Operator::Next Operator::wait(Simulation& simulation, double simulated) {
  measure(simulated);
  while (!stop_) {
    apply(simulation, simulated);
    if (world_) return Next::world;
    if (reset_) return Next::reset;
    if (state_.paused) {
      if (steps_ > 0) return --steps_, Next::tick;
      bridges_.publish(state_);
      std::this_thread::sleep_for(kPause);
      set_anchor(simulated);
      continue;
    }
    const Clock::time_point due = due_at(simulated), now = Clock::now();
    if (now >= due) return Next::tick;
    std::this_thread::sleep_until(std::min(due, now + kLook));
  }
  return Next::stop;
}

void Operator::keep_pace(double simulated) const {
  const Clock::time_point due = due_at(simulated);
  while (Clock::now() < due && !stop_) std::this_thread::sleep_until(std::min(due, Clock::now() + kLook));
}

void Operator::publish(const base::TickRecord& tick, std::span<const base::Intent> intents) {
  bridges_.show_intents(intents);
  bridges_.publish(tick, state_);
}

void Operator::begin_again() {
  reset_ = false;
  steps_ = 0;
  ++state_.runs;
  set_anchor(0.0);
  measured_at_ = since_, measured_from_ = 0.0;
}

void Operator::apply(Simulation& simulation, double simulated) {
  if (bridges_.empty()) return;
  bridges_.take(requests_);
  for (const bridges::Placement& each : requests_.placements) simulation.put(each.mover, each.X_WM, each.tilt);
  for (const bridges::Command& each : requests_.commands) simulation.drive(each.mover, each.twist);
  if (requests_.speed) {
    state_.speed = *requests_.speed;
    set_anchor(simulated);
  }
  if (requests_.paused) state_.paused = *requests_.paused;
  steps_ = state_.paused ? steps_ + requests_.steps : 0;
  steps_ -= std::min(steps_, requests_.dropped_steps);
  apply_fleet_changes();
  reset_ = requests_.reset;
}

void Operator::apply_fleet_changes() {
  const auto refuse = [](bridges::Outcome& outcome, const char* why) {
    outcome = {true, bridges::Outcome::Fault::failed, why};
  };
  for (bridges::Joining& each : requests_.joining) joining_.push_back(std::move(each));
  const auto end = joining_.begin() + static_cast<std::ptrdiff_t>(std::min(joining_.size(), kMostJoining));
  const std::vector<bridges::Joining> joining(joining_.begin(), end);
  joining_.erase(joining_.begin(), end);
  if (change_fleet_ && !(joining.empty() && requests_.leaving.empty())) change_fleet_(joining, requests_.leaving);
  const auto refuse_rest = [&](const auto& all) {
    for (const auto& each : all)
      if (!each.outcome->done) refuse(*each.outcome, "robots cannot join or leave this run");
  };
  refuse_rest(joining), refuse_rest(requests_.leaving);
  if (!requests_.world) return;
  if (loads_worlds_)
    world_ = std::move(requests_.world);
  else
    refuse(*requests_.world->outcome, "this run cannot load another world");
}

bridges::WorldChange Operator::take_world() {
  bridges::WorldChange world = std::move(*world_);
  world_.reset();
  return world;
}

void Operator::set_anchor(double simulated) {
  since_ = Clock::now();
  from_ = simulated;
}

void Operator::measure(double simulated) {
  const double passed = base::seconds_since(measured_at_);
  if (passed < 1.0) return;
  state_.measured = (simulated - measured_from_) / passed;
  measured_at_ = Clock::now(), measured_from_ = simulated;
}

Operator::Clock::time_point Operator::due_at(double simulated) const {
  constexpr double kAYear = 3e7;  // [s] longer times would overflow the clock
  const std::chrono::duration<double> later(std::min(kAYear, (simulated - from_) / state_.speed));
  return since_ + std::chrono::duration_cast<Clock::duration>(later);
}

}  // namespace sf::scenarios
