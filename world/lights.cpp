#include "world/lights.h"

#include <cmath>
#include <limits>

namespace sf::world {

Signal signal_at(const Light& light, double time) {
  double cycle = 0.0;
  for (const LightPhase& phase : light.phases) cycle += phase.duration;
  if (light.phases.size() == 1) return {light.phases.front().state, std::numeric_limits<double>::infinity()};
  double into = std::fmod(time - light.offset, cycle);
  if (into < 0.0) into += cycle;
  for (const LightPhase& phase : light.phases) {
    if (into < phase.duration) return {phase.state, phase.duration - into};
    into -= phase.duration;
  }
  // The sum of all durations and the remainder of the division can differ in the last bit.
  return {light.phases.front().state, light.phases.front().duration};
}

std::string_view name_of(LightState state) {
  switch (state) {
    case LightState::red:
      return "red";
    case LightState::yellow:
      return "yellow";
    case LightState::green:
      return "green";
    case LightState::flashing_red:
      return "flashing red";
    case LightState::flashing_yellow:
      return "flashing yellow";
    case LightState::dark:
      break;
  }
  return "dark";
}

}  // namespace sf::world
