#pragma once
// What worlds on a device (sensorfarm/device_worlds.h) do not support, besides what robots::DeviceFleet and
// raycast::PoseScanner refuse.

#include <string>

#include "sensorfarm/simulation.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::library {

/// Returns a noun with its reason; "" if all is supported.
std::string unsupported_option(const sensorfarm::Options& options);
std::string unsupported(const world::World& world, const sensors::SensorSet& sensor_set,
                        const sensorfarm::Options& options);

}  // namespace sf::library
