#pragma once
// Draws sensors other than lasers at the loaded poses of their robots: fans of lane edge sensors, elements of
// magnetometers.

#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/world.h"

namespace sf::viz {

/// @throws base::InputError with file and line for a sensor with invalid settings.
void draw_sensors(Axes& axes, const world::World& world);

/// Legend items for the sensors of this layer in the world.
std::vector<LegendItem> sensor_legend(const world::World& world);

}  // namespace sf::viz
