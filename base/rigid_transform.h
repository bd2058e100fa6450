#pragma once
// Poses in six degrees of freedom.

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/vector_double3.hpp>

#include "base/elementary.h"
#include "base/pose.h"

namespace sf::base {

/// Pose of frame B in frame A (`X_AB`): rotate by R, then translate. Right-handed, x forward, y left, z up.
struct RigidTransform {
  glm::dmat3 R{1.0};  ///< R_AB, orthonormal to rounding: its columns are the axes of B in A
  glm::dvec3 p{};     ///< [m] origin of B in A
};

/// Returns Rz(yaw) Ry(pitch) Rx(roll) [rad]: positive pitch lowers the x axis, positive roll raises the y axis.
inline glm::dmat3 rotation_of(double roll, double pitch, double yaw) {
  const auto [sr, cr] = sin_cos(roll);
  const auto [sp, cp] = sin_cos(pitch);
  const auto [sy, cy] = sin_cos(yaw);
  return {{cy * cp, sy * cp, -sp},
          {cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr},
          {cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr}};
}

inline RigidTransform transform_of(const Pose& X_AB, const Tilt& tilt = {}) {
  return {rotation_of(tilt.roll, tilt.pitch, X_AB.yaw), {X_AB.x, X_AB.y, X_AB.z}};
}

/// Returns X_AC from X_AB and X_BC.
inline RigidTransform compose(const RigidTransform& X_AB, const RigidTransform& X_BC) {
  return {X_AB.R * X_BC.R, X_AB.R * X_BC.p + X_AB.p};
}

/// Returns X_BC from X_AB and X_AC, with errors that depend on the distance of B and C, not on that from A.
inline RigidTransform relative(const RigidTransform& X_AB, const RigidTransform& X_AC) {
  const glm::dmat3 R_BA = glm::transpose(X_AB.R);
  return {R_BA * X_AC.R, R_BA * (X_AC.p - X_AB.p)};
}

/// Returns point `p_B` expressed in A.
inline glm::dvec3 transform(const RigidTransform& X_AB, glm::dvec3 p_B) { return X_AB.R * p_B + X_AB.p; }

}  // namespace sf::base
