#pragma once
// The nearest surface above the ground in each column of a lidar or a depth image, as a planar scan, for features
// (docs/derived.md#types).
//
// In each column, from the lowest beam on, an echo is on the ground if the way to it from the last such echo rises by
// at most kGroundStep and kGroundSlope; the first one is below the robot. Echoes that rise by more than kWallSlope are
// not ground for those above them: a wall is not climbed in steps. Other echoes are obstacles if they are at most
// kTallest above the ground there; higher ones are overhead. Inputs are the ranges and the mount alone.
//
// Noisy depths of cameras are smoothed first (depth_smoothing.h). A way counts only as far as it exceeds kDepthSigmas
// of what is left of the noise. Within kGroundStep and as many of these, an obstacle rises by more than ground may, in
// kLeastColumns next to each other, since noise makes single ones of a slope look steep. Its distance is the mean
// there: the error of the nearest depth is towards the camera.

#include <cmath>
#include <span>
#include <vector>

#include "sensorfarm/controller.h"
#include "sensors/camera_settings.h"
#include "sensors/depth_smoothing.h"
#include "sensors/lidar_beams.h"

namespace sf::sensors {

inline constexpr double kGroundStep = 0.2;    ///< [m]
inline constexpr double kGroundSlope = 0.25;  ///< [-]
inline constexpr double kWallSlope = 1.0;     ///< [-]
inline constexpr double kTallest = 2.0;       ///< [m]
inline constexpr std::size_t kLeastColumns = 3;

/// Not thread-safe.
class BeamColumns {
 public:
  /// @param lidar with rings, at least two
  explicit BeamColumns(const LidarSettings& lidar);
  /// Columns are as wide as a pixel on the optical axis.
  explicit BeamColumns(const CameraSettings& camera);

  /// The sensor in the frame of its robot, and the bearings [rad] of the columns in the sensor's, ascending evenly.
  const base::Pose& X_MS() const { return X_MS_; }
  const std::vector<double>& bearings() const { return bearings_; }
  double step() const { return bearings_.size() > 1 ? bearings_[1] - bearings_[0] : 2.0 * M_PI; }
  /// Returns per column the horizontal distance [m] of the nearest obstacle, or NaN. Valid until the next call.
  std::span<const double> ranges(const sensorfarm::Reading& reading);

 private:
  struct Beam {
    std::uint32_t row;            ///< in the reading
    double horizontal, vertical;  ///< per range or depth, in the robot's frame
  };
  void set_bearings(double first, double step, std::size_t count);
  void add_beams(const glm::dmat3& R_MS, const LidarBeams& beams, bool depths);
  void take(const sensorfarm::Reading& reading);
  double obstacle(std::span<const Beam> column);
  double steep_obstacle();
  void drop_narrow();
  double slack(double distance) const {  ///< [m] of noise
    return kDepthSigmas * kSmoothedNoise * depth_noise_ * distance * distance;
  }

  base::Pose X_MS_;
  base::RangeLimits limits_;
  std::size_t width_;         ///< numbers per beam of a reading
  std::uint32_t across_ = 0;  ///< [px] width of an image
  double depth_noise_ = 0.0;  ///< [1/m] as CameraSettings::depth_noise
  std::vector<double> bearings_, ranges_;
  std::vector<glm::dvec2> obstacles_;       ///< [m] of a column: distance and height
  std::vector<double> values_, before_;     ///< ranges or depths, NaN where there is no valid echo
  std::vector<std::vector<Beam>> columns_;  ///< each from its lowest beam on
};

}  // namespace sf::sensors
