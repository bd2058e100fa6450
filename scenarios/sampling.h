#pragma once
// Sensors that are due between two ticks are sampled at their own times, with interpolated reports.

#include <cstdint>
#include <span>
#include <vector>

#include "farm/farm.h"
#include "robots/kinematics.h"

namespace sf::scenarios {

/// Samples the farm at every due time before that of `after`, and passes the readings delivered at each to `take`.
/// Spans live for the call.
/// @param before, after one report per mover: at the last tick, which the farm has computed, and at the next
/// @param memory reused between calls for its capacity
template <class Take>
void sample_between(farm::Farm& farm, std::span<const base::Report> before, std::span<const base::Report> after,
                    std::vector<base::Report>& memory, Take&& take) {
  if (after.empty()) return;
  for (std::int64_t due = farm.next_due(); due < after[0].time; due = farm.next_due()) {
    memory.clear();
    for (std::size_t row = 0; row < after.size(); ++row)
      memory.push_back(robots::interpolate(before[row], after[row], due));
    take(farm.sample(due, memory));
  }
}

}  // namespace sf::scenarios
