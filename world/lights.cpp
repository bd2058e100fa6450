#include "world/lights.h"

#include <cmath>
#include <limits>

#include "world/fields.h"

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

std::string_view name_of(LightState state) { return words_of(state).at(static_cast<std::size_t>(state)); }

}  // namespace sf::world
