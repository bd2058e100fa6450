#pragma once
// Names of the numbers in the columns of readings.

#include <cstdint>
#include <string>

namespace sf::base {

/// Returns the name of number `k` of a column, as in CSV files and for faults: "range_m", "vector_T_x".
template <class Column>
std::string number_name(const Column& column, std::uint32_t k) {
  if (column.width == 1) return std::string(column.name);
  return std::string(column.name) + '_' + (column.width <= 3 ? std::string(1, "xyz"[k]) : std::to_string(k));
}

}  // namespace sf::base
