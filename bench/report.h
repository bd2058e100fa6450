#pragma once
// Results as CSV files and as text tables.

#include <string>
#include <vector>

#include "bench/comparison.h"
#include "bench/measurements.h"
#include "bench/tick_benchmark.h"

namespace sf::bench {

/// All results.
struct Book {
  std::vector<Comparison> contests;
  std::vector<TickResult> drives;
  std::vector<Measurement> facts;
  std::vector<Measurement> prices;
};

/// Replaces the content of `file` by `text`. @throws base::InputError when it cannot be written
void write(const std::string& file, const std::string& text);

/// Writes scans.csv, ticks.csv, facts.csv and prices.csv into `folder`. Files of parts without measurements are kept.
/// @throws base::InputError when a file cannot be written
void write_csv(const Book& book, const std::string& folder);

/// The same as text.
std::string tables(const Book& book);

}  // namespace sf::bench
