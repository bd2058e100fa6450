#pragma once
// `--auto`: modes chosen by measurement before a run.

#include "apps/options.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::apps {

/// Where the user asked for it, measures every mode here and gives `world` the words that the wish comes to; says so.
void choose_accuracy(world::World& world, gpu::Device& device, const Options& options);

}  // namespace sf::apps
