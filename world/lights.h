#pragma once
// What a traffic light shows at some time.

#include <string_view>

#include "world/world.h"

namespace sf::world {

/// One light at one time.
struct Signal {
  LightState state = LightState::dark;
  double left = 0.0;  ///< [s] until it changes; infinity: it never does
};

/// @param time [s] simulated
Signal signal_at(const Light& light, double time);

std::string_view name_of(LightState state);  ///< "flashing red"

}  // namespace sf::world
