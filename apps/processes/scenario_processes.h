#pragma once
// Scenarios in processes of their own: a controller that ends its process costs its scenario and no other.

#include <functional>
#include <vector>

#include "apps/options/options.h"
#include "scenarios/runner.h"

namespace sf::apps {

/// Prints the warnings of all scenarios, then runs those that a process could check.
/// @param checked called in between, when nothing has run
/// @param show called with each result, in the order of the files
/// @return false: a request to stop (apps/processes/stop_signals.h) ended it; scenarios that were not shown have not
/// come to their end
/// @throws base::InputError for a scenario that cannot be run, base::DeviceError
bool run_in_own_processes(const TestOptions& options, const std::function<void()>& checked,
                          const std::function<void(const scenarios::ScenarioResult&)>& show);

}  // namespace sf::apps
