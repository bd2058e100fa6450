#pragma once
// The state of an object with an uncertain heading, as a sum of Gaussians that each have a narrow heading. A single
// Gaussian cannot represent it: after an unknown turn the position lies on an arc, and driving a path forwards looks
// the same as driving it backwards with the opposite heading.
//
// Reference: H. W. Sorenson and D. L. Alspach, Recursive Bayesian estimation using Gaussian sums, Automatica 7, 1971.

#include <vector>

#include "robots/estimation/hypothesis.h"

namespace sf::estimation {

/// Hypotheses at a common time whose weights sum to 1. Empty: the state is unknown. A certain heading takes one
/// hypothesis.
using Hypotheses = std::vector<Hypothesis>;

/// [ns] Step size for predicting uncertain headings, and the largest number of steps. One last step covers the rest of
/// a longer time.
inline constexpr std::int64_t kHypothesesStep = 100'000'000;
inline constexpr std::int64_t kMostHypothesesSteps = 10;

/// Limits of the sum. Precondition: most > 0
struct HypothesesLimits {
  std::size_t most = 1;        ///< number of hypotheses; 1 gives the results of kalman.h
  std::int64_t corrected = 0;  ///< [ns] time of the last measurement
};

/// Initializes the state from the first measurement. All headings are possible if it has no yaw.
/// @param measurement valid, with x and y
void start(const MotionModel& model, const Measurement& measurement, std::size_t most, Hypotheses& all);

/// Returns whether the heading's standard deviation is at most 0.05 rad. Paths are then practically linear in the
/// errors, and a single Gaussian is enough.
bool has_certain_heading(const Estimate& estimate);

/// Predicts the state at `time`, earlier or later. A single hypothesis whose heading is still certain at `time` gives
/// bitwise the result of kalman.h; all other cases use `advance`.
void predict(const MotionModel& model, std::int64_t time, const HypothesesLimits& limits, Hypotheses& all);

/// Predicts the state at `time` in steps of kHypothesesStep counted from the last measurement, splitting wide headings.
/// Calling it for whole steps first gives a bitwise identical result.
void advance(const MotionModel& model, std::int64_t time, const HypothesesLimits& limits, Hypotheses& all);

/// Returns the smallest innovation over all hypotheses: a measurement is an outlier only if no hypothesis explains it.
Innovation innovation(const Hypotheses& predicted, const Measurement& measurement);

/// Corrects each hypothesis, and reweights it by the measurement's likelihood. Precondition: the innovation is finite
void correct(const MotionModel& model, const Measurement& measurement, const HypothesesLimits& limits, Hypotheses& all);

/// Returns the estimate of the most probable hypothesis. A hypothesis that drives backwards has to be twice as probable
/// as another. The covariance is that of this hypothesis only.
const Estimate& most_probable(const Hypotheses& all);

/// Returns the mean squared errors of `state` over all hypotheses, with yaw wrapped.
Covariance covariance_about(const Estimate& state, const Hypotheses& all);

}  // namespace sf::estimation
