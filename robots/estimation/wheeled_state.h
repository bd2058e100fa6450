#pragma once
// An extended Kalman filter of a robot with two driven wheels, whose state includes the constants of its own sensors:
// the scales of both encoders, the track, and the gyro's bias and scale. All functions are pure and do not allocate.
//
// The distances that the encoders count are part of the state, so each reading measures them absolutely: lost and late
// readings lose no distance, and rounding does not accumulate.
//
// Reference: J. Borenstein and L. Feng, Measurement and correction of systematic odometry errors in mobile robots, IEEE
// Transactions on Robotics and Automation 12, 1996, for the constants; see kalman.h for the filter.

#include <array>
#include <compare>
#include <cstdint>

#include "robots/estimation/kalman.h"

namespace sf::estimation {

/// Components after those of Component.
enum WheeledComponent : std::uint8_t {
  kLeftRolled = kComponents,  ///< [m] counted by the left encoder, including scale and slip
  kRightRolled,               ///< [m]
  kLeftScale,                 ///< [-] metres counted per metre rolled
  kRightScale,                ///< [-]
  kTrackScale,                ///< [-] effective track over the nominal one
  kGyroBias,                  ///< [rad/s]
  kGyroScale,                 ///< [-] measured turn rate, without the bias, over the true one
  kWheeledComponents
};

struct WheeledModel {
  MotionModel motion;  ///< an arc
  /// Speeds change at once after a reading and are then constant until the next, as between commands; the mean speed
  /// from the encoders is then the speed itself. False: they change continuously.
  bool steps = true;
  double track = 0.3;     ///< [m] > 0, nominal
  double slip = 0.005;    ///< [m^(1/2)] >= 0 standard deviation of a wheel's slip after one metre
  double axle = 0.0;      ///< [m] from the rear axle to the origin, which turns move sideways
  double sideslip = 0.0;  ///< [s^2/m] >= 0 slip angle of the rear tyres over the lateral acceleration, in steady turns
  double skid = 0.0003;   ///< [m^(1/2)] >= 0 standard deviation of a sideways skid after one metre
  double drift = 1e-6;    ///< [s^(-1/2)] >= 0 standard deviation of the change of a scale after one second
  double bias_drift = 1e-5;  ///< [rad s^(-3/2)] >= 0 the same of the gyro's bias
};

struct WheeledState {
  std::int64_t time = 0;                        ///< [ns]
  double z = 0.0;                               ///< [m] of the last measured pose
  std::array<double, kWheeledComponents> mean;  ///< in the units of the components; yaw in [-pi, pi]
  std::array<double, kWheeledComponents * kWheeledComponents> covariance{};  ///< row-major, symmetric
};

/// One reading of a sensor.
struct WheeledMeasurement {
  /// Poses come first among simultaneous readings, so that a start precedes the first encoder reading.
  enum class Kind : std::uint8_t {
    pose,      ///< values: x, y [m], yaw [rad] in the world frame
    position,  ///< values: x, y [m] in the world frame
    gyro,      ///< value: rate [rad/s]
    encoder,   ///< values: left, right [m] rolled since the start
    sighting   ///< values: x, y [m] of `landmark` in the robot's frame
  };
  std::int64_t time = 0;  ///< [ns] in [0, 2^62]
  Kind kind = Kind::pose;
  std::uint32_t sequence = 0;          ///< order of arrival of equal readings
  std::array<double, 3> values{};      ///< as stated by `kind`; the others are 0
  std::array<double, 6> covariance{};  ///< of the values: 11, 12, 13, 22, 23, 33
  double z = 0.0;                      ///< [m] of a pose
  std::array<double, 2> landmark{};    ///< [m] world frame

  auto operator<=>(const WheeledMeasurement&) const = default;
};

/// Returns whether the measurement is finite, within 1e9, with positive variances in [1e-18, 1e18] and a positive
/// definite covariance.
bool is_valid(const WheeledMeasurement& measurement);

/// Returns the state at `time`, earlier or later.
WheeledState predict(const WheeledModel& model, const WheeledState& state, std::int64_t time);

/// Returns the difference between a measurement and a state at the same time, in standard deviations.
Innovation innovation(const WheeledState& predicted, const WheeledMeasurement& measurement);

/// Applies a measurement to a state at the same time, in Joseph form.
WheeledState correct(const WheeledState& predicted, const WheeledMeasurement& measurement);

/// Replaces the measured components and their covariance, and removes their correlation with all others.
/// @pre a pose, a position or an encoder's reading
void replace(WheeledState& state, const WheeledMeasurement& measurement);

/// Sets the component's variance, and removes its correlation with all others.
void set_variance(WheeledState& state, std::size_t component, double variance);

/// Sets the covariance of two components.
void set_covariance(WheeledState& state, std::size_t a, std::size_t b, double covariance);

/// Returns the Gaussian with the mean and the covariance of two, whose headings are close.
WheeledState merged(double weight_a, const WheeledState& a, double weight_b, const WheeledState& b);

/// Returns the state's pose and velocity.
Estimate estimate_of(const WheeledState& state);

}  // namespace sf::estimation
