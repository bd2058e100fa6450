#pragma once
// Sensors that are due between two ticks: each is read at its own time, with everyone on the way.

#include <cstdint>
#include <span>
#include <vector>

#include "farm/farm.h"
#include "robots/kinematics.h"

namespace sf::scenarios {

/// Lets the farm sample at every time before that of `after` at which a heard sensor is due, and gives `take` what is
/// delivered at each: spans that live for the call.
/// @param before, after one per mover: at the last tick, where the farm has looked, and at the next
/// @param memory kept from tick to tick for its capacity
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
