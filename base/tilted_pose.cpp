#include "base/tilted_pose.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace sf::base {

namespace {

Quaternion product(const Quaternion& p, const Quaternion& q) {
  return {p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z, p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y,
          p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x, p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w};
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
  const Quaternion q_WA = quaternion_of(from.X.yaw, from.tilt), q_WB = quaternion_of(to.X.yaw, to.tilt);
  Quaternion q = product({q_WA.w, -q_WA.x, -q_WA.y, -q_WA.z}, q_WB);
  if (q.w < 0.0) q = {-q.w, -q.x, -q.y, -q.z};
  const double sine = hypot(q.x, q.y, q.z), half = atan2(sine, q.w);
  const glm::dvec3 axis = sine > 0.0 ? glm::dvec3{q.x, q.y, q.z} / sine : glm::dvec3{};

  const glm::dmat3 R_WA = rotation_of(q_WA);
  const glm::dvec3 p = glm::transpose(R_WA) * glm::dvec3{to.X.x - from.X.x, to.X.y - from.X.y, to.X.z - from.X.z};
  const double along = glm::dot(axis, p);
  const glm::dvec3 chord = p - along * axis;
  const SinCos back = sin_cos((part - 1.0) * half), turned = sin_cos(part * half);
  const double share = part * sinc(part * half) / sinc(half);
  const glm::dvec3 p_AC = part * along * axis + share * (back.cos * chord + back.sin * glm::cross(axis, chord));

  const glm::dvec3 v = turned.sin * axis;
  return tilted_pose_of({rotation_of(product(q_WA, {turned.cos, v.x, v.y, v.z})),
                         R_WA * p_AC + glm::dvec3{from.X.x, from.X.y, from.X.z}});
}

}  // namespace sf::base
