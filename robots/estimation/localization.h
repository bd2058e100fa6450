#pragma once
// Localizes a robot with two driven wheels from its own sensors: satellite positions, wheel encoders and a gyro.
//
//   Localization localization({.encoder = {.track = 0.258, .slip = 0.005}}, X_WM, 0);
//   localization.add_encoder(time, left, right);      // for each reading
//   localization.add_gps(time, x, y, hdop);           // without a fix: ignored
//   localization.predict(time).estimate.X_WM
//
// Encoders and gyro carry the estimate where satellites are out of sight. The gyro's bias is estimated as its mean
// difference from the encoders' turn rate, most accurately after the robot has been at rest for more than a second.

#include <cstdint>
#include <optional>

#include "robots/estimation/track_filter.h"

namespace sf::estimation {

/// Sensor errors, as in the sensors' settings. All values are finite.
struct LocalizationOptions {
  struct {
    double per_count = 1e-3;  ///< [m] > 0
    double slip = 0.005;      ///< [m^(1/2)] >= 0 standard deviation of a wheel's slip after one metre
    double track = 0.258;     ///< [m] > 0, effective
  } encoder;
  struct {
    double noise = 1.7e-3;  ///< [rad/s] >= 0 standard deviation of a reading
    double bias = 8.7e-3;   ///< [rad/s] >= 0 standard deviation of the constant offset
  } gyro;
  double gps_noise = 1.5;        ///< [m] > 0 standard deviation of a range
  double start_position = 0.05;  ///< [m] > 0 standard deviation of the start pose
  double start_yaw = 0.02;       ///< [rad] > 0
};

/// Allocates only in the constructor. Not thread-safe.
class Localization {
 public:
  Localization(const LocalizationOptions& options, const base::Pose& X_WM, std::int64_t time);

  // Each call adds one reading taken at `time` [ns]. Readings of one sensor arrive in order. GPS readings may be up to
  // one second late if all sensors together have at most 500 readings a second. Non-finite readings are ignored;
  // outliers are counted and rejected.
  /// @param left, right [m] rolled since the start. The mean speeds since the last reading apply to the middle of the
  /// interval.
  void add_encoder(std::int64_t time, double left, double right);
  /// @param rate [rad/s]
  void add_gyro(std::int64_t time, double rate);
  /// @param x, y [m] world frame, of an antenna above the robot's origin
  /// @param hdop NaN without a fix
  void add_gps(std::int64_t time, double x, double y, double hdop);

  /// Returns the estimate at `time`. It becomes stale after a minute without a used reading. Positions that the gate
  /// has rejected for a minute restart the track.
  Prediction predict(std::int64_t time) const { return filter_.predict(time); }
  const VerdictCounts& counts() const { return filter_.counts(); }

 private:
  struct Rolled {
    std::int64_t time = 0;  ///< [ns]
    double left = 0.0;      ///< [m]
    double right = 0.0;     ///< [m]
  };
  struct Turn {
    std::int64_t time = 0;  ///< [ns]
    double rate = 0.0;      ///< [rad/s]
    double variance = 0.0;  ///< [rad^2/s^2]
  };
  Verdict take(std::uint32_t source, Measurement measurement);
  void learn_bias(std::int64_t time, double rate, double noise);

  LocalizationOptions options_;
  TrackFilter filter_;
  std::optional<Rolled> last_;
  std::int64_t last_count_ = 0;  ///< [ns] time of the last reading that differed from its predecessor, or of the first
  std::optional<Turn> wheels_turn_;  ///< since the last reading of the gyro
  double bias_ = 0.0;                ///< [rad/s] of the gyro
  double bias_variance_;             ///< [rad^2/s^2]
  std::uint32_t sequence_ = 0;
};

}  // namespace sf::estimation
