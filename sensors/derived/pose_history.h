#pragma once
// The stated poses of one robot over the last seconds, for derived sensors that place readings of other times.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "sensorfarm/controller.h"
#include "sensors/derived/derived_type.h"

namespace sf::sensors {

/// A pose with its covariance: the upper triangle of x, y, yaw.
struct StatedPose {
  std::int64_t time = 0;  ///< [ns]
  base::Pose X_WM;
  std::array<double, 6> covariance{};
};

class PoseHistory {
 public:
  /// Takes a reading whose columns begin with x_m, y_m, yaw_rad. Without a valid pose it changes nothing; a pose
  /// without a covariance counts as exact.
  void take(const sensorfarm::Reading& reading, const std::vector<std::string>& columns);
  /// Returns the pose at `time`: between two poses, or up to half a second after the newest.
  std::optional<StatedPose> at(std::int64_t time) const;
  /// Returns the velocity in the world frame over the last half second [m/s]; 0 if unknown.
  glm::dvec2 velocity() const;

 private:
  std::deque<StatedPose> poses_;  ///< ascending
};

}  // namespace sf::sensors
