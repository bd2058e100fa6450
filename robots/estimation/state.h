#pragma once
// The state of one object as a filter estimates it, and a measurement of it.

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>

#include "base/pose.h"

namespace sf::estimation {

/// Components of a state, in the order of covariances: x, y [m], yaw [rad] in the world; forward, left [m/s], turn
/// [rad/s] in the object's frame.
enum Component : std::uint8_t { kX, kY, kYaw, kForward, kLeft, kTurn };
inline constexpr std::size_t kComponents = 6;

/// Row by row, symmetric, in products of the components' units.
using Covariance = std::array<double, kComponents * kComponents>;

struct Estimate {
  std::int64_t time = 0;    ///< [ns] at which the state is true
  base::Pose X_WM;          ///< yaw in [-pi, pi]; z is that of the last measurement
  base::Twist velocity;     ///< in the object's frame
  Covariance covariance{};  ///< of the errors of pose and velocity; positive semidefinite
};

/// Bit k of `Measurement::components`: component k.
inline constexpr std::uint8_t kPositionBits = 1u << kX | 1u << kY;
inline constexpr std::uint8_t kPoseBits = kPositionBits | 1u << kYaw;
inline constexpr std::uint8_t kTwistBits = 1u << kForward | 1u << kLeft | 1u << kTurn;

/// Some components of a state as a sensor or another computer measured them.
struct Measurement {
  std::int64_t time = 0;                             ///< [ns] of the measurement, in [0, 2^62]
  std::uint32_t source = 0;                          ///< orders measurements of one time by different senders
  std::uint32_t sequence = 0;                        ///< of the source
  std::uint8_t components = kPoseBits | kTwistBits;  ///< the measured ones; all others are ignored
  base::Pose X_WM;
  base::Twist velocity;
  std::array<double, 6> pose_covariance{1e-4, 0, 0, 1e-4, 0, 1e-4};  ///< xx, xy, x yaw, yy, y yaw, yaw yaw
  std::array<double, 3> twist_variance{1e-4, 1e-4, 1e-4};            ///< of forward, left, turn; uncorrelated
};

/// Total order by time, source, sequence and, last, the bits of all numbers: equal for identical measurements alone.
std::strong_ordering operator<=>(const Measurement& a, const Measurement& b);
inline bool operator==(const Measurement& a, const Measurement& b) { return std::is_eq(a <=> b); }

/// Finite, within 1e9 m (m/s, rad/s), at a time in [0, 2^62], of at least one component, with variances in
/// [1e-18, 1e18] and a positive definite covariance of the pose.
bool is_valid(const Measurement& measurement);

}  // namespace sf::estimation
