#pragma once
// The table of a sweep's jobs, read back.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sf::scenarios {

/// A point with the results of its seeds.
struct SweepPoint {
  std::vector<std::string> values;           ///< by parameter, as texts
  std::vector<std::string> status;           ///< by job: "pass", "missed", "none", "failed" or "missing"
  std::vector<std::vector<double>> metrics;  ///< by metric, then by job; NaN: empty
};

struct SweepJobs {
  std::vector<std::string> parameters, metrics;
  std::vector<SweepPoint> points;
};

/// @param file name for errors
/// @throws base::InputError with file and line where the text is no table of `csv_of_jobs` (scenarios/sweep_tables.h)
SweepJobs read_sweep_jobs(const std::string& file, std::string_view text);

}  // namespace sf::scenarios
