#pragma once
// The state of a traffic light at a given time.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/tick_record.h"
#include "world/world.h"

namespace sf::world {

/// One light at one time.
struct Signal {
  LightState state = LightState::dark;
  double left = 0.0;  ///< [s] until the next change; infinity: the state never changes, or nobody knows when
};

/// A light now, and after its next change.
struct SignalForecast {
  Signal now;                  ///< `left`: until the earliest change
  double latest = 0.0;         ///< [s] until the latest change, >= now.left
  std::optional<Signal> next;  ///< after the earliest change, its `left` from now on; nullopt: not known
};

/// @param time [s] simulated
Signal signal_at(const Light& light, double time);
SignalForecast forecast_at(const Light& light, double time);

/// All lights of a world by their plans, at `time` [s].
std::vector<SignalForecast> forecasts_at(const World& world, double time);

/// As recordings have it.
inline base::LightStatus status_of(const Signal& signal) {
  return {static_cast<std::uint8_t>(signal.state), signal.left};
}

std::string_view name_of(LightState state);  ///< "flashing red"

}  // namespace sf::world
