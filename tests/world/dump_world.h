#pragma once
// A loaded world as text: every field of every row, one row a line, numbers rounded to a micrometre.

#include <string>

#include "world/light_plan.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::world {

std::string dump_of(const World& world);
/// Lanes, edges, exits with their curves, stop lines, and the transitions from every point.
std::string dump_of(const RoadNetwork& roads);
std::string dump_of(const LightPlan& plan);

}  // namespace sf::world
