// Quaternions, and screw motions between tilted poses.

#include "base/tilted_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace sf::base {
namespace {

constexpr Tilt kTilts[] = {{0.0, 0.0},    {0.1, -0.2},    {-3.0, 0.4}, {0.3, 1.5},
                           {0.2, M_PI_2}, {1.0, -M_PI_2}, {M_PI, 0.0}};
constexpr double kYaws[] = {0.0, 0.7, -2.5, M_PI, 7.0};

/// Returns the largest difference of two poses: of an entry of their rotations, or of a coordinate [m].
double difference(const RigidTransform& A, const RigidTransform& B) {
  double largest = glm::distance(A.p, B.p);
  for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, glm::distance(A.R[axis], B.R[axis]));
  return largest;
}
RigidTransform transform_of(const TiltedPose& pose) { return base::transform_of(pose.X, pose.tilt); }

TEST(TiltedPose, QuaternionsAndAnglesAreTheSameRotation) {
  for (const Tilt& tilt : kTilts)
    for (const double yaw : kYaws) {
      const RigidTransform X = base::transform_of({1.0, -2.0, 0.5, yaw}, tilt);
      const Quaternion q = quaternion_of(yaw, tilt);
      EXPECT_LT(difference({rotation_of(q), X.p}, X), 1e-15) << tilt.roll << " " << tilt.pitch << " " << yaw;
      const Quaternion longer{-2.0 * q.w, -2.0 * q.x, -2.0 * q.y, -2.0 * q.z};  // the same rotation, of another norm
      EXPECT_LT(difference({rotation_of(longer), X.p}, X), 1e-15) << tilt.roll << " " << tilt.pitch << " " << yaw;
      EXPECT_LT(difference(transform_of(tilted_pose_of(X)), X), 1e-15) << tilt.roll << " " << tilt.pitch << " " << yaw;
    }
}

/// Recordings and messages of planar robots depend on it.
TEST(TiltedPose, LevelQuaternionsAreExact) {
  for (const double yaw : kYaws) {
    const Quaternion q = quaternion_of(yaw, {-0.0, 0.0});
    EXPECT_EQ(std::bit_cast<std::uint64_t>(q.x), 0u);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(q.y), 0u);
    EXPECT_EQ(q.z, sin(0.5 * yaw));
    EXPECT_EQ(q.w, cos(0.5 * yaw));
  }
}

/// Equal parts of a screw motion are the same motion in the body's frame, and all of them lead to the end.
TEST(ScrewMotion, IsConstantInTheBodysFrame) {
  constexpr int kParts = 8;
  for (const Tilt& a : kTilts)
    for (const Tilt& b : kTilts)
      for (const double yaw : kYaws) {
        const TiltedPose from{{1.0, -2.0, 0.5, 0.3}, a}, to{{1.5, -1.0, 0.25, yaw}, b};
        RigidTransform before = transform_of(from), first;
        for (int k = 1; k <= kParts; ++k) {
          const RigidTransform now = transform_of(screw_between(from, to, k / double{kParts}));
          const RigidTransform step = relative(before, now);
          if (k == 1) first = step;
          EXPECT_LT(difference(step, first), 1e-13) << k << ": " << a.roll << " " << b.roll << " " << yaw;
          before = now;
        }
        EXPECT_LT(difference(before, transform_of(to)), 1e-14) << a.roll << " " << b.roll << " " << yaw;
        EXPECT_LT(difference(transform_of(screw_between(from, to, 0.0)), transform_of(from)), 1e-14);
      }
}

/// A helix about the y axis at x = 2, z = 1: half a turn nose down, and 3 m to the left. Half of it, by hand.
TEST(ScrewMotion, FollowsAHelix) {
  const TiltedPose half = screw_between({{0, 0, 1, 0}}, {{4, 3, 1, M_PI}, {M_PI, 0}}, 0.5);
  const glm::dmat3 R = transform_of(half).R;
  EXPECT_NEAR(half.X.x, 2.0, 1e-14);
  EXPECT_NEAR(half.X.y, 1.5, 1e-14);
  EXPECT_NEAR(std::abs(half.X.z - 1.0), 2.0, 1e-14);
  EXPECT_NEAR(std::abs(R[0].z), 1.0, 1e-14);  // its nose is straight up or down, since half a turn has two ways
  EXPECT_LT(glm::distance(R[1], glm::dvec3(0, 1, 0)), 1e-14);
}

/// The axis of a small turn is far away, that of none at infinity.
TEST(ScrewMotion, SmallAndNoTurnsAreNearlyStraight) {
  for (const double turn : {0.0, 1e-300, 1e-17, 1e-9, 1e-5}) {
    const TiltedPose half = screw_between({{0, 0, 0, 0}, {0.1, 0.2}}, {{1, 2, 3, 0}, {0.1 + turn, 0.2}}, 0.5);
    EXPECT_LT(glm::distance(glm::dvec3(half.X.x, half.X.y, half.X.z), glm::dvec3(0.5, 1.0, 1.5)), turn + 1e-15) << turn;
    EXPECT_NEAR(half.tilt.roll, 0.1 + 0.5 * turn, 1e-15) << turn;
  }
}

/// 10 000 km away, positions are a sum with rounding of 1 nm; the motion itself has none of it.
TEST(ScrewMotion, IsTheSameFarFromTheOrigin) {
  const double far = 1e7;
  const TiltedPose near = screw_between({{0, 0, 0, 0}, {0.1, 0.0}}, {{0.25, 0.5, 0, 1.0}, {0.0, 0.3}}, 0.25);
  const TiltedPose there =
      screw_between({{far, -far, 0, 0}, {0.1, 0.0}}, {{far + 0.25, 0.5 - far, 0, 1.0}, {0.0, 0.3}}, 0.25);
  EXPECT_NEAR(there.X.x - far, near.X.x, 1e-9);
  EXPECT_NEAR(there.X.y + far, near.X.y, 1e-9);
  EXPECT_EQ(there.X.yaw, near.X.yaw);
  EXPECT_EQ(there.tilt.roll, near.tilt.roll);
}

}  // namespace
}  // namespace sf::base
