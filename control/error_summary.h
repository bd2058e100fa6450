#pragma once
// Statistics of a controller's error over a run.

#include <cstdint>

namespace sf::control {

/// Means, in the controller's own unit.
struct ErrorSummary {
  std::uint64_t steps = 0;  ///< number of steps with an error
  double mean = 0.0;
  double abs_mean = 0.0;
};

/// Adds one step. Ignores NaN and infinity.
void add(ErrorSummary& summary, double error);

}  // namespace sf::control
