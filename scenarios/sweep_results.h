#pragma once
// Results of a sweep's jobs: a folder with a file for each job. A file appears complete or not at all, so a killed
// sweep continues with the missing jobs, and machines that share the folder need no other synchronisation.

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
  missed,           ///< at least one was missed
  no_expectations,  ///< the scenario has none
  failed            ///< it could not run, or its process crashed
};
std::string_view word_of(JobStatus status);  ///< "pass", "missed", "none", "failed"

struct JobResult {
  JobStatus status = JobStatus::failed;
  std::string message;          ///< one line: the missed expectations or the failure; else empty
  double simulated = 0.0;       ///< [s]
  std::uint64_t hash = 0;       ///< of all readings
  std::vector<Metric> metrics;  ///< empty for a failed job
};
JobResult job_result_of(const ScenarioResult& result);

/// Replaces a file atomically: a reader sees the old content or the new one.
/// @throws base::InputError with the path on failure
void write_whole(const std::string& path, std::string_view text);

/// The folder of one sweep. Safe for concurrent processes.
class SweepFolder {
 public:
  /// Creates the folder if missing.
  /// @throws base::InputError if it has the results of another sweep or cannot be written
  SweepFolder(const Sweep& sweep, std::string path);

  const std::string& path() const { return path_; }
  std::string file(std::string_view name) const;
  void write(std::uint64_t job, const JobResult& result) const;
  /// Returns nullopt for a job without a result, or with a file that is not a complete result.
  std::optional<JobResult> read(std::uint64_t job) const;

 private:
  std::string job_file(std::uint64_t job) const;
  std::string path_;
};

}  // namespace sf::scenarios
