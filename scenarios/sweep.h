#pragma once
// A sweep: one scenario at the points of a grid or a sample of its keys, each point with several seeds. A TOML file;
// keys in docs/sweeps.md. Jobs are numbered with the seeds fastest and the file's first parameter slowest.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/scenario.h"
#include "world/toml.h"

namespace sf::scenarios {

/// Largest number of jobs of a sweep.
inline constexpr std::uint64_t kMostJobs = 1'000'000;

/// A key of the scenario's file, and its values.
struct SweepParameter {
  std::string name;                     ///< path of keys, such as "default.settings.kp" or "robot.NAME.rate"
  std::vector<world::TomlNode> values;  ///< at least one. Of a sampled parameter: one per point of the sample
  bool sampled = false;
  int line = 0;  ///< in the sweep's file
};

struct Sweep {
  std::string name;                        ///< default: the file's name without extension
  std::string file;                        ///< of the sweep
  std::string scenario;                    ///< path of the scenario's file
  world::TomlNode settings;                ///< content of the scenario's file
  std::vector<SweepParameter> parameters;  ///< those of the grid, then the sampled ones
  std::uint64_t samples = 1;               ///< points of the sample; 1 without one
  std::vector<std::uint64_t> seeds;        ///< at least one, all different
  std::uint64_t hash = 0;                  ///< of both files

  std::uint64_t points() const;
  std::uint64_t jobs() const { return points() * seeds.size(); }
};

/// @throws base::InputError with file and line, also for unknown keys and more than kMostJobs jobs
Sweep parse_sweep(const std::string& file, std::string_view text);
Sweep read_sweep(const std::string& file);

/// Row of each parameter's value at a point. @param point below `points()`
std::vector<std::size_t> rows_at(const Sweep& sweep, std::uint64_t point);

/// The scenario of a job.
/// @param job below `jobs()`
/// @throws base::InputError for values that the scenario does not take
Scenario scenario_of(const Sweep& sweep, std::uint64_t job);

/// Tries the scenario with each parameter's values (of numbers the least and the greatest), all others at their first:
/// keys, values, worlds, controllers and expectations. Needs no device. Other combinations are tried by their jobs.
/// @return warnings of the first point's world
/// @throws base::InputError at the parameter's line
std::vector<world::Warning> check_sweep(const Sweep& sweep);

/// A value as in a TOML file; texts without quotes.
std::string text_of(const world::TomlNode& value);

}  // namespace sf::scenarios
