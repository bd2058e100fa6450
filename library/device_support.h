#pragma once
// Names the sensors, worlds and options that DeviceWorlds (sensorfarm/device_worlds.h) does not support.
// robots::DeviceFleet and raycast::PoseScanner refuse further ones.

#include <string>

#include "sensorfarm/simulation.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::library {

/// Returns a noun with its reason; "" if all is supported.
std::string unsupported_option(const sensorfarm::Options& options);
std::string unsupported(const world::World& world, const sensors::SensorSet& sensor_set,
                        const sensorfarm::Options& options);
std::string unsupported(const sensorfarm::WorldStarts& starts);

}  // namespace sf::library
