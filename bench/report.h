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

/// The heading of `row`s. @param rate the unit of the third column
std::string heading(std::string_view rate);
/// A method, its times [ms], `count` per second [M/s], and its ratios: without an end of line.
std::string row(const Timing& timing, double count);

/// Replaces the content of `file` by `text`. @throws base::InputError when it cannot be written
void write(const std::string& file, const std::string& text);

/// Writes scans.csv, ticks.csv, facts.csv and prices.csv into `folder`. Files of parts without measurements are kept.
/// @throws base::InputError when a file cannot be written
void write_csv(const Book& book, const std::string& folder);

/// The same as text.
std::string tables(const Book& book);

}  // namespace sf::bench
