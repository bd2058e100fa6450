#pragma once
// Cost of a world: memory, program start, and single features of the world.

#include <vector>

#include "bench/measurements.h"

namespace sf::bench {

/// Runs the program as a process and measures its peak resident memory and the time to the first reading. Fails if
/// SimVille with 50 robots needs 200 MiB, or a cold start to the first reading takes 1 s.
std::vector<Measurement> measure_program();

/// Measures ticks of SimVille with one sensor type subscribed at a time; also with magnets but no magnetometer, with
/// sensors that are not due, and with robots at rest.
std::vector<Measurement> measure_features(gpu::Device& device);

}  // namespace sf::bench
