#include "sensors/attitude_filter.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/elementary.h"
#include "base/tilted_pose.h"

namespace sf::sensors {

void AttitudeFilter::align(double yaw, const glm::dvec3& force) {
  const base::Tilt tilt{base::atan2(force.y, force.z), base::atan2(-force.x, base::hypot(force.y, force.z))};
  const base::Quaternion q = base::quaternion_of(yaw, tilt);
  q_WS_ = {q.w, q.x, q.y, q.z};
  bias_ = {};
}

void AttitudeFilter::update(const glm::dvec3& rate, const glm::dvec3& force, double seconds) {
  glm::dvec3 w = rate - bias_;
  const double norm = base::hypot(force.x, force.y, force.z);
  if (norm > 0.0 && std::abs(norm - gravity_) <= kMostAcceleration * gravity_) {
    const glm::dvec3 error = glm::cross(force / norm, glm::conjugate(q_WS_) * glm::dvec3{0.0, 0.0, 1.0});
    w += gain_ * error;
    bias_ -= bias_gain_ * seconds * error;
  }
  const double half = 0.5 * seconds * base::hypot(w.x, w.y, w.z);
  const glm::dvec3 turn = 0.5 * seconds * base::sinc(half) * w;
  q_WS_ = glm::normalize(q_WS_ * glm::dquat{base::cos(half), turn.x, turn.y, turn.z});
}

void AttitudeFilter::write(base::ByteWriter& out) const {
  for (const double value : {q_WS_.w, q_WS_.x, q_WS_.y, q_WS_.z, bias_.x, bias_.y, bias_.z}) out.put(value);
}

void AttitudeFilter::read(base::ByteReader& in) {
  for (double* value : {&q_WS_.w, &q_WS_.x, &q_WS_.y, &q_WS_.z, &bias_.x, &bias_.y, &bias_.z})
    *value = in.get<double>();
}

}  // namespace sf::sensors
