#pragma once
// Cost of a world: memory, start of the program, and single features of the world.

#include <vector>

#include "bench/measurements.h"

namespace sf::bench {

/// Runs the program as a process and measures its peak resident memory and the time to the first reading. Fails when
/// SimVille with 50 robots takes 200 MiB, or a cold start to the first reading 1 s.
std::vector<Measurement> measure_program();

/// Ticks of SimVille with one sensor type subscribed at a time; also with magnets but no magnetometer, with sensors
/// that are not due, and with standing robots.
std::vector<Measurement> measure_features(gpu::Device& device);

}  // namespace sf::bench
