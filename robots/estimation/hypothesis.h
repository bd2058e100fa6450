#pragma once
// One Gaussian of a sum of Gaussians: splitting it by its heading, merging some into one, and its errors.
//
// Of a free body these work on velocities in the world, which do not depend on its heading: it moves on a straight
// line.

#include <span>
#include <vector>

#include "robots/estimation/kalman.h"

namespace sf::estimation {

struct Hypothesis {
  double weight = 1.0;  ///< probability, in [0, 1]
  Estimate estimate;
};

/// [rad] standard deviation of the heading in the middle of a step of `dt` [s]: the direction of the path.
double middle_heading_sigma(const Estimate& estimate, double dt);

/// Appends three to nine parts with `narrow` headings in the middle of a step of `dt`; the middle part first. Together
/// they have the mean and the covariance of the whole. @param narrow [rad] in (0, middle_heading_sigma)
void split(const MotionModel& model, const Hypothesis& whole, double dt, double narrow, std::vector<Hypothesis>& parts);

/// The Gaussian with the mean and the covariance of `parts`, whose headings are near that of the first.
/// @param parts not empty, of one time
Hypothesis merged(const MotionModel& model, std::span<const Hypothesis> parts);

/// As `correct` of kalman.h. Of a free body without a measured velocity it is the exact update of the velocity in the
/// world.
Estimate correct(const MotionModel& model, const Estimate& predicted, const Measurement& measurement);

/// Adds the weighted mean square of the errors of `state` to `sum`. Errors of yaw are wrapped, so that no heading is
/// more than half a turn wrong.
void add_square_error(const Estimate& state, const Hypothesis& truth, Covariance& sum);

}  // namespace sf::estimation
