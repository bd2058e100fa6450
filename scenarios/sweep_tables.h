#pragma once
// Tables of a sweep: one row per job, and statistics over the seeds, one row per point.

#include <optional>
#include <span>
#include <string>

#include "scenarios/sweep_results.h"

namespace sf::scenarios {

/// Number of jobs by result.
struct JobCounts {
  std::uint64_t passed = 0, missed = 0, no_expectations = 0, failed = 0, missing = 0;
  std::uint64_t all() const { return passed + missed + no_expectations + failed + missing; }
  bool good() const { return missed + failed + missing == 0; }
};
using JobResults = std::span<const std::optional<JobResult>>;
JobCounts counts_of(JobResults results);
/// Returns "12 jobs: 10 pass, 1 missed, 1 failed", without the kinds that have no jobs.
std::string job_counts_text(const JobCounts& counts);

// The functions below take the results of all jobs in order; nullopt: a missing result. They do not depend on which
// process ran a job.

/// Returns the table `job,point,PARAMETERS,seed,status,METRICS,simulated_s,hash,message`.
std::string csv_of_jobs(const Sweep& sweep, JobResults results);
/// Returns the table `point,PARAMETERS,jobs,pass,missed,none,failed,missing`, with `_mean,_std,_min,_max` of each
/// metric over the seeds that have a value; the sample deviation is empty for a single one. Then follow
/// `met,met_low95,met_high95`, the fraction of the jobs that met their expectations, and `_n,_low95,_high95` of each
/// metric: the number of finite values, and the 95 % interval of their mean (of a proportion for a metric that is 0 or
/// 1).
std::string csv_of_points(const Sweep& sweep, JobResults results);
/// Returns the same table as Markdown.
/// @param most maximum number of rows; a note replaces further ones
std::string markdown_of_points(const Sweep& sweep, JobResults results, std::size_t most);

/// Returns "job 4: mean_error is inf" or "is empty": the results that means and intervals exclude, except metrics that
/// no job has, and failed and missing jobs.
/// @param most maximum number of lines; the last one gives the number of omitted lines
std::vector<std::string> missing_values(JobResults results, std::size_t most);

/// Writes jobs.csv, points.csv and report.md. @return their paths
std::vector<std::string> write_sweep_tables(const Sweep& sweep, const SweepFolder& folder, JobResults results);

}  // namespace sf::scenarios
