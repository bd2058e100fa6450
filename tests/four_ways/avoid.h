#pragma once
// One way to drive, in C++: on where the middle third of the scan is free, else it turns. avoid.py has the same.

#include <algorithm>
#include <span>

#include <sensorfarm/types.h>

inline sensorfarm::Twist avoid(std::span<const double> ranges) {
  const std::size_t third = ranges.size() / 3;
  const double ahead = *std::min_element(ranges.begin() + third, ranges.end() - third);
  return ahead > 0.6 ? sensorfarm::Twist{0.25, 0.0, 0.0} : sensorfarm::Twist{0.0, 0.0, 1.0};
}
