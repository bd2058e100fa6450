#pragma once
// Small least-squares problems.

#include <array>
#include <cmath>
#include <cstddef>

namespace sf::vision {

template <std::size_t N>
using SquareMatrix = std::array<std::array<double, N>, N>;

/// Solves the symmetric system a x = b by Cholesky decomposition. Replaces b by x, and the lower half of `a`, the only
/// one that is read, by its factor. @return false if `a` is singular
template <std::size_t N>
bool solve(SquareMatrix<N>& a, std::array<double, N>& b) {
  for (std::size_t j = 0; j < N; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    if (!(a[j][j] > 1e-12)) return false;
    a[j][j] = std::sqrt(a[j][j]);
    for (std::size_t i = j + 1; i < N; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (std::size_t i = N; i-- > 0;) {
    for (std::size_t k = i + 1; k < N; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return true;
}

}  // namespace sf::vision
