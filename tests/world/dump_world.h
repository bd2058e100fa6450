#pragma once
// Prints a loaded world as text: every field of every row, one row per line, numbers rounded to a micrometre.

#include <string>

#include "world/light_plan.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::world {

std::string dump_of(const World& world);
/// Prints lanes, edges, exits with their curves, stop lines, and the transitions from every point.
std::string dump_of(const RoadNetwork& roads);
std::string dump_of(const LightPlan& plan);

}  // namespace sf::world
