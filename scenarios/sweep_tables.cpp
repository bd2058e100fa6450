#include "scenarios/sweep_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/csv.h"
#include "base/hash.h"
#include "scenarios/experiment.h"
#include "scenarios/intervals.h"
#include "scenarios/statistics.h"

namespace sf::scenarios {

namespace {

/// In order of first appearance: jobs may have different expectations if these depend on a parameter.
std::vector<std::string> metric_names(JobResults results) {
  std::vector<std::string> names;
  for (const auto& result : results)
    if (result)
      for (const Metric& metric : result->metrics)
        if (std::find(names.begin(), names.end(), metric.name) == names.end()) names.push_back(metric.name);
  return names;
}

/// Returns NaN if there is none.
double value_of_metric(const JobResult& result, const std::string& name) {
  for (const Metric& metric : result.metrics)
    if (metric.name == name) return metric.value;
  return std::nan("");
}

std::string number_or_empty(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::vector<std::string> parameter_texts(const Sweep& sweep, std::uint64_t point) {
  const std::vector<std::size_t> rows = rows_at(sweep, point);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < rows.size(); ++i)
    texts.push_back(parameter_value_text(sweep.parameters[i].values[rows[i]]));
  return texts;
}

std::string csv_row(std::vector<std::string> fields) {
  for (std::string& field : fields) field = base::csv_field(field);
  return fmt::format("{}\n", fmt::join(fields, ","));
}

/// Replaces the characters that break a Markdown table.
std::string cell(std::string text) {
  std::replace(text.begin(), text.end(), '|', '/');
  return text;
}

JobResults of_point(const Sweep& sweep, JobResults results, std::uint64_t point) {
  return results.subspan(point * sweep.seeds.size(), sweep.seeds.size());
}

std::vector<double> values_over_seeds(JobResults results, const std::string& metric) {
  std::vector<double> values;
  for (const auto& result : results)
    if (result) values.push_back(value_of_metric(*result, metric));
  return values;
}

ErrorStatistics over_seeds(JobResults results, const std::string& metric) {
  return statistics_of(values_over_seeds(results, metric));
}

/// Interval of the jobs with expectations that met them; a failed one did not.
Interval met_interval(const JobCounts& counts) {
  return proportion_interval(counts.passed, counts.passed + counts.missed + counts.failed);
}

void add_ends(std::vector<std::string>& row, const Interval& interval) {
  row.push_back(number_or_empty(interval.low));
  row.push_back(number_or_empty(interval.high));
}

/// Returns "0.0341 ± 0.0012"; omits the deviation if there is none.
std::string mean_and_deviation(const ErrorStatistics& s) {
  if (s.count == 0) return "";
  return fmt::format("{:.4g}", s.mean) + (s.deviation > 0.0 ? fmt::format(" ± {:.2g}", s.deviation) : "");
}

/// Returns the metrics that have a value in some job.
std::vector<std::string> measured_names(JobResults results) {
  std::vector<std::string> names = metric_names(results);
  names.erase(std::remove_if(names.begin(), names.end(),
                             [&](const std::string& name) { return over_seeds(results, name).count == 0; }),
              names.end());
  return names;
}

std::string seeds_text(const Sweep& sweep) {
  return sweep.seeds.size() > 10
             ? fmt::format("{}, ... ({} in all)", fmt::join(sweep.seeds.begin(), sweep.seeds.begin() + 10, ", "),
                           sweep.seeds.size())
             : fmt::format("{}", fmt::join(sweep.seeds, ", "));
}

}  // namespace

JobCounts counts_of(JobResults results) {
  JobCounts counts;
  for (const auto& result : results) {
    if (!result)
      ++counts.missing;
    else if (result->status == JobStatus::passed)
      ++counts.passed;
    else if (result->status == JobStatus::missed)
      ++counts.missed;
    else if (result->status == JobStatus::no_expectations)
      ++counts.no_expectations;
    else
      ++counts.failed;
  }
  return counts;
}

std::string job_counts_text(const JobCounts& counts) {
  const std::pair<std::uint64_t, const char*> kinds[] = {{counts.passed, "pass"},
                                                         {counts.missed, "missed"},
                                                         {counts.no_expectations, "without expectations"},
                                                         {counts.failed, "failed"},
                                                         {counts.missing, "missing"}};
  std::vector<std::string> texts;
  for (const auto& [count, word] : kinds)
    if (count > 0) texts.push_back(fmt::format("{} {}", count, word));
  return fmt::format("{}: {}", counted(counts.all(), "job"), fmt::join(texts, ", "));
}

std::string csv_of_jobs(const Sweep& sweep, JobResults results) {
  const std::vector<std::string> metrics = metric_names(results);
  std::vector<std::string> head{"job", "point"};
  for (const SweepParameter& parameter : sweep.parameters) head.push_back(parameter.name);
  head.insert(head.end(), {"seed", "status"});
  head.insert(head.end(), metrics.begin(), metrics.end());
  head.insert(head.end(), {"simulated_s", "hash", "message"});
  std::string text = csv_row(head);
  for (std::uint64_t job = 0; job < results.size(); ++job) {
    const std::uint64_t point = job / sweep.seeds.size();
    std::vector<std::string> row{std::to_string(job), std::to_string(point)};
    for (std::string& value : parameter_texts(sweep, point)) row.push_back(std::move(value));
    row.push_back(std::to_string(sweep.seeds[job % sweep.seeds.size()]));
    const auto& result = results[job];
    const bool ran = result && result->status != JobStatus::failed;
    row.emplace_back(result ? word_of(result->status) : "missing");
    for (const std::string& name : metrics) row.push_back(ran ? number_or_empty(value_of_metric(*result, name)) : "");
    row.push_back(ran ? fmt::format("{}", result->simulated) : "");
    row.push_back(ran ? base::hash_hex(result->hash) : "");
    row.push_back(result ? result->message : "");
    text += csv_row(row);
  }
  return text;
}

std::string csv_of_points(const Sweep& sweep, JobResults results) {
  const std::vector<std::string> metrics = metric_names(results);
  std::vector<std::string> head{"point"};
  for (const SweepParameter& parameter : sweep.parameters) head.push_back(parameter.name);
  head.insert(head.end(), {"jobs", "pass", "missed", "none", "failed", "missing"});
  for (const std::string& name : metrics)
    for (const char* part : {"_mean", "_std", "_min", "_max"}) head.push_back(name + part);
  head.insert(head.end(), {"met", "met_low95", "met_high95"});
  for (const std::string& name : metrics)
    for (const char* part : {"_n", "_low95", "_high95"}) head.push_back(name + part);
  const bool expects = counts_of(results).passed + counts_of(results).missed > 0;
  std::string text = csv_row(head);
  for (std::uint64_t point = 0; point < sweep.points(); ++point) {
    const JobResults own = of_point(sweep, results, point);
    std::vector<std::string> row{std::to_string(point)};
    for (std::string& value : parameter_texts(sweep, point)) row.push_back(std::move(value));
    const JobCounts counts = counts_of(own);
    for (const std::uint64_t count :
         {counts.all(), counts.passed, counts.missed, counts.no_expectations, counts.failed, counts.missing})
      row.push_back(std::to_string(count));
    for (const std::string& name : metrics) {
      const ErrorStatistics s = over_seeds(own, name);
      for (const double value : {s.mean, s.deviation, s.least, s.most}) row.push_back(number_or_empty(value));
    }
    const Interval met = expects ? met_interval(counts) : proportion_interval(0, 0);
    row.push_back(number_or_empty(met.mean));
    add_ends(row, met);
    for (const std::string& name : metrics) {
      const Interval interval = metric_interval(name, values_over_seeds(own, name));
      row.push_back(std::to_string(interval.count));
      add_ends(row, interval);
    }
    text += csv_row(row);
  }
  return text;
}

std::string markdown_of_points(const Sweep& sweep, JobResults results, std::size_t most) {
  const std::vector<std::string> metrics = measured_names(results);
  std::vector<std::string> head{"point"};
  for (const SweepParameter& parameter : sweep.parameters) head.push_back(cell(parameter.name));
  head.insert(head.end(), {"pass", "missed", "failed", "missing"});
  for (const std::string& name : metrics) head.push_back(cell(name));
  std::string text = fmt::format("| {} |\n|", fmt::join(head, " | "));
  for (std::size_t i = 0; i < head.size(); ++i) text += "---|";
  text += "\n";
  for (std::uint64_t point = 0; point < std::min<std::uint64_t>(sweep.points(), most); ++point) {
    const JobResults own = of_point(sweep, results, point);
    const JobCounts counts = counts_of(own);
    std::vector<std::string> row{std::to_string(point)};
    for (const std::string& value : parameter_texts(sweep, point)) row.push_back(cell(value));
    for (const std::uint64_t count : {counts.passed, counts.missed, counts.failed, counts.missing})
      row.push_back(std::to_string(count));
    for (const std::string& name : metrics) row.push_back(mean_and_deviation(over_seeds(own, name)));
    text += fmt::format("| {} |\n", fmt::join(row, " | "));
  }
  if (sweep.points() > most)
    text += fmt::format("\nMore in points.csv: {}.\n", counted(sweep.points() - most, "point"));
  return text;
}

std::vector<std::string> missing_values(JobResults results, std::size_t most) {
  std::vector<std::string> lines;
  std::size_t count = 0;
  for (const std::string& name : measured_names(results))
    for (std::size_t job = 0; job < results.size(); ++job) {
      if (!results[job] || results[job]->status == JobStatus::failed) continue;
      const double value = value_of_metric(*results[job], name);
      if (std::isfinite(value) || ++count > most) continue;
      lines.push_back(fmt::format("job {}: {} is {}", job, name, std::isnan(value) ? "empty" : number_or_empty(value)));
    }
  if (count > most) lines.push_back(fmt::format("and {} more, in jobs.csv", count - most));
  return lines;
}

std::vector<std::string> write_sweep_tables(const Sweep& sweep, const SweepFolder& folder, JobResults results) {
  const std::string report = fmt::format(
      "# Sweep {}\n\n{} of {}, seeds {}. {}. Values are means over the seeds, ± the standard deviation of a "
      "sample. points.csv has 95 % intervals of the means.\n\n",
      sweep.name, counted(sweep.points(), "point"), std::filesystem::path(sweep.scenario).filename().string(),
      seeds_text(sweep), job_counts_text(counts_of(results)));
  std::vector<std::string> files{folder.file("jobs.csv"), folder.file("points.csv"), folder.file("report.md")};
  write_whole(files[0], csv_of_jobs(sweep, results));
  write_whole(files[1], csv_of_points(sweep, results));
  std::string missing;
  for (const std::string& line : missing_values(results, 1000)) missing += "- " + line + "\n";
  if (!missing.empty())
    missing = "\nResults that are not finite numbers, which means and intervals exclude:\n\n" + missing;
  write_whole(files[2], report + markdown_of_points(sweep, results, 1000) + missing);
  return files;
}

}  // namespace sf::scenarios
