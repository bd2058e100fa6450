#pragma once
// Parser for the table of a sweep's jobs.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sf::scenarios {

/// A point and the results of its seeds.
struct SweepPoint {
  std::vector<std::string> values;           ///< as text, by parameter
  std::vector<std::string> status;           ///< by job: "pass", "missed", "none", "failed" or "missing"
  std::vector<std::vector<double>> metrics;  ///< by metric, then by job; NaN: empty
};

struct SweepJobs {
  std::vector<std::string> parameters, metrics;
  std::vector<SweepPoint> points;
};

/// @param file name for errors
/// @throws base::InputError with file and line if the text is not a table of `csv_of_jobs` (scenarios/sweep_tables.h)
SweepJobs read_sweep_jobs(const std::string& file, std::string_view text);

}  // namespace sf::scenarios
