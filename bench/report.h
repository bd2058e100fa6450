#pragma once
// Results as CSV files and as text tables.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/comparison.h"
#include "bench/measurements.h"
#include "bench/tick_benchmark.h"

namespace sf::bench {

/// One result: rows of a CSV file, and the same as text.
struct Report {
  std::string file;     ///< name without folder and ending; reports with the same name share a file
  std::string title;    ///< above the texts of a file; may be empty
  std::string columns;  ///< first line of the file, without a line end
  std::string rows = {};
  std::string text = {};
  std::vector<std::pair<std::string, double>> counters = {};  ///< shown by Google Benchmark
};

/// Adds one row per method, with its median wall time as a counter. @param csv, text return the row of a method
template <class Result, class Csv, class Text>
void add_methods(Report& report, const std::vector<Result>& results, Csv&& csv, Text&& text) {
  for (const Result& result : results) {
    report.rows += csv(result);
    report.text += text(result);
    report.counters.emplace_back(result.method + " [ms]", 1e3 * result.typical.wall_s);
  }
}

/// Returns the heading for `row`s. @param rate unit of the third column
std::string heading(std::string_view rate);
/// Returns a method, its times [ms], `count` per second [M/s], and its ratios, without a line end.
std::string row(const Timing& timing, double count);

Report scan_report(const Comparison& comparison);
Report tick_report(const TickResult& result);
/// @param file "facts" or "prices"
Report measurement_report(const std::string& file, const std::vector<Measurement>& measurements);

/// Writes the files of all reports into `folder`. Keeps the old files of parts without measurements.
/// @throws base::InputError if a file cannot be written
void write_csv(const std::vector<Report>& reports, const std::string& folder);

/// Returns the texts of all reports, by file.
std::string tables(const std::vector<Report>& reports);

}  // namespace sf::bench
