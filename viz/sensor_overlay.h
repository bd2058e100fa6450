#pragma once
// Sensors that robots carry beside lasers, where they are at load: fans of lane edge sensors, elements of
// magnetometers.

#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/world.h"

namespace sf::viz {

/// @throws base::InputError with file and line for a sensor whose settings make no sense.
void draw_sensors(Axes& axes, const world::World& world);

/// What of these the world has.
std::vector<LegendItem> sensor_legend(const world::World& world);

}  // namespace sf::viz
