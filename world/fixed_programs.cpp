#include "world/fixed_programs.h"

#include <algorithm>

namespace sf::world {

namespace {

/// Returns the time [s] between a stage and the next: its yellow and clear times, if some light needs them.
double change_time(const LightProgram& program, std::size_t stage, std::size_t next) {
  for (std::size_t i = 0; i < program.lights.size(); ++i)
    if (needs_yellow(program, stage, next, i)) return program.stages[stage].yellow + program.stages[stage].clear;
  return 0.0;
}

/// Merges equal neighbours, so every phase is a change.
void add_phase(std::vector<LightPhase>& phases, LightState state, double duration) {
  if (duration <= 0.0) return;
  if (!phases.empty() && phases.back().state == state) {
    phases.back().duration += duration;
  } else {
    phases.push_back({state, duration});
  }
}

std::vector<LightPhase> phases_of(const LightProgram& program, std::size_t i) {
  std::vector<LightPhase> phases;
  for (std::size_t k = 0; k < program.stages.size(); ++k) {
    const LightStage& stage = program.stages[k];
    const std::size_t next = (k + 1) % program.stages.size();
    add_phase(phases, stage.states[i], stage.shortest);
    const double change = change_time(program, k, next);
    if (change == 0.0) continue;
    if (needs_yellow(program, k, next, i)) {
      add_phase(phases, LightState::yellow, stage.yellow);
      add_phase(phases, LightState::red, stage.clear);
    } else {
      add_phase(phases, stage.states[i], change);
    }
  }
  return phases;
}

}  // namespace

double cycle_of(const LightProgram& program) {
  double cycle = 0.0;
  for (const LightPhase& phase : phases_of(program, 0)) cycle += phase.duration;
  return cycle;
}

std::optional<double> first_green(const LightProgram& program, std::uint32_t light) {
  const auto at = std::find(program.lights.begin(), program.lights.end(), light);
  const std::vector<LightPhase> phases = phases_of(program, static_cast<std::size_t>(at - program.lights.begin()));
  double time = 0.0;
  for (std::size_t k = 0; k < phases.size(); time += phases[k++].duration) {
    const bool begins = phases.size() == 1 || phases[(k + phases.size() - 1) % phases.size()].state != phases[k].state;
    if (phases[k].state == LightState::green && begins) return time;
  }
  return std::nullopt;
}

void set_phases(const LightProgram& program, World& world) {
  for (std::size_t i = 0; i < program.lights.size(); ++i) {
    Light& light = world.lights[program.lights[i]];
    light.phases = phases_of(program, i);
    light.offset = program.offset;
    // A state that spans the end of the cycle becomes one phase, at its start.
    if (light.phases.size() == 1 || light.phases.back().state != light.phases.front().state) continue;
    light.offset -= light.phases.back().duration;
    light.phases.front().duration += light.phases.back().duration;
    light.phases.pop_back();
  }
}

}  // namespace sf::world
