#include "base/tilted_pose.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace sf::base {

namespace {

Quaternion product(const Quaternion& p, const Quaternion& q) {
  return {p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z, p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y,
          p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x, p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w};
}

/// Screw motion from frame A to frame B, in A.
struct Screw {
  Quaternion q_WA;
  glm::dmat3 R_WA;
  double half = 0.0;   ///< [rad] half of the turn, in [0, pi/2]
  glm::dvec3 axis;     ///< unit vector; 0 without a turn
  double along = 0.0;  ///< [m] way along the axis
  glm::dvec3 chord;    ///< [m] of the origin's way, across the axis
};

Screw screw_of(const TiltedPose& from, const TiltedPose& to) {
  Screw s;
  s.q_WA = quaternion_of(from.X.yaw, from.tilt);
  const Quaternion q_WB = quaternion_of(to.X.yaw, to.tilt);
  Quaternion q = product({s.q_WA.w, -s.q_WA.x, -s.q_WA.y, -s.q_WA.z}, q_WB);
  if (q.w < 0.0) q = {-q.w, -q.x, -q.y, -q.z};
  const double sine = hypot(q.x, q.y, q.z);
  s.half = atan2(sine, q.w);
  s.axis = sine > 0.0 ? glm::dvec3{q.x, q.y, q.z} / sine : glm::dvec3{};
  s.R_WA = rotation_of(s.q_WA);
  const glm::dvec3 p = glm::transpose(s.R_WA) * glm::dvec3{to.X.x - from.X.x, to.X.y - from.X.y, to.X.z - from.X.z};
  s.along = glm::dot(s.axis, p);
  s.chord = p - s.along * s.axis;
  return s;
}

}  // namespace

TiltedPose tilted_pose_of(const RigidTransform& X_AB) {
  const glm::dvec3 &x = X_AB.R[0], &y = X_AB.R[1], &z = X_AB.R[2];
  const double yaw = atan2(x.y, x.x);
  // Pitch and roll of the rotation that is left when yaw is undone: exact for any yaw, also where it is not determined.
  const auto [s, c] = sin_cos(yaw);
  return {{X_AB.p.x, X_AB.p.y, X_AB.p.z, yaw},
          {atan2(s * z.x - c * z.y, c * y.y - s * y.x), atan2(-x.z, c * x.x + s * x.y)}};
}

Quaternion quaternion_of(double yaw, const Tilt& tilt) {
  const auto [sy, cy] = sin_cos(0.5 * yaw);
  if (is_level(tilt)) return {cy, 0.0, 0.0, sy};
  const auto [sp, cp] = sin_cos(0.5 * tilt.pitch);
  const auto [sr, cr] = sin_cos(0.5 * tilt.roll);
  return {cy * cp * cr + sy * sp * sr, cy * cp * sr - sy * sp * cr, cy * sp * cr + sy * cp * sr,
          sy * cp * cr - cy * sp * sr};
}

glm::dmat3 rotation_of(const Quaternion& q) {
  const auto& [w, x, y, z] = q;
  const double s = 2.0 / (w * w + x * x + y * y + z * z);
  return {{1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
          {s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)},
          {s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)}};
}

// The screw axis may be arbitrarily far away, so no point on it is computed. Across the axis, the body's origin moves
// along a circle: the chord of a part of the turn has the direction of the whole chord, less half of the turn that is
// left, and its length is in proportion to the sine of half the turn.
TiltedPose screw_between(const TiltedPose& from, const TiltedPose& to, double part) {
  const Screw s = screw_of(from, to);
  const SinCos back = sin_cos((part - 1.0) * s.half), turned = sin_cos(part * s.half);
  const double share = part * sinc(part * s.half) / sinc(s.half);
  const glm::dvec3 p_AC =
      part * s.along * s.axis + share * (back.cos * s.chord + back.sin * glm::cross(s.axis, s.chord));

  const glm::dvec3 v = turned.sin * s.axis;
  return tilted_pose_of({rotation_of(product(s.q_WA, {turned.cos, v.x, v.y, v.z})),
                         s.R_WA * p_AC + glm::dvec3{from.X.x, from.X.y, from.X.z}});
}

// The derivative of the way above at its start.
BodyVelocity screw_velocity(const TiltedPose& from, const TiltedPose& to, double seconds) {
  const Screw s = screw_of(from, to);
  const auto [sine, cosine] = sin_cos(s.half);
  const glm::dvec3 across = (cosine * s.chord - sine * glm::cross(s.axis, s.chord)) / sinc(s.half);
  return {(s.along * s.axis + across) / seconds, 2.0 * s.half / seconds * s.axis};
}

}  // namespace sf::base
