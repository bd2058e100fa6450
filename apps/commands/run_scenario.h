#pragma once
// `run` with a scenario file instead of a world: runs the fleet of `test` so that it can be watched, recorded and sent.

#include <optional>
#include <string>

#include "apps/options/options.h"
#include "scenarios/scenario.h"

namespace sf::apps {

/// True if the file name is that of a scenario.
bool is_scenario(const std::string& file);

/// Returns the checked scenario of a run, or nullopt if its file is a world. Sets the seed to the scenario's, and the
/// duration if none is given, except with bridges and neither recording nor video.
/// @throws base::InputError for a scenario that cannot be run
std::optional<scenarios::Scenario> scenario_of(RunOptions& options);

/// Loads the scenario's world and prints its warnings.
world::World load_scenario_world(const scenarios::Scenario& scenario, const world::LoadOptions& load);

}  // namespace sf::apps
