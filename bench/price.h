#pragma once
// What a world pays for: memory, the start of the program, and the world's features one by one.

#include <vector>

#include "bench/measurements.h"

namespace sf::bench {

/// The program itself, as a process: most resident memory and seconds to the first reading. Fails where SimVille with
/// 50 robots takes 200 MiB or a cold start to the first reading 1 s.
std::vector<Measurement> measure_program();

/// SimVille with each kind of sensor heard alone; magnets that nobody measures; who is not due; who stands.
std::vector<Measurement> measure_features(gpu::Device& device);

}  // namespace sf::bench
