#pragma once
// `--auto`: modes chosen by measurement before a run.

#include "apps/options/options.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::apps {

/// With `--auto`, measures every mode on this machine and gives `world` the words that reach the target; says so.
/// @param threads of the farm's part on the host; 0: all
void choose_accuracy(world::World& world, gpu::Device& device, const AccuracyTargetOptions& options, std::uint64_t seed,
                     unsigned threads);

}  // namespace sf::apps
