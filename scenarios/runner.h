#pragma once
// Runs a scenario and says what came of it, expectation by expectation.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "scenarios/scenario.h"

namespace sf::scenarios {

/// One expectation beside what was measured.
struct ExpectationResult {
  std::string what;      ///< "mean_abs_error of roomba0"
  std::string expected;  ///< "<= 0.05"
  std::string measured;  ///< "0.0412"
  bool met = false;
  int line = 0;  ///< in the scenario's file
};

/// Nothing expected is neither a failure nor a success.
enum class ScenarioStatus : std::uint8_t { passed, failed, no_expectations };

struct ScenarioResult {
  std::string name;
  std::string file;
  std::vector<ExpectationResult> outcomes;
  double simulated = 0.0;  ///< [s]
  double wall = 0.0;       ///< [s]
  std::uint64_t ticks = 0;
  std::uint64_t hash = 0;  ///< of all readings
  ScenarioStatus status() const;
};

/// Everything that a run would refuse, without a device and before any has begun: its world, its robots, their
/// controllers and settings, what is expected of whom. @return what there is to warn of
/// @throws base::InputError at the scenario's line, or at that of a file that it names.
std::vector<world::Warning> check_scenario(const Scenario& scenario);

/// @param progress called now and then with the part in [0, 1] that is done; may be empty
/// @throws base::InputError for what the world or a robot lacks.
ScenarioResult run_scenario(const Scenario& scenario, gpu::Device& device,
                            const std::function<void(double)>& progress = {});

}  // namespace sf::scenarios
