// base/elementary.h and base/pose.h in kernels: the same operations in the same order, so the same bytes. Angles [rad]
// are finite and below 1e6, where the reduction by pi/2 is exact enough. Every local variable with arithmetic is
// `precise`, so no operation is fused (tests/robots/device/contraction_test.cpp).

#define SF_PI 3.141592653589793LF
#define SF_INFINITY packDouble2x32(uvec2(0u, 0x7ff00000u))

bool is_negative(double x) { return (unpackDouble2x32(x).y & 0x80000000u) != 0u; }
bool is_finite(double x) { return (unpackDouble2x32(x).y & 0x7ff00000u) != 0x7ff00000u; }
double with_sign(double size, double like) {
  const uvec2 words = unpackDouble2x32(size);
  return packDouble2x32(uvec2(words.x, (words.y & 0x7fffffffu) | (unpackDouble2x32(like).y & 0x80000000u)));
}

/// std::min, std::max and std::clamp.
double least(double a, double b) { return b < a ? b : a; }
double most(double a, double b) { return a < b ? b : a; }
double limited(double x, double low, double high) { return x < low ? low : (high < x ? high : x); }

/// Returns the nearest whole number to x, |x| < 2^51; of two, the even one.
double nearest64(double x) {
  precise double shifted = x + 6755399441055744.0LF;
  precise double whole = shifted - 6755399441055744.0LF;
  return whole;
}

/// std::ceil for 0 <= x < 2^51.
double ceil64(double x) {
  const double whole = nearest64(x);
  precise double next = whole + 1.0LF;
  return whole < x ? next : whole;
}

double polynomial64(double s, double c0, double c1, double c2, double c3, double c4, double c5, double c6, double c7) {
  precise double q = s * s;
  precise double low = (c0 + s * c1) + q * (c2 + s * c3);
  precise double sum = low + q * q * ((c4 + s * c5) + q * (c6 + s * c7));
  return sum;
}

/// Returns sine and cosine.
dvec2 sin_cos64(double angle) {
  precise double quarters = angle * (1.0LF / 1.5707963267948966LF);
  const double n = nearest64(quarters);
  precise double nearly = angle - n * 1.5707963267341256LF, part = n * 6.077100506303966e-11LF;
  precise double upper = nearly - part;
  precise double lower = ((nearly - upper) - part) - n * 2.0222662487959506e-21LF;
  precise double sum = upper + lower;
  precise double rest = (upper - sum) + lower;
  const double high = n == 0.0LF ? angle : sum, low = n == 0.0LF ? 0.0LF : rest;

  precise double s = high * high;
  const double odd = polynomial64(s, -1.0LF / 6.0LF, 1.0LF / 120.0LF, -1.0LF / 5040.0LF, 1.0LF / 362880.0LF,
                                  -1.0LF / 39916800.0LF, 1.0LF / 6227020800.0LF, -1.0LF / 1307674368000.0LF,
                                  1.0LF / 355687428096000.0LF);
  const double even = polynomial64(s, 1.0LF / 24.0LF, -1.0LF / 720.0LF, 1.0LF / 40320.0LF, -1.0LF / 3628800.0LF,
                                   1.0LF / 479001600.0LF, -1.0LF / 87178291200.0LF, 1.0LF / 20922789888000.0LF,
                                   -1.0LF / 6402373705728000.0LF);
  precise double sine = high + (high * s * odd + low * (1.0LF - 0.5LF * s));
  precise double half_s = 0.5LF * s;
  precise double least_cosine = 1.0LF - half_s;
  precise double cosine = least_cosine + (((1.0LF - least_cosine) - half_s) + (s * s * even - high * low));
  const int quadrant = int(n) & 3;
  const dvec2 turned = (quadrant & 1) == 0 ? dvec2(sine, cosine) : dvec2(cosine, sine);
  return dvec2(quadrant >= 2 ? -turned.x : turned.x, quadrant == 1 || quadrant == 2 ? -turned.y : turned.y);
}

/// Returns a - b of unevaluated sums.
dvec2 sum_difference(dvec2 a, dvec2 b) {
  precise double high = a.x - b.x;
  precise double low = ((a.x - high) - b.x) + (a.y - b.y);
  return dvec2(high, low);
}

