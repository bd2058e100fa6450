#include "world/roads/curve.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"

namespace sf::world {

namespace {

constexpr double kCoincident = 1e-6;  // [m]
constexpr int kDeepest = 20;          // largest number of halvings of a span
constexpr double kMaxTurn = 0.5;      // [rad] between adjacent pieces of the polyline

glm::dvec2 unit(glm::dvec2 v) {
  const double l = length(v);
  return l > 0.0 ? glm::dvec2{v.x / l, v.y / l} : glm::dvec2{1.0, 0.0};
}

/// [rad] in [-pi, pi], counter-clockwise.
double turn_between(glm::dvec2 a, glm::dvec2 b) { return base::atan2(base::cross(a, b), dot(a, b)); }

double distance_to_segment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 d = b - a;
  const double dd = dot(d, d);
  const double t = dd > 0.0 ? std::clamp(dot(p - a, d) / dd, 0.0, 1.0) : 0.0;
  return length(p - (a + t * d));
}

struct Bezier {
  glm::dvec2 p0, p1, p2, p3;
};

glm::dvec2 middle(glm::dvec2 a, glm::dvec2 b) { return 0.5 * (a + b); }

glm::dvec2 start_of(const Bezier& b) {
  if (length(b.p1 - b.p0) > 0.0) return unit(b.p1 - b.p0);
  return unit(length(b.p2 - b.p0) > 0.0 ? b.p2 - b.p0 : b.p3 - b.p0);
}
glm::dvec2 end_of(const Bezier& b) {
  if (length(b.p3 - b.p2) > 0.0) return unit(b.p3 - b.p2);
  return unit(length(b.p3 - b.p1) > 0.0 ? b.p3 - b.p1 : b.p3 - b.p0);
}

void add_point(Curve& curve, glm::dvec2 p, glm::dvec2 tangent) {
  const double step = curve.points.empty() ? 0.0 : length(p - curve.points.back());
  curve.s.push_back(curve.points.empty() ? 0.0 : curve.s.back() + step);
  curve.points.push_back(p);
  curve.tangents.push_back(tangent);
}

// The curve is in the hull of its control points, and distance to a segment is convex, so no point of the curve is
// farther from the chord than the control points. An arc of angle phi deviates by (radius) phi^2 / 8, so its offset at
// h deviates by h phi^2 / 8 more.
void flatten(Curve& curve, const Bezier& b, const Sampling& sampling, int depth) {
  const double flat = std::max(distance_to_segment(b.p1, b.p0, b.p3), distance_to_segment(b.p2, b.p0, b.p3));
  const double turn = std::abs(turn_between(start_of(b), end_of(b)));
  const double bulge = sampling.half_width * turn * turn / 8.0;
  const bool fine = flat + bulge <= sampling.tolerance && turn <= kMaxTurn;
  if (fine || depth == kDeepest || curve.points.size() + static_cast<std::size_t>(depth) >= sampling.most)
    return add_point(curve, b.p3, end_of(b));
  const glm::dvec2 p01 = middle(b.p0, b.p1), p12 = middle(b.p1, b.p2), p23 = middle(b.p2, b.p3);
  const glm::dvec2 p012 = middle(p01, p12), p123 = middle(p12, p23);
  const glm::dvec2 half = middle(p012, p123);
  flatten(curve, {b.p0, p01, p012, half}, sampling, depth + 1);
  flatten(curve, {half, p123, p23, b.p3}, sampling, depth + 1);
}

/// Returns a Hermite span with tangents of lengths `reach_a` and `reach_b` [m], before the factor that reproduces
/// circles.
Bezier span_of(glm::dvec2 a, glm::dvec2 tangent_a, double reach_a, glm::dvec2 b, glm::dvec2 tangent_b, double reach_b) {
  const double c = base::cos(turn_between(tangent_a, tangent_b) / 4.0);
  const double factor = 1.0 / (3.0 * c * c);
  return {a, a + factor * reach_a * tangent_a, b - factor * reach_b * tangent_b, b};
}

/// Directions and lengths of the chords of a line.
struct Chords {
  std::vector<glm::dvec2> along;
  std::vector<double> length;
  std::vector<double> turn;  ///< [rad] at each way-point, 0 at the ends
};

Chords chords_of(const std::vector<glm::dvec2>& p) {
  Chords chords;
  chords.turn.assign(p.size(), 0.0);
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    chords.along.push_back(unit(p[i + 1] - p[i]));
    chords.length.push_back(length(p[i + 1] - p[i]));
    if (i > 0) chords.turn[i] = turn_between(chords.along[i - 1], chords.along[i]);
  }
  return chords;
}

