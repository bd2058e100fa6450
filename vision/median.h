#pragma once
// Medians.

#include <algorithm>
#include <vector>

namespace sf::vision {

/// Returns the median, or the upper of the two middle values. @param values not empty; reordered
inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace sf::vision
