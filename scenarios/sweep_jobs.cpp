#include "scenarios/sweep_jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/number_text.h"

namespace sf::scenarios {

namespace {

/// Returns the fields of the first row of `text` and removes it; quoted fields may contain commas and line ends.
std::vector<std::string> cut_row(std::string_view& text) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  std::size_t at = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted && c == '"' && at + 1 < text.size() && text[at + 1] == '"')
      fields.back() += text[at++];
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && c == ',')
      fields.emplace_back();
    else if (!quoted && c == '\n')
      break;
    else if (quoted || c != '\r')
      fields.back() += c;
  }
  text.remove_prefix(std::min(at + 1, text.size()));
  return fields;
}

/// Columns of the table: `job,point,PARAMETERS,seed,status,METRICS,simulated_s,hash,message`.
struct JobColumns {
  std::size_t seed = 0, last = 0;  ///< row of "seed", and of "simulated_s"
};

bool find_columns(const std::vector<std::string>& head, JobColumns& columns) {
  if (head.size() < 7 || head[0] != "job" || head[1] != "point" || head[head.size() - 3] != "simulated_s") return false;
  columns.last = head.size() - 3;
  for (std::size_t i = 2; i + 1 < columns.last; ++i)
    if (head[i] == "seed" && head[i + 1] == "status") columns.seed = i;  // last match: a parameter may be named so
  return columns.seed > 0;
}

bool read_metric(const std::string& text, double& value) {
  value = std::numeric_limits<double>::quiet_NaN();
  if (text.empty()) return true;
  const std::optional<double> read = base::number_of<double>(text);
  value = read.value_or(value);
  return read.has_value();
}

}  // namespace

SweepJobs read_sweep_jobs(const std::string& file, std::string_view text) {
  const std::vector<std::string> head = cut_row(text);
  JobColumns columns;
  if (!find_columns(head, columns))
    throw base::InputError(file, 1,
                           "is not a sweep's table of jobs; expected job,point,PARAMETERS,seed,status,METRICS,...");
  const auto part = [&](std::size_t from, std::size_t to) {
    return std::vector<std::string>(head.begin() + static_cast<std::ptrdiff_t>(from),
                                    head.begin() + static_cast<std::ptrdiff_t>(to));
  };
  SweepJobs jobs{part(2, columns.seed), part(columns.seed + 2, columns.last), {}};
  std::string last;
  for (int line = 2; !text.empty(); ++line) {
    const std::vector<std::string> row = cut_row(text);
    if (row.size() != head.size())
      throw base::InputError(file, line, fmt::format("has {} fields; expected {}", row.size(), head.size()));
    if (jobs.points.empty() || row[1] != last) {
      last = row[1];
      SweepPoint& point = jobs.points.emplace_back();
      point.values.assign(row.begin() + 2, row.begin() + static_cast<std::ptrdiff_t>(columns.seed));
      point.metrics.resize(jobs.metrics.size());
    }
    SweepPoint& point = jobs.points.back();
    point.status.push_back(row[columns.seed + 1]);
    for (std::size_t k = 0; k < jobs.metrics.size(); ++k) {
      double value = 0.0;
      const std::string& field = row[columns.seed + 2 + k];
      if (!read_metric(field, value))
        throw base::InputError(file, line, fmt::format("'{}' of {} is not a number", field, jobs.metrics[k]));
      point.metrics[k].push_back(value);
    }
  }
  return jobs;
}

}  // namespace sf::scenarios
