#pragma once
// The pose of a robot with two driven wheels from its own sensors: satellite positions, wheel encoders and a gyro.
//
//   Localization localization({.encoder = {.track = 0.258, .slip = 0.005}}, X_WM, 0);
//   localization.add_encoder(time, left, right);      // of each reading
//   localization.add_gps(time, x, y, hdop);           // without a fix: ignored
//   localization.predict(time).estimate.X_WM
//
// Encoders and gyro go on where satellites are out of sight. The gyro's bias is its mean difference from the
// encoders' turn rate, best known after a stand of more than a second.

#include <cstdint>
#include <optional>

#include "robots/estimation/track_filter.h"

namespace sf::estimation {

/// Errors of the sensors, as in their settings. Rule: all finite.
struct LocalizationOptions {
  struct {
    double per_count = 1e-3;  ///< [m] > 0
    double slip = 0.005;      ///< [m^(1/2)] >= 0 of a wheel after a metre
    double track = 0.258;     ///< [m] > 0, effective
  } encoder;
  struct {
    double noise = 1.7e-3;  ///< [rad/s] >= 0 standard deviation of a reading
    double bias = 8.7e-3;   ///< [rad/s] >= 0 likewise of the constant offset
  } gyro;
  double gps_noise = 1.5;        ///< [m] > 0 standard deviation of a range
  double start_position = 0.05;  ///< [m] > 0 standard deviation of the start pose
  double start_yaw = 0.02;       ///< [rad] > 0
};

/// Allocates in the constructor alone. One thread.
class Localization {
 public:
  Localization(const LocalizationOptions& options, const base::Pose& X_WM, std::int64_t time);

  // One reading at its own time [ns], each sensor's in order, GPS up to one second late where all sensors together have
  // at most 500 readings a second. Readings that are not numbers are ignored, outliers counted and refused.
  /// @param left, right [m] rolled since the start. The speeds since the last reading count at the middle of the time
  void add_encoder(std::int64_t time, double left, double right);
  /// @param rate [rad/s]
  void add_gyro(std::int64_t time, double rate);
  /// @param x, y [m] in the world, of an antenna above the robot's origin @param hdop NaN without a fix
  void add_gps(std::int64_t time, double x, double y, double hdop);

  /// Stale after a minute without any used reading. Positions that the gate refuses for a minute start it anew.
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
  std::int64_t last_count_ = 0;      ///< [ns] of the last reading that differs from the one before, or the first
  std::optional<Turn> wheels_turn_;  ///< since the last reading of the gyro
  double bias_ = 0.0;                ///< [rad/s] of the gyro
  double bias_variance_;             ///< [rad^2/s^2]
  std::uint32_t sequence_ = 0;
};

}  // namespace sf::estimation
