#include "base/elementary.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sf::base {

namespace {

// Pi/2 in three parts: products of the first two with integers below 2^20 are exact.
constexpr double kHalfPi1 = 0x1.921fb544p+0, kHalfPi2 = 0x1.0b4611a6p-34, kHalfPi3 = 0x1.3198a2e037073p-69;
// The same number in two parts.
constexpr double kHalfPi = 0x1.921fb54442d18p+0, kHalfPiRest = 0x1.1a62633145c07p-54;
constexpr double kMostReduced = 1e6;  // [rad]

constexpr double kLn2High = 0x1.62e42fefa38p-1, kLn2Low = 0x1.ef35793c7673p-45;  // the first has 42 bits

/// Returns 2^n for n in -1022 to 1023.
double power_of_two(int n) { return std::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52); }

/// Returns the nearest whole number to x, |x| < 2^51; of two, the even one.
double nearest(double x) { return (x + 0x1.8p52) - 0x1.8p52; }

/// A number as an unevaluated sum.
struct Sum {
  double high, low;
};

/// Returns x - n pi/2 for an integer |n| < 2^20.
Sum reduced(double x, double n) {
  const double most = x - n * kHalfPi1, part = n * kHalfPi2;
  const double high = most - part;
  const double low = ((most - high) - part) - n * kHalfPi3;
  const double sum = high + low;
  return {sum, (high - sum) + low};
}

/// Returns a - b.
Sum difference(const Sum& a, const Sum& b) {
  const double high = a.high - b.high;
  return {high, ((a.high - high) - b.high) + (a.low - b.low)};
}

/// Returns c[0] + c[1] s + ... + c[7] s^7.
double polynomial(const double (&c)[8], double s) {
  const double q = s * s;
  const double low = (c[0] + s * c[1]) + q * (c[2] + s * c[3]);
  return low + q * q * ((c[4] + s * c[5]) + q * (c[6] + s * c[7]));
}

// Taylor's series for |r| <= pi/4 and tangents up to 1/8; the first terms left out are below 2^-58.
constexpr double kSine[] = {-1.0 / 6.0,
                            1.0 / 120.0,
                            -1.0 / 5'040.0,
                            1.0 / 362'880.0,
                            -1.0 / 39'916'800.0,
                            1.0 / 6'227'020'800.0,
                            -1.0 / 1'307'674'368'000.0,
                            1.0 / 355'687'428'096'000.0};
