#pragma once
// Results as CSV files and as text tables.

#include <string>
#include <string_view>
#include <vector>

#include "bench/comparison.h"
#include "bench/measurements.h"
#include "bench/tick_benchmark.h"

namespace sf::bench {

/// All results.
struct Book {
  std::vector<Comparison> scans;
  std::vector<TickResult> ticks;
  std::vector<Measurement> facts;
  std::vector<Measurement> prices;
};

/// Returns the heading for `row`s. @param rate unit of the third column
std::string heading(std::string_view rate);
/// Returns a method, its times [ms], `count` per second [M/s], and its ratios, without a line end.
std::string row(const Timing& timing, double count);

/// Replaces the content of `file` by `text`. @throws base::InputError if it cannot be written
void write(const std::string& file, const std::string& text);

/// Writes scans.csv, ticks.csv, facts.csv and prices.csv into `folder`. Keeps the old files of parts without
/// measurements.
/// @throws base::InputError if a file cannot be written
void write_csv(const Book& book, const std::string& folder);

/// Returns the same as text.
std::string tables(const Book& book);

}  // namespace sf::bench
