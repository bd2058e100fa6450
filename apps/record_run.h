#pragma once
// What a recording says of its run.

#include "apps/options.h"
#include "record/recorder.h"
#include "world/world.h"

namespace sf::apps {

record::RunInfo run_info(const world::World& world, const Options& options);

}  // namespace sf::apps
