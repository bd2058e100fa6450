#pragma once
// Smooth lines through way-points.
//
// A cubic Hermite curve joins each pair of neighbouring way-points. The line passes exactly through every way-point,
// and its direction is continuous (C1 in arc length). The direction at a way-point lies between those of its two
// chords, closer to the chord that bends less at its far end (after H. Akima, "A new method of interpolation and smooth
// curve fitting", J. ACM 17(4), 1970, with curvatures of chords in place of slopes), so straight parts next to bends
// stay straight. The length of a tangent is the shorter of the two chords, times 1 / cos^2(turn of the span / 4):
// equally spaced points of a circle give a circle (within 1e-6 of its radius for points every 30 degrees).
//
// The curve does not overshoot: along its chord it only moves forwards, and its lateral distance from the chord is at
// most half of the chord (at most a quarter of the shorter neighbouring chord times the sine of its steepest angle,
// times that factor).

#include <cstddef>
#include <span>
#include <vector>

#include "base/pose.h"

namespace sf::world {

/// A curve as a polyline. Rows of `points`, `tangents` and `s` correspond; neighbouring points are distinct.
struct Curve {
  std::vector<glm::dvec2> points;    ///< [m]
  std::vector<glm::dvec2> tangents;  ///< unit vectors along the curve; {1, 0} for a curve of one point
  std::vector<double> s;             ///< [m] length of the polyline up to each point
  std::vector<std::size_t> knots;    ///< row of each way-point; coincident way-points share a row
};

/// How a curve is sampled as a polyline.
struct Sampling {
  double tolerance = 1e-3;      ///< [m] > 0: largest distance between the curve and the polyline
  double half_width = 0.0;      ///< [m] >= 0: the tolerance also holds for the curve's offset at this distance
  std::size_t most = 1u << 20;  ///< largest number of points; beyond it the polyline is coarser than the tolerance
};

/// Returns the smooth line through `waypoints`, at least one. Merges a way-point within 1e-6 m of the previous one with
/// it.
Curve smooth_curve(std::span<const glm::dvec2> waypoints, const Sampling& sampling);

/// Returns a smooth connection from `a` in direction `tangent_a` to `b` in direction `tangent_b` (unit vectors).
Curve connection(glm::dvec2 a, glm::dvec2 tangent_a, glm::dvec2 b, glm::dvec2 tangent_b, const Sampling& sampling);

/// Returns the parallel of the curve at `distance` [m] to its left (negative: right). Where the curve bends more
/// tightly than `distance`, points closer to it than `distance` are left out, so the inside of a bend has a corner
/// instead of a loop. Neighbouring points are distinct. Empty if no point is left, and for a curve of one point.
std::vector<glm::dvec2> offset_curve(const Curve& curve, double distance);

/// Returns the point at `s` [m] along the polyline, clamped to its ends.
glm::dvec2 point_at(const Curve& curve, double s);

/// A place beside a curve.
struct CurvePlace {
  double s = 0.0;     ///< [m] along the polyline, of the nearest point
  double left = 0.0;  ///< [m] from the line through the nearest piece, positive to its left
  double away = 0.0;  ///< [m] from the nearest point
  double yaw = 0.0;   ///< [rad] of that piece
};
/// Finds the nearest place of the polyline with at least two points, of which successive ones differ.
CurvePlace place_beside(std::span<const glm::dvec2> points, std::span<const double> s, glm::dvec2 p);

}  // namespace sf::world
