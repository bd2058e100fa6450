#pragma once
// What a recording says of its run.

#include "apps/options.h"
#include "record/recorder.h"
#include "sensors/roster.h"
#include "world/world.h"

namespace sf::apps {

record::RunInfo run_info(const world::World& world, const sensors::Roster& roster, const Options& options);

}  // namespace sf::apps
