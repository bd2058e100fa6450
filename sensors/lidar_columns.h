#pragma once
// The nearest echo above the ground in each column of a lidar, as a planar scan, for features (docs/derived.md#types).
//
// In each column, from the lowest beam on, an echo is on the ground if the way to it from the last such echo rises by
// at most kGroundStep and kGroundSlope; the first one is below the robot. Other echoes are obstacles if they are at
// most kTallest above the ground there; higher ones are overhead. Inputs are the ranges and the mount alone.

#include <span>
#include <vector>

#include "base/echo.h"
#include "sensorfarm/controller.h"
#include "sensors/lidar_beams.h"

namespace sf::sensors {

inline constexpr double kGroundStep = 0.2;    ///< [m]
inline constexpr double kGroundSlope = 0.25;  ///< [-]
inline constexpr double kTallest = 2.0;       ///< [m]

/// Not thread-safe.
class LidarColumns {
 public:
  /// @param lidar with rings, at least two  @param width numbers per beam of its readings
  LidarColumns(const LidarSettings& lidar, std::size_t width);

  /// The sensor in the frame of its robot, and the bearings [rad] of the columns in the sensor's, ascending evenly.
  const base::Pose& X_MS() const { return X_MS_; }
  const std::vector<double>& bearings() const { return bearings_; }
  /// Returns per column the horizontal distance [m] of the nearest obstacle, or NaN. Valid until the next call.
  std::span<const double> ranges(const sensorfarm::Reading& reading);

 private:
  struct Beam {
    std::uint32_t row;            ///< in the reading
    double horizontal, vertical;  ///< per range, in the robot's frame
  };
  void add_beams(const LidarSettings& lidar);
  double obstacle(std::span<const Beam> column, const sensorfarm::Reading& reading) const;

  base::Pose X_MS_;
  base::RangeLimits limits_;
  std::size_t width_;
  std::vector<double> bearings_, ranges_;
  std::vector<std::vector<Beam>> columns_;  ///< each from its lowest beam on
};

}  // namespace sf::sensors
