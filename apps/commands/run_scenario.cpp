#include "apps/commands/run_scenario.h"

#include <fmt/format.h>

#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "scenarios/fault_tables.h"
#include "scenarios/runner.h"

namespace sf::apps {

bool is_scenario(const std::string& file) { return file.ends_with(".toml"); }

std::optional<scenarios::Scenario> scenario_of(RunOptions& options) {
  if (!is_scenario(options.world)) return std::nullopt;
  scenarios::Scenario scenario = scenarios::read_scenario(options.world);
  scenarios::check_scenario(scenario);
  options.seed = scenario.seed;
  options.faults = scenarios::faults_text(scenario.faults);
  const bool kept = !options.record.empty() || !options.video.empty();
  if (!options.duration && (kept || !options.BridgeOptions::any())) options.duration = scenario.duration;
  if (!scenario.expect.empty())
    print_message(
        "{}: {} not checked by `run`; use `sensorfarm test`", options.world,
        scenario.expect.size() == 1 ? "1 expectation is" : fmt::format("{} expectations are", scenario.expect.size()));
  return scenario;
}

world::World load_scenario_world(const scenarios::Scenario& scenario, const world::LoadOptions& load) {
  world::World world = scenarios::world_of(scenario, load);
  print_warnings(scenario.world, world.warnings);
  return world;
}

}  // namespace sf::apps
