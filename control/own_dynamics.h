#pragma once
// Users' own actuator models (sensorfarm/dynamics.h) as dynamics of a fleet.

#include <cstdint>

#include "robots/dynamics.h"
#include "robots/fleet.h"
#include "world/world.h"

namespace sf::control {

/// Returns the dynamics that a plug-in has for a robot; null if it moves in the plane or as a car. Loads the plug-in.
/// @throws base::InputError with file and line of `dynamics`
robots::DynamicsPointer make_own_dynamics(const world::World& world, std::uint32_t mover);

/// Sets them for all robots of the fleet's world.
void set_own_dynamics(const world::World& world, robots::Fleet& fleet);

}  // namespace sf::control
