#pragma once
// A sweep: one scenario at the points of a grid or a sample of its keys, each point with several seeds. A TOML file;
// see docs/sweeps.md for its keys. Jobs are numbered so that the seed changes fastest and the file's first parameter
// slowest.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/scenario.h"
#include "world/toml.h"

namespace sf::scenarios {

/// Maximum number of jobs of a sweep.
inline constexpr std::uint64_t kMostJobs = 1'000'000;

/// A key of the scenario's file and its values.
struct SweepParameter {
  std::string name;                     ///< path of keys, for example "default.settings.kp" or "robot.NAME.rate"
  std::vector<world::TomlNode> values;  ///< at least one; for a sampled parameter, one per point of the sample
  bool sampled = false;
  int line = 0;  ///< in the sweep's file
};

struct Sweep {
  std::string name;                        ///< default: the file's name without extension
  std::string file;                        ///< of the sweep
  std::string scenario;                    ///< path of the scenario's file
  world::TomlNode settings;                ///< content of the scenario's file
  std::vector<SweepParameter> parameters;  ///< of the grid first, then the sampled ones
  std::uint64_t samples = 1;               ///< number of points of the sample; 1 without a sample
  std::vector<std::uint64_t> seeds;        ///< at least one, all different
  std::uint64_t hash = 0;                  ///< of both files

  std::uint64_t points() const;
  std::uint64_t jobs() const { return points() * seeds.size(); }
};

/// @throws base::InputError with file and line, also for unknown keys and more than kMostJobs jobs
Sweep parse_sweep(const std::string& file, std::string_view text);
Sweep read_sweep(const std::string& file);

/// Returns the row of each parameter's value at a point.
/// @param point below `points()`
std::vector<std::size_t> rows_at(const Sweep& sweep, std::uint64_t point);

/// Returns the scenario of a job.
/// @param job below `jobs()`
/// @throws base::InputError for values that the scenario does not accept
Scenario scenario_of(const Sweep& sweep, std::uint64_t job);

/// Checks the scenario with each parameter's values (for numbers only the minimum and maximum), with all others at
/// their first value: keys, values, worlds, controllers and expectations. Needs no device. Other combinations are
/// checked by their jobs.
/// @return warnings of the first point's world
/// @throws base::InputError at the parameter's line
std::vector<world::Warning> check_sweep(const Sweep& sweep);

/// Returns a value as in a TOML file, but strings without quotes.
std::string parameter_value_text(const world::TomlNode& value);

}  // namespace sf::scenarios
