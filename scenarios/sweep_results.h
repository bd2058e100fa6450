#pragma once
// Results of a sweep's jobs: a folder with a file for each job. A file appears whole or not at all, so that a killed
// sweep goes on with what is missing, and machines that share the folder need no other agreement.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/runner.h"
#include "scenarios/sweep.h"

namespace sf::scenarios {

enum class JobStatus : std::uint8_t {
  passed,           ///< all expectations were met
  missed,           ///< one was not
  no_expectations,  ///< the scenario has none
  failed            ///< it could not run, or its process died
};
std::string_view word_of(JobStatus status);  ///< "pass", "missed", "none", "failed"

struct JobResult {
  JobStatus status = JobStatus::failed;
  std::string message;          ///< one line: the expectations that were missed, or the failure; else empty
  double simulated = 0.0;       ///< [s]
  std::uint64_t hash = 0;       ///< of all readings
  std::vector<Metric> metrics;  ///< none of a failed job
};
JobResult job_result_of(const ScenarioResult& result);

/// Replaces a file in one step: a reader sees the old content or the new one.
/// @throws base::InputError with the path on failure
void write_whole(const std::string& path, std::string_view text);

/// The folder of one sweep. Safe for many processes at once.
class SweepFolder {
 public:
  /// Makes the folder where there is none.
  /// @throws base::InputError when it has the results of another sweep or cannot be written
  SweepFolder(const Sweep& sweep, std::string path);

  const std::string& path() const { return path_; }
  std::string file(std::string_view name) const;
  void write(std::uint64_t job, const JobResult& result) const;
  /// Empty for a job without a result, or with a file that is not a whole result.
  std::optional<JobResult> read(std::uint64_t job) const;

 private:
  std::string job_file(std::uint64_t job) const;
  std::string path_;
};

}  // namespace sf::scenarios
