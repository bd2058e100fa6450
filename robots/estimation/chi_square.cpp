#include "robots/estimation/chi_square.h"

#include <cmath>

#include "base/elementary.h"

namespace sf::estimation {

// Q(k + 2, x) = Q(k, x) + (x/2)^(k/2) e^(-x/2) / Gamma(k/2 + 1), from Q(1, x) = erfc(sqrt(x/2)) and Q(2, x) = e^(-x/2):
// Abramowitz and Stegun, 26.4.8.
double chi_square_tail(int degrees, double x) {
  if (x <= 0.0) return 1.0;
  const double half = 0.5 * x;
  int k = degrees % 2 == 1 ? 1 : 2;
  double tail = k == 1 ? base::erfc(std::sqrt(half)) : base::exp(-half);
  // Accumulates the logarithm, since a term may underflow where later terms do not.
  double log_term = 0.5 * k * base::log(half) - half - base::log(k == 1 ? 0.5 * std::sqrt(M_PI) : 1.0);
  for (; k < degrees; k += 2) {
    tail += base::exp(log_term);
    log_term += base::log(half / (0.5 * k + 1.0));
  }
  return tail;
}

double chi_square_limit(int degrees, double probability) {
  double low = 0.0;
  double high = degrees;
  while (chi_square_tail(degrees, high) > probability) high *= 2.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (chi_square_tail(degrees, middle) > probability ? low : high) = middle;
  }
  return high;
}

}  // namespace sf::estimation
