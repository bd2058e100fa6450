#pragma once
// The chi-square distribution, for gating and consistency tests.

namespace sf::estimation {

/// Returns the probability that a chi-square variable with `degrees` >= 1 degrees of freedom exceeds `x` >= 0. The
/// error is below 1e-10 for up to 1e5 degrees.
double chi_square_tail(int degrees, double x);

/// Returns the x whose tail probability is `probability`, in (0, 1).
double chi_square_limit(int degrees, double probability);

}  // namespace sf::estimation
