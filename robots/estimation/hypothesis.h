#pragma once
// One Gaussian of a sum of Gaussians: splitting by heading, merging, and error moments.
//
// For a free body these functions work on velocities in the world frame, which do not depend on the heading, because
// the body moves on a straight line.

#include <span>
#include <vector>

#include "robots/estimation/kalman.h"

namespace sf::estimation {

struct Hypothesis {
  double weight = 1.0;  ///< probability, in [0, 1]
  Estimate estimate;
};

/// [rad] Returns the standard deviation of the heading, and so of the path's direction, in the middle of a step of `dt`
/// [s].
double middle_heading_sigma(const Estimate& estimate, double dt);

/// Appends three to nine parts whose headings have standard deviation `narrow` in the middle of a step of `dt`, the
/// central part first. Their sum has the mean and the covariance of `whole`.
/// @param narrow [rad] in (0, middle_heading_sigma)
void split(const MotionModel& model, const Hypothesis& whole, double dt, double narrow, std::vector<Hypothesis>& parts);

/// Returns the Gaussian with the mean and the covariance of `parts`, whose headings are close to that of the first.
/// @param parts not empty, all at the same time
Hypothesis merged(const MotionModel& model, std::span<const Hypothesis> parts);

/// Same as `correct` of kalman.h, except that for a free body without a measured velocity it updates the velocity in
/// the world frame exactly.
Estimate correct(const MotionModel& model, const Estimate& predicted, const Measurement& measurement);

/// Adds the weighted mean squared error of `state` to `sum`. Yaw errors are wrapped to at most half a turn.
void add_square_error(const Estimate& state, const Hypothesis& truth, Covariance& sum);

}  // namespace sf::estimation
