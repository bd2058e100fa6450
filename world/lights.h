#pragma once
// The state of a traffic light at a given time.

#include <string_view>

#include "world/world.h"

namespace sf::world {

/// One light at one time.
struct Signal {
  LightState state = LightState::dark;
  double left = 0.0;  ///< [s] until the next change; infinity: the state never changes
};

/// @param time [s] simulated
Signal signal_at(const Light& light, double time);

std::string_view name_of(LightState state);  ///< "flashing red"

}  // namespace sf::world
