// Selection of accuracy modes for a user's target.

#include <algorithm>
#include <utility>

#include "scenarios/tradeoff.h"

namespace sf::scenarios {

namespace {

double judged(const ModeResult& grade, ErrorMeasure by) {
  return by == ErrorMeasure::median ? grade.median : by == ErrorMeasure::p99 ? grade.p99 : grade.max;
}

double allowed(const ModeResult& grade, const AccuracyTarget& target) {
  return grade.unit == "T" ? target.tesla : target.metres;
}

/// Returns rows of `results` by sensor type, in order.
std::vector<std::vector<std::size_t>> by_type(const std::vector<ModeResult>& results) {
  std::vector<std::vector<std::size_t>> types;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (i == 0 || results[i].sensor != results[i - 1].sensor) types.emplace_back();
    types.back().push_back(i);
  }
  return types;
}

/// Returns the fastest mode within the error limit; `exact`, the first row, always qualifies.
std::size_t fastest_within(const std::vector<ModeResult>& results, const std::vector<std::size_t>& rows,
                           const AccuracyTarget& target) {
  std::size_t best = rows.front();
  for (const std::size_t row : rows) {
    const ModeResult& grade = results[row];
    if (judged(grade, target.by) <= allowed(grade, target) && grade.rate > results[best].rate &&
        !is_pointless(grade, results[rows.front()]))
      best = row;
  }
  return best;
}

/// Returns the number of modes of its sensor type with smaller errors.
std::size_t rank_of(const std::vector<ModeResult>& results, const std::vector<std::size_t>& rows, std::size_t row,
                    ErrorMeasure by) {
  return static_cast<std::size_t>(std::count_if(rows.begin(), rows.end(), [&](std::size_t other) {
    return judged(results[other], by) < judged(results[row], by);
  }));
}

/// A combination of modes: total duration of its ticks over all sensor types, and sum of its ranks.
struct Choice {
  std::vector<std::size_t> rows;
  double tick = 0.0;      ///< [s]
  std::size_t ranks = 0;  ///< sum over types
};

/// Returns the most accurate combination that is fast enough, else the fastest one. Tries all combinations, at most a
/// few hundred.
std::vector<std::size_t> most_accurate(const std::vector<ModeResult>& results,
                                       const std::vector<std::vector<std::size_t>>& types,
                                       const AccuracyTarget& target) {
  std::vector<Choice> choices(1);
  for (const auto& rows : types) {
    std::vector<Choice> longer;
    for (const Choice& choice : choices)
      for (const std::size_t row : rows) {
        if (is_pointless(results[row], results[rows.front()])) continue;
        Choice& next = longer.emplace_back(choice);
        next.rows.push_back(row);
        next.tick += results[row].tick;
        next.ranks += rank_of(results, rows, row, target.by);
      }
    choices = std::move(longer);
  }
  const double most = 1.0 / target.least_rate;
  const auto better = [most](const Choice& a, const Choice& b) {
    const bool a_keeps = a.tick <= most, b_keeps = b.tick <= most;
    if (a_keeps != b_keeps) return a_keeps;
    return a_keeps && a.ranks != b.ranks ? a.ranks < b.ranks : a.tick < b.tick;
  };
  return std::min_element(choices.begin(), choices.end(), better)->rows;
}

}  // namespace

std::vector<std::size_t> select_modes(const std::vector<ModeResult>& results, const AccuracyTarget& target) {
  const auto types = by_type(results);
  std::vector<std::size_t> chosen;
  for (const auto& rows : types) chosen.push_back(fastest_within(results, rows, target));
  if (target.least_rate > 0.0) chosen = most_accurate(results, types, target);
  return chosen;
}

std::string accuracy_words(const std::vector<ModeResult>& results, const std::vector<std::size_t>& rows) {
  std::string words;
  for (const std::size_t row : rows)
    if (results[row].mode != "exact")
      words += (words.empty() ? "" : " ") + results[row].sensor + ":" + results[row].mode;
  return words.empty() ? "exact" : words;
}

}  // namespace sf::scenarios
