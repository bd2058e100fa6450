#pragma once
// What the thesis measured: tables 1 to 4 (M. Vernier, "Virtual Sensor System", Ohio State, 2010).

#include <array>
#include <span>
#include <string_view>

namespace sf::scenarios {

/// One row: mean, deviation, least, most of the error, and of its absolute value.
using ThesisRow = std::array<double, 8>;

struct ThesisTable {
  std::string_view experiment;  ///< its name here
  int number = 0;               ///< in the thesis
  std::string_view unit;        ///< "m" or "Gauss"
  std::array<ThesisRow, 3> trials;
};

/// Null for experiments that have none.
const ThesisTable* thesis_table(std::string_view experiment);

/// The headings of the eight columns.
inline constexpr std::array<std::string_view, 8> kColumns{"mean",     "std",     "min",     "max",
                                                          "abs_mean", "abs_std", "abs_min", "abs_max"};

}  // namespace sf::scenarios
