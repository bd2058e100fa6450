#pragma once
// 64-bit intersection of one beam and one segment on the host. It performs the operations of shaders/lib/intersect.glsl
// in the same order, so both results are bit-identical.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/pose.h"
#include "raycast/records.h"

namespace sf::raycast {

/// Transforms the segment ab from a mover's frame to the world. @param p position of the mover  @param heading unit
/// vector
inline ExactSegment to_world(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p, glm::dvec2 heading) {
  const double c = heading.x, s = heading.y;
  return {p.x + (c * a.x - s * a.y), p.y + (s * a.x + c * a.y), p.x + (c * b.x - s * b.y), p.y + (s * b.x + c * b.y)};
}

/// A segment that a beam may meet.
struct CandidateSegment {
  ExactSegment at;
  std::uint32_t id;  ///< row in the table of walls, then movers' edges; the smaller id wins a tie
};

/// The nearest intersection so far along one beam.
struct ClosestHit {
  double range;                  ///< [m]
  std::uint32_t id = SF_NO_HIT;  ///< row of the segment
  float incidence[3] = {};       ///< cross product of segment and direction [m]; x and y of the segment [m]

  /// Returns whether the sine of the angle between beam and surface is below `least`.
  bool grazes(float least) const {
    return id != SF_NO_HIT &&
           incidence[0] * incidence[0] < least * least * (incidence[1] * incidence[1] + incidence[2] * incidence[2]);
  }
};

/// Updates `best` if the beam from `origin` along `d` (unit vector) meets `surface` at a smaller range.
inline void intersect(const CandidateSegment& surface, glm::dvec2 origin, glm::dvec2 d, ClosestHit& best) {
  const ExactSegment& s = surface.at;
  const double wax = s.ax - origin.x, way = s.ay - origin.y;
  const double wbx = s.bx - origin.x, wby = s.by - origin.y;
  const double side_a = d.x * way - d.y * wax;
  const double side_b = d.x * wby - d.y * wbx;
  const bool crosses = (side_a >= 0.0 && side_b <= 0.0) || (side_a <= 0.0 && side_b >= 0.0);
  if (!crosses) return;
  const double ex = s.bx - s.ax, ey = s.by - s.ay;
  const double numerator = ex * way - ey * wax;
  const double denominator = ex * d.y - ey * d.x;
  if (denominator == 0.0) return;
  const double t = numerator / denominator;
  if (!(t > SF_CONTACT_DISTANCE || (denominator > 0.0 && t >= -SF_CONTACT_DISTANCE))) return;
  const double range = t > 0.0 ? t : 0.0;
  if (range < best.range || (range == best.range && surface.id < best.id))
    best = {range, surface.id, {static_cast<float>(denominator), static_cast<float>(ex), static_cast<float>(ey)}};
}

/// Returns the range [m] of a beam that meets `s`, in 32 bits; a negative value if 32 bits are not accurate enough. The
/// error is at most 16 u |e| (|w| + range_max) / |e x d|, u = 2^-24, and is kept below half of SF_SINGLE_TOLERANCE
/// range_max. Same operations in the same order as shaders/lib/intersect.glsl.
inline float range_single(const ExactSegment& s, glm::dvec2 origin, glm::dvec2 d, float range_max) {
  const auto wx = static_cast<float>(s.ax - origin.x), wy = static_cast<float>(s.ay - origin.y);
  const auto ex = static_cast<float>(s.bx - s.ax), ey = static_cast<float>(s.by - s.ay);
  const auto dx = static_cast<float>(d.x), dy = static_cast<float>(d.y);
  const float denominator = ex * dy - ey * dx;
  const float numerator = ex * wy - ey * wx;
  const float error_scale = 0x1p-19f * (std::abs(ex) + std::abs(ey)) * (std::abs(wx) + std::abs(wy) + range_max);
  return error_scale <= static_cast<float>(SF_SINGLE_TOLERANCE) * range_max * std::abs(denominator)
             ? std::max(numerator / denominator, 0.0f)
             : -1.0f;
}

}  // namespace sf::raycast