/// Returns the curvature [1/m] of chord `of` at way-point `at`, where another chord also ends. The turn is divided
/// between the two chords; the shorter one gets the larger part.
double bend(const Chords& chords, std::size_t of, std::size_t at) {
  const double here = chords.length[of];
  const double other = chords.length[of == at ? at - 1 : at];
  return 2.0 * std::abs(chords.turn[at]) * other / ((here + other) * here);
}

/// Returns the direction at each way-point of a line of at least two, none of which coincide.
std::vector<glm::dvec2> directions(const std::vector<glm::dvec2>& p) {
  const std::size_t n = p.size();
  const Chords chords = chords_of(p);
  std::vector<glm::dvec2> tangents(n);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    // The curvature of a chord is taken at its far end, or at this end if the line ends there.
    const double before = bend(chords, i - 1, i > 1 ? i - 1 : i);
    const double after = bend(chords, i, i + 2 < n ? i + 1 : i);
    const double share = before + after > 1e-12 ? before / (before + after) : 0.5;
    const double turn = std::abs(chords.turn[i]);
    const double most = std::min(turn, M_PI / 2.0);
    const double angle = std::clamp(share * turn, turn - most, most);
    tangents[i] = base::rotate(std::copysign(angle, chords.turn[i]), chords.along[i - 1]);
  }
  // The tangent at an end mirrors its neighbour about their chord, as on an arc.
  const auto mirrored = [](glm::dvec2 tangent, glm::dvec2 axis) { return 2.0 * dot(tangent, axis) * axis - tangent; };
  tangents[0] = n > 2 ? mirrored(tangents[1], chords.along[0]) : chords.along[0];
  tangents[n - 1] = n > 2 ? mirrored(tangents[n - 2], chords.along[n - 2]) : chords.along[0];
  return tangents;
}

}  // namespace

Curve smooth_curve(std::span<const glm::dvec2> waypoints, const Sampling& sampling) {
  SF_CHECK(!waypoints.empty(), "a curve without points");
  std::vector<glm::dvec2> p;
  std::vector<std::size_t> row;
  for (const glm::dvec2& at : waypoints) {
    if (p.empty() || length(at - p.back()) > kCoincident) p.push_back(at);
    row.push_back(p.size() - 1);
  }

  Curve curve;
  const std::vector<glm::dvec2> tangents = p.size() > 1 ? directions(p) : std::vector<glm::dvec2>{{1.0, 0.0}};
  std::vector<std::size_t> knots{0};
  add_point(curve, p[0], tangents[0]);
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    const double here = length(p[i + 1] - p[i]);
    const double start = i > 0 ? std::min(here, length(p[i] - p[i - 1])) : here;
    const double end = i + 2 < p.size() ? std::min(here, length(p[i + 2] - p[i + 1])) : here;
    // The first and the last span are arcs: both tangents have the same length.
    const Bezier span =
        span_of(p[i], tangents[i], i > 0 ? start : end, p[i + 1], tangents[i + 1], i + 2 < p.size() ? end : start);
    flatten(curve, span, sampling, 0);
    curve.tangents.back() = tangents[i + 1];
    knots.push_back(curve.points.size() - 1);
  }
  for (const std::size_t i : row) curve.knots.push_back(knots[i]);
  return curve;
}

Curve connection(glm::dvec2 a, glm::dvec2 tangent_a, glm::dvec2 b, glm::dvec2 tangent_b, const Sampling& sampling) {
  Curve curve;
  add_point(curve, a, tangent_a);
  const double chord = length(b - a);
  if (chord > kCoincident) flatten(curve, span_of(a, tangent_a, chord, b, tangent_b, chord), sampling, 0);
  curve.knots = {0, curve.points.size() - 1};
  return curve;
}

glm::dvec2 point_at(const Curve& curve, double s) {
  const auto next = std::upper_bound(curve.s.begin(), curve.s.end(), s);
  if (next == curve.s.begin()) return curve.points.front();
  if (next == curve.s.end()) return curve.points.back();
  const auto i = static_cast<std::size_t>(next - curve.s.begin());
  const double t = (s - curve.s[i - 1]) / (curve.s[i] - curve.s[i - 1]);
  return curve.points[i - 1] + t * (curve.points[i] - curve.points[i - 1]);
}

CurvePlace place_beside(std::span<const glm::dvec2> points, std::span<const double> s, glm::dvec2 p) {
  CurvePlace best{.away = HUGE_VAL};
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const glm::dvec2 e = points[i + 1] - points[i], d = p - points[i];
    const double t = std::clamp(glm::dot(d, e) / glm::dot(e, e), 0.0, 1.0);
    const double away = glm::length(d - t * e);
    if (away < best.away)
      best = {s[i] + t * (s[i + 1] - s[i]), base::cross(e, d) / glm::length(e), away, base::atan2(e.y, e.x)};
  }
  return best;
}

}  // namespace sf::world
