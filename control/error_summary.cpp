#include "control/error_summary.h"

#include <cmath>

namespace sf::control {

void add(ErrorSummary& summary, double error) {
  if (!std::isfinite(error)) return;
  ++summary.steps;
  const auto steps = static_cast<double>(summary.steps);
  summary.mean += (error - summary.mean) / steps;
  summary.abs_mean += (std::abs(error) - summary.abs_mean) / steps;
}

}  // namespace sf::control
