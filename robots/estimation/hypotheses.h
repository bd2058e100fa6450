#pragma once
// The state of an object whose heading may be uncertain, as a sum of Gaussians with narrow headings. A single Gaussian
// cannot represent it: after an unknown turn the position lies on an arc, and a path that was driven forwards is also
// that of the opposite heading driven backwards.
//
// Reference: H. W. Sorenson and D. L. Alspach, Recursive Bayesian estimation using Gaussian sums, Automatica 7, 1971.

#include <vector>

#include "robots/estimation/hypothesis.h"

namespace sf::estimation {

/// All of one time, with weights whose sum is 1. Empty: nothing is known. A certain heading needs one.
using Hypotheses = std::vector<Hypothesis>;

/// [ns] steps of predictions of uncertain headings, and their number; what is left of a longer time is one step.
inline constexpr std::int64_t kHypothesesStep = 100'000'000;
inline constexpr std::int64_t kMostHypothesesSteps = 10;

/// What limits the sums. Rule: most > 0
struct HypothesesLimits {
  std::size_t most = 1;        ///< hypotheses; with 1 each function does what that of kalman.h does
  std::int64_t corrected = 0;  ///< [ns] time of the last measurement
};

/// The state after the first measurement: all headings, where it has none. @param measurement valid, with x and y
void start(const MotionModel& model, const Measurement& measurement, std::size_t most, Hypotheses& all);

/// To 0.05 rad (one standard deviation). Paths are then as good as linear in the errors, and one Gaussian is enough.
bool has_certain_heading(const Estimate& estimate);

/// The state at `time`, later or earlier. Of a single hypothesis whose heading is still certain then: that of kalman.h,
/// to the bit. Otherwise by `advance`.
void predict(const MotionModel& model, std::int64_t time, const HypothesesLimits& limits, Hypotheses& all);

/// The state at `time`, in steps of kHypothesesStep from the last measurement on, in which wide headings are split. It
/// may be called for whole steps first: the result is the same, to the bit.
void advance(const MotionModel& model, std::int64_t time, const HypothesesLimits& limits, Hypotheses& all);

/// The least innovation of all hypotheses: a measurement is an outlier when none explains it.
Innovation innovation(const Hypotheses& predicted, const Measurement& measurement);

/// Corrects each hypothesis, and its weight by the measurement's likelihood. Rule: the innovation is finite
void correct(const MotionModel& model, const Measurement& measurement, const HypothesesLimits& limits, Hypotheses& all);

/// The estimate of the most probable hypothesis; one that drives backwards has to be twice as probable as another.
/// Its covariance leaves the others out.
const Estimate& most_probable(const Hypotheses& all);

/// Mean squares of the errors of `state` over all hypotheses, with yaw wrapped.
Covariance covariance_about(const Estimate& state, const Hypotheses& all);

}  // namespace sf::estimation