constexpr double kCosine[] = {1.0 / 24.0,
                              -1.0 / 720.0,
                              1.0 / 40'320.0,
                              -1.0 / 3'628'800.0,
                              1.0 / 479'001'600.0,
                              -1.0 / 87'178'291'200.0,
                              1.0 / 20'922'789'888'000.0,
                              -1.0 / 6'402'373'705'728'000.0};
constexpr double kArc[] = {-1.0 / 3.0,  1.0 / 5.0,  -1.0 / 7.0,  1.0 / 9.0,
                           -1.0 / 11.0, 1.0 / 13.0, -1.0 / 15.0, 1.0 / 17.0};

double sin_series(const Sum& r) {
  const double s = r.high * r.high;
  return r.high + (r.high * s * polynomial(kSine, s) + r.low * (1.0 - 0.5 * s));
}

double cos_series(const Sum& r) {
  const double s = r.high * r.high, half = 0.5 * s, most = 1.0 - half;
  return most + (((1.0 - most) - half) + (s * s * polynomial(kCosine, s) - r.high * r.low));
}

/// The arcs whose tangents are 0, 1/4, 1/2, 3/4 and 1.
constexpr Sum kArcs[] = {{0.0, 0.0},
                         {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                         {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                         {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                         {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};

/// Returns the arc of a tangent in [0, 1].
Sum arc_of(double tangent) {
  const double k = nearest(4.0 * tangent);  // the difference below is exact
  const double t = k == 0.0 ? tangent : (4.0 * tangent - k) / (4.0 + k * tangent);
  const double s = t * t;
  const Sum& arc = kArcs[static_cast<int>(k)];
  const double rest = t * s * polynomial(kArc, s) + arc.low;
  const double high = arc.high + t;
  return {high, ((arc.high - high) + t) + rest};
}

}  // namespace

SinCos sin_cos(double angle) {
  if (std::abs(angle) > kMostReduced) {
    // The remainder is exact; the second term is what 2 pi lacks.
    const double rest = std::remainder(angle, 4.0 * kHalfPi);
    const double turns = (angle - rest) / (4.0 * kHalfPi);
    angle = std::remainder(rest - turns * (4.0 * kHalfPiRest), 4.0 * kHalfPi);
  }
  const double n = nearest(angle * (1.0 / kHalfPi));
  const Sum r = n == 0.0 ? Sum{angle, 0.0} : reduced(angle, n);
  const double s = sin_series(r), c = cos_series(r);
  if (!(std::abs(angle) <= kMostReduced)) return {s, c};  // NaN
  switch (static_cast<int>(n) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double atan2(double y, double x) {
  const double up = std::abs(y), along = std::abs(x);
  if (!(up <= HUGE_VAL && along <= HUGE_VAL)) return std::numeric_limits<double>::quiet_NaN();
  const bool steep = up > along;
  const double most = steep ? up : along, least = steep ? along : up;
  const double tangent = most == 0.0 ? 0.0 : least == most ? 1.0 : least / most;
  Sum arc = arc_of(tangent);
  if (steep) arc = difference({kHalfPi, kHalfPiRest}, arc);
  if (std::signbit(x)) arc = difference({2.0 * kHalfPi, 2.0 * kHalfPiRest}, arc);
  return std::copysign(arc.high + arc.low, y);
}

double asin(double x) { return atan2(x, std::sqrt((1.0 - x) * (1.0 + x))); }

double acos(double x) { return atan2(std::sqrt((1.0 - x) * (1.0 + x)), x); }

double exp(double x) {
  if (!(std::abs(x) < 746.0)) return x > 0.0 ? HUGE_VAL : x < 0.0 ? 0.0 : x;
  const double n = nearest(x * (1.0 / 0x1.62e42fefa39efp-1));
  const double most = x - n * kLn2High, rest = n * kLn2Low;
  const double r = most - rest, low = (most - r) - rest;
  const double s = r * r, q = s * s;
  const double a = 1.0 / 2.0 + r * (1.0 / 6.0), b = 1.0 / 24.0 + r * (1.0 / 120.0);
  const double c = 1.0 / 720.0 + r * (1.0 / 5'040.0), d = 1.0 / 40'320.0 + r * (1.0 / 362'880.0);
  const double e = 1.0 / 3'628'800.0 + r * (1.0 / 39'916'800.0), f = 1.0 / 479'001'600.0 + r * (1.0 / 6'227'020'800.0);
  const double series = (a + s * b) + q * ((c + s * d) + q * (e + s * f));
  // In two steps, because 2^n alone overflows or vanishes at the ends.
  const int whole = static_cast<int>(n), first = whole / 2;
  return (1.0 + (r + (s * series + low))) * power_of_two(first) * power_of_two(whole - first);
}

double log(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -HUGE_VAL : std::numeric_limits<double>::quiet_NaN();
  if (x == HUGE_VAL) return x;
  constexpr std::uint64_t kFraction = (1ull << 52) - 1;
  constexpr std::uint64_t kRoot = 0x6a09e667f3bcdull;  // fraction of the root of 2
  const bool tiny = x < 0x1p-1022;                     // without an exponent of its own
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(tiny ? 0x1p54 * x : x);
  const bool upper = (bits & kFraction) > kRoot;
  const double part = std::bit_cast<double>((bits & kFraction) | (upper ? 1022ull : 1023ull) << 52);
  const int exponent = static_cast<int>(bits >> 52) - (upper ? 1022 : 1023) - (tiny ? 54 : 0);
  // log(1 + f) = 2 artanh(f / (2 + f))
  const double f = part - 1.0, t = f / (2.0 + f), s = t * t, q = s * s;
  const double a = 1.0 / 3.0 + s * (1.0 / 5.0), b = 1.0 / 7.0 + s * (1.0 / 9.0), c = 1.0 / 11.0 + s * (1.0 / 13.0);
  const double d = 1.0 / 15.0 + s * (1.0 / 17.0), e = 1.0 / 19.0 + s * (1.0 / 21.0);
  const double series = s * ((a + q * b) + q * q * ((c + q * d) + q * q * e));
  // 2 t = f - t f, which keeps f exact
  const double n = exponent;
  return n * kLn2High + (f - (t * (f - 2.0 * series) - n * kLn2Low));
}

double erfc(double x) {
  const double size = std::abs(x), square = x * x;
  double tail = 0.0;
  if (size < 2.0) {  // the series of erf, whose terms are positive
    double term = 2.0 / std::sqrt(M_PI) * size * exp(-square), sum = term;
    for (int n = 1; n < 60 && term > 1e-18; ++n) sum += term *= 2.0 * square / (2 * n + 1);
    tail = 1.0 - sum;
  } else {  // Laplace's continued fraction
    double fraction = size;
    for (int n = 60; n > 0; --n) fraction = size + 0.5 * n / fraction;
    tail = exp(-square) / (std::sqrt(M_PI) * fraction);
  }
  return std::signbit(x) ? 2.0 - tail : tail;
}

double hypot(double x, double y) { return std::sqrt(x * x + y * y); }

}  // namespace sf::base
