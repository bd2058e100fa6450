#include "world/actuated_lights.h"

#include <algorithm>
#include <limits>

namespace sf::world {

namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::infinity();

}  // namespace

ActuatedLights::ActuatedLights(const World& world, const LightPlan& plan, double time)
    : world_(world), plan_(plan), last_(plan.detectors.size(), kNever) {
  for (const LightProgram& program : plan.programs)
    if (is_actuated(program))
      runs_.push_back({&program, 0, time, false, 0, std::vector<double>(program.stages.size(), kNever)});
}

void ActuatedLights::detect(glm::dvec2 p, double time) {
  for (std::size_t k = 0; k < last_.size(); ++k) {
    const LightDetector& detector = plan_.detectors[k];
    if (detector.p && glm::length(p - *detector.p) <= detector.radius) last_[k] = time;
  }
}

bool ActuatedLights::has_call(const LightDetector& detector, double last, double time) const {
  if (time - last <= kHeard) return true;
  return std::any_of(detector.calls.begin(), detector.calls.end(),
                     [&](const auto& call) { return time >= call.first && time <= call.second; });
}

void ActuatedLights::step(double time) {
  for (Run& run : runs_) {
    note_calls(run, time);
    step(run, time);
  }
}

void ActuatedLights::note_calls(Run& run, double time) const {
  for (std::size_t k = 0; k < run.called.size(); ++k)
    for (const std::uint32_t row : run.program->stages[k].detectors)
      if (has_call(plan_.detectors[row], last_[row], time)) run.called[k] = time;
}

/// Returns the next stage that is not skipped, or the current stage if no other is needed.
std::size_t ActuatedLights::next_stage(const Run& run) const {
  const std::size_t count = run.program->stages.size();
  for (std::size_t k = 1; k < count; ++k) {
    const std::size_t stage = (run.stage + k) % count;
    if (!run.program->stages[stage].on_call || run.called[stage] != kNever) return stage;
  }
  return run.stage;
}

/// Returns the yellow and clear time [s] before the next stage.
double ActuatedLights::change_time(const Run& run) const {
  const LightStage& stage = run.program->stages[run.stage];
  for (std::size_t i = 0; i < run.program->lights.size(); ++i)
    if (needs_yellow(*run.program, run.stage, run.next, i)) return stage.yellow + stage.clear;
  return 0.0;
}

void ActuatedLights::step(Run& run, double time) const {
  const LightStage& stage = run.program->stages[run.stage];
  if (!run.changing) {
    const double length = time - run.since;
    run.next = next_stage(run);
    const bool prolonged = time - run.called[run.stage] <= stage.gap && length < stage.longest;
    if (length < stage.shortest || prolonged || run.next == run.stage) return;
    run.changing = true;
    run.since = time;
    run.called[run.stage] = kNever;
  }
  if (time - run.since < change_time(run)) return;
  run.changing = false;
  run.stage = run.next;
  run.since = time;
}

SignalForecast ActuatedLights::forecast(const Run& run, std::size_t i, double time) const {
  const LightStage& stage = run.program->stages[run.stage];
  const LightState now = stage.states[i], after = run.program->stages[run.next].states[i];
  const bool yellow = needs_yellow(*run.program, run.stage, run.next, i);
  const double since = time - run.since, change = change_time(run);
  if (run.changing) {
    const double left = std::max(0.0, change - since);
    if (!yellow && after == now) return {{now, kUnknown}, kUnknown, std::nullopt};
    if (!yellow) return {{now, left}, left, Signal{after, kUnknown}};
    if (since >= stage.yellow && after == LightState::red) return {{LightState::red, kUnknown}, kUnknown, std::nullopt};
    if (since >= stage.yellow) return {{LightState::red, left}, left, Signal{after, kUnknown}};
    const double end = stage.yellow - since;
    return {{LightState::yellow, end}, end, Signal{stage.clear > 0.0 ? LightState::red : after, kUnknown}};
  }
  const double soonest = std::max(0.0, stage.shortest - since);
  // If no other stage is needed, this one may last.
  const double latest = run.next == run.stage ? kUnknown : std::max(soonest, stage.longest - since);
  if (run.next == run.stage || (!yellow && after == now)) return {{now, kUnknown}, kUnknown, std::nullopt};
  if (yellow) return {{now, soonest}, latest, Signal{LightState::yellow, soonest + stage.yellow}};
  return {{now, soonest + change}, latest + change, Signal{after, kUnknown}};
}

std::vector<SignalForecast> ActuatedLights::forecasts(double time) const {
  std::vector<SignalForecast> all = forecasts_at(world_, time);
  for (const Run& run : runs_)
    for (std::size_t i = 0; i < run.program->lights.size(); ++i)
      if (run.program->lights[i] != kNone) all[run.program->lights[i]] = forecast(run, i, time);
  return all;
}

}  // namespace sf::world
