#pragma once
// A lane as an arc, tracked by an extended Kalman filter from painted points beside it. The filter moves with the
// robot's own twist. Points are weighted by Tukey's function of their distance from the expected line (iteratively
// reweighted least squares), so that other paint within the view has no effect.

#include <cstddef>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_double4.hpp>
#include <span>

#include "base/pose.h"

namespace sf::vision {

/// A lane of constant curvature and width, relative to a robot R (x ahead, y left).
struct Lane {
  double offset = 0.0;     ///< [m] of the robot's origin from the lane's middle, to the left
  double heading = 0.0;    ///< [rad] of the robot from that of the lane, counter-clockwise
  double curvature = 0.0;  ///< [1/m] positive: the lane bends to the left
  double width = 0.0;      ///< [m] between the middles of its edges
};

/// Distance [m] of a point from the middle of a lane, positive to the left.
/// @param p [m] in R, nearer to the lane than the centre of its arc
double left_of_middle(const Lane& lane, glm::dvec2 p);

/// Lanes that a tracker expects.
struct LaneLimits {
  double scale = 1.0;  ///< of the following lengths, and of the tracker's errors; 7 for roads at full size
  double narrowest = 0.25, widest = 0.8;  ///< [m]
  double sharpest = 1.2;                  ///< [1/m] curvature
  double row = 0.005;                     ///< [m] from one row of points to the next, in all scales
};

/// Not thread-safe. Results depend on its calls only.
class LaneTracker {
 public:
  explicit LaneTracker(const LaneLimits& limits) : limits_(limits) {}

  bool has_lane() const { return has_lane_; }
  /// The estimate at the last call of `move` or `update`. @pre has_lane()
  const Lane& lane() const { return lane_; }
  /// [m] Returns the standard deviation of the offset. @pre has_lane()
  double sigma() const;

  /// Moves the robot. Forgets the lane once its offset is unknown by a quarter of its width.
  /// @param twist in R, of a robot that does not move to its side
  void move(const base::Twist& twist, double seconds);
  /// Corrects the estimate by the painted points [m] in R of one image, or searches for a lane around the robot, which
  /// needs both of its edges.
  /// @return whether the lane was seen: the image has enough of an edge
  bool update(std::span<const glm::dvec2> points);

 private:
  bool search(std::span<const glm::dvec2> points);
  bool correct(std::span<const glm::dvec2> points);

  LaneLimits limits_;
  bool has_lane_ = false;
  Lane lane_;
  glm::dmat4 covariance_{};  ///< of offset, heading, curvature, width
};

}  // namespace sf::vision
