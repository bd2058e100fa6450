#pragma once
// The subcommands and their options, each beside its kin.

#include "apps/options.h"

namespace CLI {
class App;
}  // namespace CLI

namespace sf::apps {

void add_inspect_commands(CLI::App& app, Options& o);  ///< at worlds, devices and recordings
void add_run_commands(CLI::App& app, Options& o);      ///< the farm, robots, and who listens to them
void add_test_commands(CLI::App& app, Options& o);     ///< experiments, and scenarios as tests

}  // namespace sf::apps
