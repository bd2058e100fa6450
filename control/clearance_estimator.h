#pragma once
// Estimates the free space around a robot from the scans of its lasers, for any number of lasers, fields of view and
// ranges.

#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "sensors/sensor_type.h"
#include "world/world.h"

namespace sf::control {

/// Free space within sensor range.
struct Clearance {
  double ahead = 0.0;  ///< [m] from the body's front to the first obstacle in the swept lane; >= 0
  double left = 0.0;   ///< [m] mean free length of the beams to the left, in [0, range()]
  double right = 0.0;  ///< [m] the same to the right
};

class ClearanceEstimator {
 public:
  /// @param lasers of the mover, in the order of their numbers
  ClearanceEstimator(const world::Mover& mover, std::span<const sensors::SensorSpec> lasers);

  /// Returns the sensor range ahead of the body [m]; 0 without a laser that covers the forward direction.
  double range() const { return range_; }

  /// Ignores readings of other types or sensors, and NaN ranges. A range at or beyond range_max counts as free. Without
  /// readings the way ahead is free and left equals right.
  Clearance estimate(std::span<const base::ReadingBlock> readings) const;

 private:
  struct Beam {
    std::uint32_t sample;
    float x, y;  ///< direction in the robot's frame
  };
  struct View {
    glm::dvec2 p_MS;
    double range_max;
    std::uint32_t first, end;  ///< its beams
  };
  struct Sum;
  void add(const View& view, std::span<const double> ranges, Sum& sum) const;

  std::vector<View> views_;  ///< one per laser
  std::vector<Beam> beams_;  ///< beams of all lasers
  double front_ = 0.0;       ///< [m] from the origin to the body's front
  double half_width_ = 0.0;  ///< [m] half the width of the lane that the body needs
  double range_ = 0.0;
};

}  // namespace sf::control
