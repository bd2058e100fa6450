#include "apps/run_scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "apps/report.h"
#include "apps/text.h"
#include "base/error.h"
#include "scenarios/runner.h"

namespace sf::apps {

namespace {

/// Options that a scenario settles. Each differs from its default only where it is given.
void refuse_settled(const RunOptions& options) {
  const RunOptions unset;
  const auto refuse = [&](bool given, const char* option, const char* key) {
    if (given)
      throw base::InputError(
          fmt::format("{} is for worlds; a scenario states {}: change {}", option, key, options.world));
  };
  refuse(options.robots != 0, "--robots", "`robots`");
  refuse(!options.of.empty(), "--of", "`of`");
  refuse(options.seed != unset.seed, "--seed", "`seed`");
  refuse(options.controller != unset.controller, "--controller", "`controller`");
  refuse(!options.set.empty(), "--set", "`settings`");
  refuse(options.localize, "--localize", "`settings`");
  refuse(!options.drive.empty(), "--drive", "its controllers");
}

}  // namespace

bool is_scenario(const std::string& file) { return file.ends_with(".toml"); }

std::optional<scenarios::Scenario> scenario_of(RunOptions& options) {
  if (!is_scenario(options.world)) return std::nullopt;
  refuse_settled(options);
  scenarios::Scenario scenario = scenarios::read_scenario(options.world);
  scenarios::check_scenario(scenario);
  options.seed = scenario.seed;
  if (!options.duration && !options.BridgeOptions::any()) options.duration = scenario.duration;
  if (!scenario.expect.empty())
    print_message(
        "{}: {} not judged by `run`; `sensorfarm test` judges them", options.world,
        scenario.expect.size() == 1 ? "1 expectation is" : fmt::format("{} expectations are", scenario.expect.size()));
  return scenario;
}

world::World load_scenario_world(const scenarios::Scenario& scenario, const world::LoadOptions& load) {
  world::World world = scenarios::world_of(scenario, load);
  print_warnings(scenario.world, world.warnings);
  return world;
}

std::string controllers_of(const scenarios::Scenario& scenario, const world::World& world) {
  std::vector<std::string> names;
  for (const scenarios::Actor& actor : scenarios::simulation_of(scenario, world).actors) {
    const std::string& name = actor.controller.name;
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace sf::apps
