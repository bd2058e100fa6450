#include "scenarios/path_report.h"

#include <fmt/format.h>

#include <vector>

namespace sf::scenarios {

namespace {

std::string line_of(const std::string& who, const ThesisRow& row) {
  std::string text = "| " + who;
  for (const double value : row) text += fmt::format(" | {:.3f}", value);
  return text + " |\n";
}

}  // namespace

ThesisRow row_of(const ErrorStatistics& s) {
  return {s.mean, s.deviation, s.least, s.most, s.abs_mean, s.abs_deviation, s.abs_least, s.abs_most};
}

ThesisRow mean_of(std::span<const ThesisRow> rows) {
  ThesisRow mean{};
  for (const ThesisRow& row : rows)
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += row[i] / static_cast<double>(rows.size());
  return mean;
}

std::string csv_of(std::span<const ErrorStatistics> trials) {
  std::string text = fmt::format("trial,{}\n", fmt::join(kColumns, ","));
  for (std::size_t k = 0; k < trials.size(); ++k)
    text += fmt::format("{},{:.9g}\n", k + 1, fmt::join(row_of(trials[k]), ","));
  return text;
}

std::string table_of(std::span<const ErrorStatistics> trials, const ThesisTable& table) {
  std::string text = fmt::format("| [{}] | {} |\n|---", table.unit, fmt::join(kColumns, " | "));
  for (std::size_t i = 0; i < kColumns.size(); ++i) text += "|---";
  text += "|\n";
  std::vector<ThesisRow> ours;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    ours.push_back(row_of(trials[k]));
    text += line_of(fmt::format("here, trial {}", k + 1), ours.back());
  }
  for (std::size_t k = 0; k < table.trials.size(); ++k)
    text += line_of(fmt::format("thesis, trial {}", k + 1), table.trials[k]);
  const ThesisRow mean = mean_of(ours);
  const ThesisRow theirs = mean_of(table.trials);
  text += line_of("**here, mean**", mean) + line_of("**thesis, mean**", theirs);
  text += "| ratio";
  for (std::size_t i = 0; i < mean.size(); ++i)
    text += theirs[i] == 0.0 ? " | -" : fmt::format(" | {:.2f}", mean[i] / theirs[i]);
  return text + " |\n";
}

}  // namespace sf::scenarios
