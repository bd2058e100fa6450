#pragma once
// Measurements of the thesis: tables 1 to 4 (M. Vernier, "Virtual Sensor System", Ohio State, 2010).

#include <array>
#include <span>
#include <string_view>

namespace sf::scenarios {

/// One row: mean, deviation, minimum and maximum of the error, then of its absolute value.
using ThesisRow = std::array<double, 8>;

struct ThesisTable {
  std::string_view experiment;  ///< name of the experiment in this project
  int number = 0;               ///< number of the table in the thesis
  std::string_view unit;        ///< "m" or "Gauss"
  std::array<ThesisRow, 3> trials;
};

/// Returns null for experiments without a table.
const ThesisTable* thesis_table(std::string_view experiment);

/// The headings of the eight columns.
inline constexpr std::array<std::string_view, 8> kColumns{"mean",     "std",     "min",     "max",
                                                          "abs_mean", "abs_std", "abs_min", "abs_max"};

}  // namespace sf::scenarios
