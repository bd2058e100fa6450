#pragma once
// Runs scenarios and judges their expectations.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cluster/ranks.h"
#include "gpu/device.h"
#include "scenarios/expectations.h"
#include "scenarios/scenario.h"

namespace sf::scenarios {

/// A scenario without expectations neither passes nor fails.
enum class ScenarioStatus : std::uint8_t { passed, failed, no_expectations };

struct ScenarioResult {
  std::string name;
  std::string file;
  std::vector<ExpectationResult> outcomes;
  double simulated = 0.0;  ///< [s]
  double wall = 0.0;       ///< [s]
  std::uint64_t ticks = 0;
  std::uint64_t hash = 0;  ///< of all readings
  /// Metrics of every run, then the other ones that the scenario expects. Without durations, so identical on any
  /// machine.
  std::vector<Metric> metrics;
  std::string failure = {};       ///< why it did not complete; empty: it did
  ScenarioStatus status() const;  ///< failed if there is a failure, whatever it expects
};

/// Validates a scenario without a device: world, robots, controllers with their settings, and expectations.
/// @return warnings
/// @throws base::InputError at the scenario's line, or at the line of a file named in it
std::vector<world::Warning> check_scenario(const Scenario& scenario);

/// Runs a scenario.
/// @param progress called with the completed fraction in [0, 1]; may be empty @param threads on the host; 0: all. Does
/// not affect results @param ranks that share the fleet and all call this; null: none. The first rank's result has the
/// hash of readings @param stop polled each tick and within long ones; may be empty
/// @throws base::InputError if the world or a robot lacks something required; with ranks cluster::Failure on all of
/// them
/// @throws base::Interrupted if `stop` returns true; with ranks on all of them if it does on one
ScenarioResult run_scenario(const Scenario& scenario, gpu::Device& device,
                            const std::function<void(double)>& progress = {}, unsigned threads = 0,
                            cluster::Ranks* ranks = nullptr, const std::function<bool()>& stop = {});

}  // namespace sf::scenarios
