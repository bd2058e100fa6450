#ifndef SENSORS_LANE_MARKINGS_LINE_FIT_H
#define SENSORS_LANE_MARKINGS_LINE_FIT_H
// Fits a line to a scan's points by total least squares, which is valid for any direction, and a parabola that measures
// how straight the points are. Compiled by both compilers, so that host and device compute equal results.
//
// K. Pearson, "On lines and planes of closest fit to systems of points in space", Phil. Mag. 2 (1901): the line through
// the centroid along the larger principal axis. Constants are exact in 32 bits because GLSL parses them as such.

#ifdef __cplusplus
#include <cmath>
#include <cstdint>
#define SF_REAL double
#define SF_REAL32 float
#define SF_INOUT(Type) Type&
#define SF_INLINE static inline
namespace sf::sensors::fit {
using std::sqrt;
using uint = std::uint32_t;
#else
#define SF_REAL precise double
#define SF_REAL32 precise float
#define SF_INOUT(Type) inout Type
#define SF_INLINE
#endif

/// Sums over points. The weight w is 1 for a point in the set and 0 for others.
struct Moments {
  double n, x, y, xx, xy, yy;
};

SF_INLINE void add_point(SF_INOUT(Moments) m, double w, double x, double y) {
  SF_REAL wx = w * x;
  SF_REAL wy = w * y;
  SF_REAL xx = m.xx + wx * x;
  SF_REAL xy = m.xy + wx * y;
  SF_REAL yy = m.yy + wy * y;
  m.n = m.n + w;
  m.x = m.x + wx;
  m.y = m.y + wy;
  m.xx = xx;
  m.xy = xy;
  m.yy = yy;
}

/// Point p, unit direction t, and the normal n: (-ty, tx) or its opposite, whichever points away from the sensor.
struct Line {
  double px, py, tx, ty, nx, ny;
  double spread;  // [m^2] variance of the points along the line; 0: no line
};

SF_INLINE Line facing(double px, double py, double tx, double ty, double spread) {
  SF_REAL away = tx * py - ty * px;
  const double side = away < 0.0 ? -1.0 : 1.0;
  const Line line = {px, py, tx, ty, -side * ty, side * tx, spread};
  return line;
}

/// Points closer together than about 1e-7 of their distance define no line.
SF_INLINE Line line_through(Moments m) {
  const double n = m.n > 0.0 ? m.n : 1.0;
  SF_REAL px = m.x / n;
  SF_REAL py = m.y / n;
  SF_REAL xx = m.xx - m.x * px;
  SF_REAL xy = m.xy - m.x * py;
  SF_REAL yy = m.yy - m.y * py;
  SF_REAL difference = xx - yy;
  SF_REAL cross = xy + xy;
  SF_REAL size = sqrt(difference * difference + cross * cross);
  // Half the angle of (difference, cross), without trigonometry.
  const double sign_of_cross = cross < 0.0 ? -1.0 : 1.0;
  SF_REAL ax = difference >= 0.0 ? size + difference : sign_of_cross * cross;
  SF_REAL ay = difference >= 0.0 ? cross : sign_of_cross * (size - difference);
  SF_REAL norm = sqrt(ax * ax + ay * ay);
  const bool is_line = m.n > 1.5 && size > 1.4210854715202004e-14 * (m.xx + m.yy) && norm > 0.0;
  const double unit = is_line ? norm : 1.0;
  SF_REAL tx = ax / unit;
  SF_REAL ty = ay / unit;
  SF_REAL spread = (xx + yy + size) / (n + n);
  return facing(px, py, is_line ? tx : 1.0, is_line ? ty : 0.0, is_line ? spread : 0.0);
}

SF_INLINE double across(Line line, double x, double y) {
  SF_REAL v = line.nx * (x - line.px) + line.ny * (y - line.py);
  return v;
}

SF_INLINE double along(Line line, double x, double y) {
  SF_REAL u = line.tx * (x - line.px) + line.ty * (y - line.py);
  return u;
}

/// Sums in the frame of a line: u along it, v across it.
struct LineMoments {
  double n, u, v, uu, uv, vv, uuu, uuuu, uuv;
  double widest;           // [m] largest |v|
  double lowest, highest;  // [m] of u
};

SF_INLINE LineMoments no_moments() {
  const LineMoments none = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  return none;
}

SF_INLINE void add_to_moments(SF_INOUT(LineMoments) s, double w, double u, double v) {
  SF_REAL wu = w * u;
  SF_REAL wv = w * v;
  SF_REAL wuu = wu * u;
  SF_REAL uu = s.uu + wuu;
  SF_REAL uv = s.uv + wu * v;
  SF_REAL vv = s.vv + wv * v;
  SF_REAL uuu = s.uuu + wuu * u;
  SF_REAL uuuu = s.uuuu + wuu * (u * u);
  SF_REAL uuv = s.uuv + wuu * v;
  s.n = s.n + w;
  s.u = s.u + wu;
  s.v = s.v + wv;
  s.uu = uu;
  s.uv = uv;
  s.vv = vv;
  s.uuu = uuu;
  s.uuuu = uuuu;
  s.uuv = uuv;
  const double size = wv < 0.0 ? -wv : wv;
  s.widest = size > s.widest ? size : s.widest;
  s.lowest = wu < s.lowest ? wu : s.lowest;
  s.highest = wu > s.highest ? wu : s.highest;
}

/// The parabola v = curvature * (u^2 - skew * u - base), fitted to the residuals of the line.
struct Parabola {
  double curvature;   // [1/m]
  double skew, base;  // [m], [m^2]
  double left;        // [m^2] sum of squared residuals after line and parabola
};

SF_INLINE Parabola parabola_of(LineMoments s) {
  const double n = s.n > 0.0 ? s.n : 1.0;
  const double uu = s.uu > 0.0 ? s.uu : 1.0;
  SF_REAL skew = s.uuu / uu;
  SF_REAL base = s.uu / n;
  SF_REAL qq = s.uuuu - skew * s.uuu - base * s.uu;
  SF_REAL qv = s.uuv - skew * s.uv - base * s.v;
  const bool is_curved = s.n > 2.5 && qq > 9.5367431640625e-07 * s.uuuu;
  SF_REAL curvature = qv / (is_curved ? qq : 1.0);
  SF_REAL left = s.vv - curvature * qv;
  const double rest = is_curved ? left : s.vv;
  const Parabola parabola = {is_curved ? curvature : 0.0, skew, base, rest > 0.0 ? rest : 0.0};
  return parabola;
}

/// Returns the largest distance [m] of an edge's points from a line or parabola that errors of their source explain. A
/// grain is a pixel size.
SF_INLINE double tolerance(double grain, double noise) {
  SF_REAL t = 9.5367431640625e-07 + 1.25 * grain + 4.0 * noise;
  return t;
}

/// Returns true for a single edge: straight within its source's tolerance, or gently curved (rise at most a sixteenth
/// of the chord) with small residuals.
SF_INLINE bool is_one_edge(LineMoments s, Parabola b, double allowed) {
  SF_REAL chord = s.highest - s.lowest;
  const double curvature = b.curvature < 0.0 ? -b.curvature : b.curvature;
  const bool gentle = curvature * chord <= 0.25;
  SF_REAL slack = 0.375 * allowed + 0.001953125 * chord;
  return s.widest <= allowed || (gentle && b.left <= s.n * (slack * slack));
}

/// A candidate edge in consensus, n p = c within `allowed`. 32 bits suffice to count inliers.
struct Hypothesis {
  float nx, ny, c, allowed;
};

SF_INLINE Hypothesis hypothesis_of(Line line, double allowed) {
  SF_REAL c = line.nx * line.px + line.ny * line.py;
  const Hypothesis hypothesis = {float(line.nx), float(line.ny), float(c), float(allowed)};
  return hypothesis;
}

/// Returns the vote of a point: 1 for an inlier, -3 in front of the edge, 0 behind it. The nearest candidate whose
/// inliers exceed a quarter of the points behind it wins.
SF_INLINE float vote(Hypothesis b, float w, float x, float y) {
  SF_REAL32 v = b.nx * x + b.ny * y - b.c;
  return w * (v < -b.allowed ? -3.0f : (v <= b.allowed ? 1.0f : 0.0f));
}

/// Errors of the points' source.
struct PointError {
  double grain;  // [m] pixel size of outlines; 0: none
  double noise;  // [m] standard deviation of a point across the line
};

// [-] gain of an extrapolated edge: 2^100.
#define SF_NO_GAIN 1.2676506002282294e30

struct LineFit {
  double distance, points, residual, sigma;
  double gain;  // [-] largest error of the distance per error of the points across the line
  bool seen;
};

/// Extrapolates the line to the perpendicular e and estimates the error.
///
/// The variance of the line at u0 from the centroid is sigma^2 / n (1 + u0^2 / spread) (ordinary least squares), and
/// the variance of its direction is sigma^2 / (n spread). Pixel errors are not independent: an edge along the pixels
/// has the same offset for all of its points, which the residual does not show. The residual shows only the changes
/// between rows of pixels, which are few. So sigma^2 / n is a pixel's variance minus the residual's, plus a sixth of
/// the residual's. Of an edge seen at an angle, only the pixels' corners are visible: up to three times the variance.
/// The remaining curvature at u0 is model error and counts in full. A line parallel to e within a standard deviation of
/// its direction has no intersection.
SF_INLINE LineFit fit_at(Line line, LineMoments s, Parabola b, PointError point_error, double ex, double ey,
                         double distance_max) {
  const double n = s.n > 0.0 ? s.n : 1.0;
  const double uu = s.uu > 0.0 ? s.uu : 1.0;
  // Residual first moments due to rounding.
  SF_REAL lift = s.v / n;
  SF_REAL slope = s.uv / uu;
  SF_REAL nx = line.nx - slope * line.tx;
  SF_REAL ny = line.ny - slope * line.ty;
  SF_REAL px = line.px + lift * line.nx;
  SF_REAL py = line.py + lift * line.ny;
  SF_REAL height = nx * px + ny * py;
  SF_REAL facing_e = nx * ex + ny * ey;
  const bool ahead = facing_e > 9.5367431640625e-07 || facing_e < -9.5367431640625e-07;
  SF_REAL distance = height / (ahead ? facing_e : 1.0);
  SF_REAL u0 = line.tx * (ex * distance - px) + line.ty * (ey * distance - py);

  SF_REAL spread = uu / n;
  SF_REAL lever = 1.0 + u0 * u0 / spread;
  SF_REAL extra = s.n > 2.5 ? b.left / (s.n > 3.5 ? n - 3.0 : 1.0) : 0.0;
  SF_REAL own = point_error.noise * point_error.noise;
  SF_REAL single = own > extra || point_error.grain > 0.0 ? own : extra;
  SF_REAL rest = b.left / n;
  SF_REAL pixel = point_error.grain * point_error.grain / 12.0;
  SF_REAL hidden = pixel > rest + rest ? pixel - rest - rest : 0.0;
  SF_REAL r2 = px * px + py * py;
  SF_REAL beside = line.tx * px + line.ty * py;
  SF_REAL askew = r2 > 0.0 ? beside * beside / r2 : 0.0;
  SF_REAL pixels = point_error.grain > 0.0 ? (hidden + rest / 6.0) * (1.0 + askew) : 0.0;
  SF_REAL one = single / n + pixels;
  SF_REAL model = b.curvature * (u0 * u0 - b.skew * u0 - b.base);
  SF_REAL variance = one * lever + model * model;
  SF_REAL turn = sqrt(one / spread);
  const double facing_size = facing_e < 0.0 ? -facing_e : facing_e;
  const bool crosses = facing_size > turn;
  const double least = 0.25 * facing_size;
  const double sure = facing_size - turn > least ? facing_size - turn : least;
  SF_REAL sigma = sqrt(variance) / (crosses ? sure : 1.0);
  SF_REAL residual = sqrt((s.vv > 0.0 ? s.vv : 0.0) / n);
  // All points coincide with the sensor: it touches the edge, whatever the edge's direction.
  const bool here = line.spread == 0.0 && s.n > 1.5 && line.px * line.px + line.py * line.py < 8.673617379884035e-19;
  // The least-squares line at u0 is a mean of its points with weights 1/n (1 + u u0 / spread). Beyond its points an
  // edge may end or bend, and two points always define a line.
  const bool between = s.n > 2.5 && s.uu > 0.0 && u0 >= s.lowest && u0 <= s.highest;
  const double u0_size = u0 < 0.0 ? -u0 : u0;
  SF_REAL gain = (1.0 + u0_size / sqrt(spread)) / (ahead ? facing_size : 1.0);
  const bool there =
      line.spread > 0.0 && ahead && crosses && distance >= -9.313225746154785e-10 && distance <= distance_max;
  const double at = here || distance < 0.0 ? 0.0 : distance;
  const LineFit fitted = {
      at, s.n, residual, here ? sqrt(own / n) : sigma, ahead && between ? gain : SF_NO_GAIN, here || there};
  return fitted;
}

#ifdef __cplusplus
}  // namespace sf::sensors::fit
#endif
#endif
