#pragma once
// The ports and wire format of the command line, as a layout of streams.

#include "apps/options/options.h"
#include "server/stream_layout.h"

namespace sf::apps {

/// `server::stream_layout`, with its notes printed on standard error.
server::StreamLayout stream_layout_of(const world::World& world, const sensors::SensorSet& sensor_set,
                                      const PortOptions& options);

}  // namespace sf::apps
