#pragma once
// Complete ticks of a large fleet: motion, contacts, decisions, three sensor types, packets to a socket.

#include "bench/report.h"
#include "gpu/device.h"

namespace sf::bench {

/// Runs `robots` wandering robots that see each other, each with a laser of 361 beams to 8 m, a lane edge sensor of 61
/// rays and five magnetometers, all at 10 Hz, for `ticks` ticks. A tick ends when all packets are encoded; sending
/// overlaps with the next tick. Times of stages are means per tick.
Report drive_large_fleet(gpu::Device& device, std::uint32_t robots, std::size_t ticks);

}  // namespace sf::bench
