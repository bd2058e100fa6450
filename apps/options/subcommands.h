#pragma once
// The subcommands and their options, by topic.

#include "apps/options/option_groups.h"

namespace CLI {
class App;
}  // namespace CLI

namespace sf::apps {

void add_inspect_commands(CLI::App& app, Call& call);  ///< worlds, devices, messages
void add_export_commands(CLI::App& app, Call& call);   ///< plots, exports and views of recordings
void add_run_commands(CLI::App& app, Call& call);      ///< the farm, robots, receivers
void add_test_commands(CLI::App& app, Call& call);     ///< experiments, scenarios, self-tests
void add_vision_commands(CLI::App& app, Call& call);   ///< cameras

}  // namespace sf::apps
