#pragma once
// Results as files for later and as tables for now.

#include <string>
#include <vector>

#include "bench/comparison.h"
#include "bench/measurements.h"
#include "bench/tick_benchmark.h"

namespace sf::bench {

/// All that was measured.
struct Book {
  std::vector<Comparison> contests;
  std::vector<TickResult> drives;
  std::vector<Measurement> facts;
  std::vector<Measurement> prices;
};

/// Writes `text` to `file`, in place of what it held. @throws base::InputError when it cannot be written.
void write(const std::string& file, const std::string& text);

/// Writes scans.csv, ticks.csv, facts.csv and prices.csv into `folder`; a part of which nothing was measured keeps its
/// old file.
/// @throws base::InputError when a file cannot be written.
void write_csv(const Book& book, const std::string& folder);

/// The same as text for people.
std::string tables(const Book& book);

}  // namespace sf::bench
