#pragma once
// Converts programs of fixed stages to plans of single lights.

#include <optional>

#include "world/light_plan.h"

namespace sf::world {

/// Returns the length [s] of all stages and the yellow and clear times between them. @pre the program is not actuated
double cycle_of(const LightProgram& program);

/// Returns the time [s] from the start of the first stage until row `light` of the world turns green; nullopt: never. 0
/// for a light that is always green.
/// @pre the program is not actuated and has the light
std::optional<double> first_green(const LightProgram& program, std::uint32_t light);

/// Sets the phases and offsets of the program's lights. @pre the program is not actuated
void set_phases(const LightProgram& program, World& world);

}  // namespace sf::world
