#pragma once
// `--auto`: chooses accuracy modes by measurement before a run.

#include "apps/options/options.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::apps {

/// With `--auto`, measures every mode on this machine, gives `world` the modes that reach the target, and prints them.
/// @param threads of the farm on the host; 0: all
void choose_accuracy(world::World& world, gpu::Device& device, const AccuracyTargetOptions& options, std::uint64_t seed,
                     unsigned threads);

}  // namespace sf::apps
