#pragma once
// What a robot's lasers say about the way ahead, whatever their number, fields of view and ranges.

#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "world/world.h"

namespace sf::control {

/// Free space as far as the sensors tell.
struct Clearance {
  double ahead = 0.0;  ///< [m] from the body's front to the first thing in the robot's way; >= 0
  double left = 0.0;   ///< [m] mean free length over the beams to the left, in [0, sight]
  double right = 0.0;  ///< [m] the same to the right
};

class ClearanceEstimator {
 public:
  explicit ClearanceEstimator(const world::Mover& mover);

  /// How far ahead of the body the sensors see. [m]; 0: there is none that looks forward
  double range() const { return range_; }

  /// Readings of other kinds or sensors are left out. A range that is not a number says nothing; one at or beyond
  /// range_max says that the beam is free. No readings: free ahead, as far left as right.
  Clearance estimate(std::span<const base::ReadingBlock> readings) const;

 private:
  struct Beam {
    std::uint32_t sample;
    float x, y;  ///< direction in the robot's frame
  };
  struct View {
    glm::dvec2 p_MS;
    double range_max;
    std::vector<Beam> beams;
  };
  struct Sum;
  void add(const View& view, std::span<const double> ranges, Sum& sum) const;

  std::vector<View> views_;  ///< one per laser
  double front_ = 0.0;       ///< [m] from the origin to the body's front
  double half_width_ = 0.0;  ///< [m] of the lane the body needs
  double range_ = 0.0;
};

}  // namespace sf::control