/// base::atan2 of finite numbers.
double arc_tangent64(double y, double x) {
  const dvec2 arcs[5] = dvec2[5](dvec2(0.0LF, 0.0LF), dvec2(0.24497866312686414LF, 1.0698755618734451e-17LF), dvec2(0.4636476090008061LF, 2.2698777452961687e-17LF), dvec2(0.6435011087932844LF, 1.5834785051444286e-17LF), dvec2(0.7853981633974483LF, 3.061616997868383e-17LF));
  const double up = abs(y), along = abs(x);
  const bool steep = up > along;
  const double larger = steep ? up : along, smaller = steep ? along : up;
  precise double quotient = smaller / larger;
  const double tangent = larger == 0.0LF ? 0.0LF : smaller == larger ? 1.0LF : quotient;
  precise double quarters = 4.0LF * tangent;
  const double k = nearest64(quarters);
  precise double beyond = (quarters - k) / (4.0LF + k * tangent);
  const double t = k == 0.0LF ? tangent : beyond;
  precise double s = t * t;
  const dvec2 arc = arcs[int(k)];
  const double series = polynomial64(s, -1.0LF / 3.0LF, 1.0LF / 5.0LF, -1.0LF / 7.0LF, 1.0LF / 9.0LF, -1.0LF / 11.0LF,
                                     1.0LF / 13.0LF, -1.0LF / 15.0LF, 1.0LF / 17.0LF);
  precise double rest = t * s * series + arc.y;
  precise double high = arc.x + t;
  precise double low = ((arc.x - high) + t) + rest;
  dvec2 found = dvec2(high, low);
  if (steep) found = sum_difference(dvec2(1.5707963267948966LF, 6.123233995736766e-17LF), found);
  if (is_negative(x)) found = sum_difference(dvec2(3.141592653589793LF, 1.2246467991473532e-16LF), found);
  precise double angle = found.x + found.y;
  return with_sign(angle, y);
}

double sinc64(double x) {
  precise double series = 1.0LF - x * x / 6.0LF;
  precise double ratio = sin_cos64(x).x / x;
  return abs(x) < 1e-4LF ? series : ratio;
}

/// Returns angle - 2 pi n exactly, if the result is the remainder of the angle: the parts of 2 pi have 33 and 16 bits, and
/// the result has no more bits than the angle.
double without_turns(double angle, double n) {
  precise double rest = (angle - n * 6.2831853069365025LF) - n * 2.430837753308879e-10LF;
  return rest == 0.0LF ? with_sign(0.0LF, angle) : rest;
}

/// Returns the same heading in [-pi, pi], as std::remainder does. Of two, that after an even number of turns.
double wrap_angle64(double angle) {
  precise double turns = angle * 0.15915494309189535LF;
  const double n = nearest64(turns);
  const double rest = without_turns(angle, n);
  const bool is_odd = (int(n) & 1) != 0;
  precise double next = rest > 0.0LF ? n + 1.0LF : n - 1.0LF;
  const bool is_nearest = abs(rest) < SF_PI || (abs(rest) == SF_PI && !is_odd);
  return abs(angle) <= SF_PI ? angle : is_nearest ? rest : without_turns(angle, next);
}

/// Natural logarithm of a number from 2^-1022 on.
double log64(double x) {
  const uvec2 words = unpackDouble2x32(x);
  const uint fraction = words.y & 0xFFFFFu;
  const bool is_upper = fraction > 0x6a09eu || (fraction == 0x6a09eu && words.x > 0x667f3bcdu);  // than the root of 2
  const double part = packDouble2x32(uvec2(words.x, fraction | (is_upper ? 1022u : 1023u) << 20));
  const double n = double(int(words.y >> 20) - (is_upper ? 1022 : 1023));
  precise double f = part - 1.0LF;
  precise double t = f / (2.0LF + f), s = t * t, q = s * s;
  precise double a = 1.0LF / 3.0LF + s * (1.0LF / 5.0LF), b = 1.0LF / 7.0LF + s * (1.0LF / 9.0LF);
  precise double c = 1.0LF / 11.0LF + s * (1.0LF / 13.0LF), d = 1.0LF / 15.0LF + s * (1.0LF / 17.0LF);
  precise double e = 1.0LF / 19.0LF + s * (1.0LF / 21.0LF);
  precise double series = s * ((a + q * b) + q * q * ((c + q * d) + q * q * e));
  precise double log_x = n * 0.6931471805598903LF + (f - (t * (f - 2.0LF * series) - n * 5.497923018708371e-14LF));
  return log_x;
}
