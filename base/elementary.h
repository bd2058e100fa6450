#pragma once
// Elementary functions whose results are the same bytes on every processor and with every C library: sums, products,
// quotients and roots of doubles in a stated order, without fused operations. (Those of glibc differ in their last bit
// between processors with and without FMA.) Kernels that need them compute the same operations.
//
// Infinity and NaN give NaN where the real function has no value. Errors are in units in the last place (ulp) and were
// measured against Boost.Multiprecision (tests/base/elementary_test.cpp).

#include <cmath>

namespace sf::base {

struct SinCos {
  double sin = 0.0;
  double cos = 1.0;
};

/// Returns sine and cosine of an angle [rad], each within 0.9 ulp up to 100 rad, and within 4e-16 up to 1e12 rad.
SinCos sin_cos(double angle);

inline double sin(double angle) { return sin_cos(angle).sin; }
inline double cos(double angle) { return sin_cos(angle).cos; }

/// Returns sin(x)/x. Below the threshold, the next term of the series is less than half an ulp.
inline double sinc(double x) { return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : sin(x) / x; }

/// Within 2.5 ulp up to 100 rad.
inline double tan(double angle) {
  const SinCos s = sin_cos(angle);
  return s.sin / s.cos;
}

/// Returns the bearing of (x, y) in [-pi, pi] within 2 ulp. Signs of zeros count, as in C.
double atan2(double y, double x);

/// Within 2 ulp.
inline double atan(double x) { return atan2(x, 1.0); }

/// Within 3 ulp. NaN outside [-1, 1].
double asin(double x);
double acos(double x);

/// Within 1.1 ulp. Infinity above 709.78, 0 below -746.
double exp(double x);

/// Within 1 ulp. Of 0: minus infinity; of negative numbers: NaN.
double log(double x);

/// Returns the complementary error function within 1e-15 plus 2e-13 of its value.
double erfc(double x);

/// Returns sqrt(x x + y y) within 1.1 ulp, unless a square overflows (1e154) or is below 1e-290.
double hypot(double x, double y);
inline double hypot(double x, double y, double z) { return hypot(hypot(x, y), z); }

}  // namespace sf::base
