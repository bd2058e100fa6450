#pragma once
// Error bounds of cast ranges.

#include "raycast/records.h"

namespace sf::raycast {

/// A beam grazes a surface if the sine of the angle between them is below this value. Its error may exceed
/// `exact_bound`.
inline constexpr double kMinSine = SF_MIN_SINE;

/// Returns the largest error [m] of the 64-bit range of a beam that does not graze a surface, relative to real
/// arithmetic on the doubles of the world and the pose. With u = 2^-53: the errors of numerator and denominator of t =
/// (e x w) / (e x d) are at most 4 u |e| |w| and 9 u |e|, |w| <= range + longest; transformed outlines add 4 u
/// farthest; contact adds SF_CONTACT_DISTANCE.
/// @param longest [m] length of the longest surface  @param farthest [m] largest coordinate of any surface in range
inline constexpr double exact_bound(double range_max, double longest, double farthest) {
  return SF_CONTACT_DISTANCE + 0x1p-53 * (16.0 * (range_max + longest) + 4.0 * farthest) / kMinSine;
}

/// Returns the additional error [m] of a 32-bit range.
inline double single_bound(double range_max) { return range_max * (0.51 * SF_SINGLE_TOLERANCE + 0x1p-22); }

}  // namespace sf::raycast
