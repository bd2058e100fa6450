#pragma once
// Converts the ports and the wire format of the command line to a stream layout.

#include "apps/options/options.h"
#include "server/stream_layout.h"

namespace sf::apps {

/// Calls `server::stream_layout` and prints its notes on standard error.
server::StreamLayout stream_layout_of(const world::World& world, const sensors::SensorSet& sensor_set,
                                      const PortOptions& options);

}  // namespace sf::apps
