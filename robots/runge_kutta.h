#pragma once
// Classical Runge-Kutta method of order four for states of a fixed number of components.

#include <array>
#include <cstddef>

namespace sf::robots {

/// Returns the state after one step of `dt` [s]. @param rate returns the derivative of a state
template <std::size_t kSize, class Rate>
std::array<double, kSize> runge_kutta(const std::array<double, kSize>& state, double dt, Rate&& rate) {
  const auto moved = [&](const std::array<double, kSize>& along, double by) {
    std::array<double, kSize> to = state;
    for (std::size_t k = 0; k < kSize; ++k) to[k] += by * along[k];
    return to;
  };
  const auto a = rate(state), b = rate(moved(a, 0.5 * dt)), c = rate(moved(b, 0.5 * dt)), d = rate(moved(c, dt));
  std::array<double, kSize> sum{};
  for (std::size_t k = 0; k < kSize; ++k) sum[k] = a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k];
  return moved(sum, dt / 6.0);
}

}  // namespace sf::robots
