#pragma once
// The state of a traffic light at a given time.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/tick_record.h"
#include "world/world.h"

namespace sf::world {

/// A light's state at one time.
struct Signal {
  LightState state = LightState::dark;
  double left = 0.0;  ///< [s] until the next change; infinity: the state never changes, or the time is unknown
};

/// A light's state now and after its next change.
struct SignalForecast {
  Signal now;                  ///< `left`: until the earliest possible change
  double latest = 0.0;         ///< [s] until the latest possible change, >= now.left
  std::optional<Signal> next;  ///< after the earliest change, with `left` counted from now; nullopt: unknown
};

/// @param time [s] simulated
Signal signal_at(const Light& light, double time);
SignalForecast forecast_at(const Light& light, double time);

/// Returns the forecasts of all lights of a world by their plans, at `time` [s].
std::vector<SignalForecast> forecasts_at(const World& world, double time);

/// Converts a signal to its form in recordings.
inline base::LightStatus status_of(const Signal& signal) {
  return {static_cast<std::uint8_t>(signal.state), signal.left};
}

/// Returns the row of the mover that is the light's post, for lights that join and leave; kNone: the light is fixed.
std::uint32_t carrier_of(const World& world, const Light& light);

std::string_view light_state_name(LightState state);  ///< "flashing red"

}  // namespace sf::world
