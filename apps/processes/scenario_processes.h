#pragma once
// Runs scenarios in separate processes. A controller that ends its process fails only its scenario.

#include <functional>

#include "apps/options/options.h"
#include "scenarios/runner.h"

namespace sf::apps {

/// Prints the warnings of all scenarios, then runs those that passed the check in a separate process.
/// @param checked called after all checks, before the first run
/// @param show called with each result, in the order of the files
/// @return false if a stop request (apps/processes/stop_signals.h) ended it; scenarios that were not shown are
/// unfinished
/// @throws base::InputError for a scenario that cannot be run, base::DeviceError
bool run_in_own_processes(const TestOptions& options, const std::function<void()>& checked,
                          const std::function<void(const scenarios::ScenarioResult&)>& show);

}  // namespace sf::apps
