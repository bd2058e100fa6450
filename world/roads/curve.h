#pragma once
// Smooth lines through way-points.
//
// Between two way-points runs a cubic Hermite curve, so the line passes through every way-point exactly and its
// direction is continuous (C1 in arc length). The direction at a way-point lies between those of its two chords, nearer
// to the chord that bends less at its far end (after H. Akima, "A new method of interpolation and smooth curve
// fitting", J. ACM 17(4), 1970, with curvatures of chords in place of slopes), so that straights stay straight beside
// bends. How long a tangent reaches is the shorter of the two chords, times 1 / cos^2(turn of the span / 4), which
// makes a circle of even points of a circle (within a millionth of its radius for points every 30 degrees).
//
// No overshoot: along its chord the curve moves forwards only, and sideways it leaves the chord by at most half of it
// (by at most a quarter of the shorter neighbouring chord times the sine of its steepest angle, times that factor).

#include <cstddef>
#include <span>
#include <vector>

#include "base/pose.h"

namespace sf::world {

/// A curve as a polyline. Rows of `points`, `tangents` and `s` belong together; neighbouring points are distinct.
struct Curve {
  std::vector<glm::dvec2> points;    ///< [m]
  std::vector<glm::dvec2> tangents;  ///< unit vectors along the curve; {1, 0} where there is one point only
  std::vector<double> s;             ///< [m] length of the polyline up to here
  std::vector<std::size_t> knots;    ///< row of each way-point; way-points that coincide share one
};

/// How finely a curve becomes a polyline.
struct Sampling {
  double tolerance = 1e-3;      ///< [m] > 0: no point of the curve is farther from the polyline
  double half_width = 0.0;      ///< [m] >= 0: nor any point of the curve's offset at this distance from its polyline
  std::size_t most = 1u << 20;  ///< points; when they do not suffice the curve is left coarse
};

/// The smooth line through `waypoints`, at least one. Those nearer than 1e-6 m to the last are one with it.
Curve smooth_curve(std::span<const glm::dvec2> waypoints, const Sampling& sampling);

/// A smooth connection that leaves `a` along `tangent_a` and arrives at `b` along `tangent_b` (unit vectors).
Curve connection(glm::dvec2 a, glm::dvec2 tangent_a, glm::dvec2 b, glm::dvec2 tangent_b, const Sampling& sampling);

/// The curve's parallel at `distance` to its left (negative: right) [m]. Where the curve bends tighter than that, what
/// would come nearer to it is left out, so that the inside of a bend has a corner and no loop. Neighbouring points are
/// distinct; empty where nothing is left, and where the curve has one point only.
std::vector<glm::dvec2> offset_curve(const Curve& curve, double distance);

/// Point at `s` [m] along the polyline, clamped to its ends.
glm::dvec2 point_at(const Curve& curve, double s);

}  // namespace sf::world
