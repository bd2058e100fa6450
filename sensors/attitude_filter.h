#pragma once
// Orientation from the readings of gyros, with that of gravity from accelerometers: the explicit complementary filter
// of Mahony, Hamel and Pflimlin, "Nonlinear complementary filters on the special orthogonal group" (IEEE Transactions
// on Automatic Control 53(5), 2008), section IV.C, with one direction. Roll and pitch follow gravity slowly, with the
// biases of the gyros across it; heading follows the gyros alone. In deviation from the paper, forces that differ from
// gravity by more than kMostAcceleration correct nothing: the body accelerates.

#include <cstdint>
#include <glm/ext/quaternion_double.hpp>
#include <glm/ext/vector_double3.hpp>

#include "base/bytes.h"

namespace sf::sensors {

inline constexpr double kMostAcceleration = 0.1;  ///< [-] of gravity

class AttitudeFilter {
 public:
  /// @param gain [1/s] >= 0, k_P  @param bias_gain [1/s^2] >= 0, k_I  @param gravity [m/s^2] >= 0
  AttitudeFilter(double gain, double bias_gain, double gravity)
      : gain_(gain), bias_gain_(bias_gain), gravity_(gravity) {}

  /// Starts with a heading [rad], and with roll and pitch of a body at rest with the specific force `force`. Biases
  /// are 0.
  void align(double yaw, const glm::dvec3& force);
  /// @param rate [rad/s]  @param force [m/s^2], means over the last `seconds` in the sensor's frame
  void update(const glm::dvec3& rate, const glm::dvec3& force, double seconds);
  /// Returns the rotation of the sensor in the world, a unit quaternion.
  const glm::dquat& q_WS() const { return q_WS_; }

  void write(base::ByteWriter& out) const;
  void read(base::ByteReader& in);

 private:
  double gain_, bias_gain_, gravity_;
  glm::dquat q_WS_{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 bias_{};  ///< [rad/s]
};

}  // namespace sf::sensors
