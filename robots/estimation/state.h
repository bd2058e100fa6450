#pragma once
// The estimated state of one object, and measurements of it.

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/pose.h"

namespace sf::estimation {

/// Components of a state, in the order used by covariances: x, y [m], yaw [rad] in the world frame; forward, left
/// [m/s], turn [rad/s] in the object's frame.
enum Component : std::uint8_t { kX, kY, kYaw, kForward, kLeft, kTurn };
inline constexpr std::size_t kComponents = 6;

/// Row-major, symmetric, in products of the components' units.
using Covariance = std::array<double, kComponents * kComponents>;

struct Estimate {
  std::int64_t time = 0;    ///< [ns] time of the state
  base::Pose X_WM;          ///< yaw in [-pi, pi]; z of the last measurement
  base::Twist velocity;     ///< in the object's frame
  Covariance covariance{};  ///< of the pose and velocity errors; positive semidefinite
};

/// Bit k of `Measurement::components`: component k.
inline constexpr std::uint8_t kPositionBits = 1u << kX | 1u << kY;
inline constexpr std::uint8_t kPoseBits = kPositionBits | 1u << kYaw;
inline constexpr std::uint8_t kTwistBits = 1u << kForward | 1u << kLeft | 1u << kTurn;

/// Some components of a state, as measured by a sensor or another computer.
struct Measurement {
  std::int64_t time = 0;                             ///< [ns] of the measurement, in [0, 2^62]
  std::uint32_t source = 0;                          ///< orders simultaneous measurements by different senders
  std::uint32_t sequence = 0;                        ///< sequence number at the source
  std::uint8_t components = kPoseBits | kTwistBits;  ///< measured components; the others are ignored
  base::Pose X_WM;
  base::Twist velocity;
  std::array<double, 6> pose_covariance{1e-4, 0, 0, 1e-4, 0, 1e-4};  ///< xx, xy, x yaw, yy, y yaw, yaw yaw
  std::array<double, 3> twist_variance{1e-4, 1e-4, 1e-4};            ///< of forward, left, turn; uncorrelated
};

/// Total order by time, source, sequence and finally the bits of all numbers. Only identical measurements are equal.
std::strong_ordering operator<=>(const Measurement& a, const Measurement& b);
inline bool operator==(const Measurement& a, const Measurement& b) { return std::is_eq(a <=> b); }

/// Covariance of a pose: xx, xy, x yaw, yy, y yaw, yaw yaw [m^2, m rad, rad^2].
using PoseCovariance = std::array<double, 6>;

/// Returns the covariance of a point fixed to a body, given that of another. @param arm [m] from the known point to the
/// other, in the world frame
PoseCovariance moved(const PoseCovariance& covariance, const glm::dvec2& arm);

/// Returns the covariance in a packet if it is positive definite with variances of at least (0.1 mm)^2 and (0.1
/// mrad)^2, which smaller ones are raised to; nullopt if it is not, or all zeros (unknown).
std::optional<PoseCovariance> stated_covariance(const std::array<float, 6>& stated);

/// Returns whether the measurement is finite, within 1e9 m (m/s, rad/s), at a time in [0, 2^62], and has at least one
/// component, variances in [1e-18, 1e18] and a positive definite pose covariance.
bool is_valid(const Measurement& measurement);

}  // namespace sf::estimation
