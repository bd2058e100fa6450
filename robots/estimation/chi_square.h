#pragma once
// The chi-square distribution, for gates and consistency tests.

namespace sf::estimation {

/// Probability that a chi-square variable of `degrees` >= 1 degrees of freedom exceeds `x` >= 0. Error below 1e-10 up
/// to 1e5 degrees.
double chi_square_tail(int degrees, double x);

/// The x whose tail is `probability` in (0, 1).
double chi_square_limit(int degrees, double probability);

}  // namespace sf::estimation
