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

SignalForecast forecast_at(const Light& light, double time) {
  constexpr double kInto = 5e-4;  // [s] into the next phase, more than rounding errors
  SignalForecast forecast{signal_at(light, time), 0.0, std::nullopt};
  forecast.latest = forecast.now.left;
  if (!std::isfinite(forecast.now.left)) return forecast;
  forecast.next = signal_at(light, time + forecast.now.left + kInto);
  forecast.next->left += forecast.now.left + kInto;
  return forecast;
}

std::vector<SignalForecast> forecasts_at(const World& world, double time) {
  std::vector<SignalForecast> forecasts;
  for (const Light& light : world.lights) forecasts.push_back(forecast_at(light, time));
  return forecasts;
}

std::uint32_t carrier_of(const World& world, const Light& light) {
  const std::uint32_t mover = light.model < world.models.size() ? world.models[light.model].mover : kNone;
  const bool is_post = mover != kNone && world.movers[mover].is_tag && world.movers[mover].model == light.model;
  return is_post ? mover : kNone;
}

std::string_view light_state_name(LightState state) { return words_of(state).at(static_cast<std::size_t>(state)); }

}  // namespace sf::world
