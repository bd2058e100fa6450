#pragma once
// The pose from which landmarks were seen by range and bearing.

#include <optional>
#include <span>

#include "robots/estimation/wheeled_state.h"

namespace sf::estimation {

/// Probability with which correct sightings are refused.
inline constexpr double kSightingsGate = 1e-4;
inline constexpr double kMostHeadingSigma =
    0.1;  ///< [rad] of a pose by sightings: beyond, its covariance is not an ellipse

/// Returns the pose at the time of the sightings, with the covariance that follows from theirs (weighted least
/// squares), as a measurement. nullopt if they are fewer than two, if they contradict each other (the sum of squared
/// residuals is beyond the chi-square limit of kSightingsGate), or if the heading's standard deviation exceeds
/// kMostHeadingSigma, as with landmarks in one place.
/// @param sightings valid, of one time
std::optional<WheeledMeasurement> pose_of(std::span<const WheeledMeasurement> sightings);

}  // namespace sf::estimation
