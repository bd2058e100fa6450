#pragma once
// `run` with a scenario file in place of a world: the fleet of `test`, to be watched, recorded and sent.

#include <optional>
#include <string>

#include "apps/options/options.h"
#include "scenarios/scenario.h"

namespace sf::apps {

/// A scenario file, by its name.
bool is_scenario(const std::string& file);

/// The scenario of a run, checked; none: its file is a world. The seed becomes the scenario's, and so does the duration
/// where none is given, except beside bridges without a recording or video.
/// @throws base::InputError for a scenario that cannot be run
std::optional<scenarios::Scenario> scenario_of(RunOptions& options);

/// The scenario's world, after its warnings are printed.
world::World load_scenario_world(const scenarios::Scenario& scenario, const world::LoadOptions& load);

/// Names of the controllers that drive robots, as in "route, convoy".
std::string controllers_of(const scenarios::Scenario& scenario, const world::World& world);

}  // namespace sf::apps
