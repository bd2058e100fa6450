#pragma once
// Programs of fixed stages as plans of single lights.

#include <optional>

#include "world/light_plan.h"

namespace sf::world {

/// [s] of all stages with the yellow and clear times between them. @pre the program is not actuated
double cycle_of(const LightProgram& program);

/// [s] from the start of the first stage until row `light` of the world turns green; nullopt: never. 0 for a light that
/// always is green. @pre the program is not actuated and has the light
std::optional<double> first_green(const LightProgram& program, std::uint32_t light);

/// Replaces phases and offsets of the program's lights. @pre the program is not actuated
void set_phases(const LightProgram& program, World& world);

}  // namespace sf::world
