#pragma once
// Localizes a robot with its own sensors: wheel encoders, a gyro, satellite positions, poses from cameras, and
// sightings of landmarks.
//
//   Localization localization({.encoder = Localization::Encoder{.track = 0.258, .slip = 0.005}});
//   localization.add_pose(time, X_WM, covariance);    // a known start, or a camera's pose
//   localization.add_encoder(time, left, right);      // for each reading
//   localization.add_gps(time, x, y, hdop);           // without a fix: ignored
//   localization.predict(time).estimate.X_WM
//
// Encoders and gyro carry the estimate where neither cameras nor satellites see the robot, with growing covariance.
// Their constants (scales, track, bias) are estimated along with the pose. Poses and positions may be late and out of
// order. A start without a heading, as from satellites alone, is estimated by several hypotheses until the robot's path
// shows the heading. Two landmarks that are seen at one time start a pose (landmark_pose.h).

#include <cstdint>
#include <optional>
#include <vector>

#include "robots/estimation/measurement_window.h"
#include "robots/estimation/track_filter.h"
#include "robots/estimation/wheeled_state.h"

namespace sf::estimation {

/// Sensor errors, as in the sensors' settings. All values are finite.
struct LocalizationOptions {
  struct Encoder {
    double per_count = 1e-3;  ///< [m] > 0
    /// [rad] >= 0. 0: each wheel is counted, rounded to the nearest count. > 0: distance and angle are reported in
    /// steps of `per_count` and of this, and may be truncated: errors of up to a whole step to either side.
    double angle_step = 0.0;
    double slip = 0.005;             ///< [m^(1/2)] >= 0 standard deviation of a wheel's slip after one metre
    double track = 0.258;            ///< [m] > 0, nominal
    double scale_sigma = 0.05;       ///< [-] >= 0 standard deviation of the wheels' common unknown scale
    double difference_sigma = 0.01;  ///< [-] >= 0 standard deviation of the difference between both scales
    double track_sigma = 0.05;       ///< [-] >= 0 standard deviation of the unknown track, relative to `track`
  };
  struct Gyro {
    double noise = 1.7e-3;  ///< [rad/s] >= 0 standard deviation of a reading
    double bias = 8.7e-3;   ///< [rad/s] >= 0 standard deviation of the constant offset
    double scale = 0.0;     ///< [-] >= 0 standard deviation of the constant error of its scale
  };
  /// A car on tyres: bends move its origin sideways, and slopes and accelerations change the slip of its wheels.
  struct Tyres {
    double axle = 0.0;      ///< [m] from the rear axle to the origin
    double sideslip = 0.0;  ///< [s^2/m] >= 0 slip angle of the rear tyres over the lateral acceleration
    double drift = 3e-3;    ///< [s^(-1/2)] >= 0 standard deviation of the change of a wheel's scale after one second
  };
  std::optional<Encoder> encoder;  ///< nullopt: no encoders
  std::optional<Tyres> tyres;      ///< nullopt: none of this
  Gyro gyro;
  double gps_noise = 1.5;  ///< [m] > 0 standard deviation of a range
  bool sideways = false;   ///< the robot can drive sideways (omni)
  bool learn_slip = true;  ///< slips that last change the encoders' scales
};

/// Covariance of a start pose known to 0.05 m and 0.02 rad.
inline constexpr std::array<double, 6> kKnownStart{2.5e-3, 0.0, 0.0, 2.5e-3, 0.0, 4e-4};

/// A constant of a sensor, as estimated.
struct Constant {
  double value = 0.0;
  double sigma = 0.0;  ///< standard deviation
};

/// The constants of a robot's sensors.
struct Calibration {
  Constant left_scale;   ///< [-] metres counted per metre rolled by the left wheel
  Constant right_scale;  ///< [-]
  Constant track;        ///< [m] effective
  Constant gyro_bias;    ///< [rad/s]
  Constant gyro_scale;   ///< [-] measured turn rate over the true one
};

/// Not thread-safe.
class Localization {
 public:
  explicit Localization(const LocalizationOptions& options);

  // Each call adds one reading taken at `time` [ns], at most `kWindow` before the newest. Non-finite readings are
  // ignored; outliers are counted and rejected. After kRelocated (poses, sightings) or kRelocatedPositions (positions)
  // of nothing but rejected ones, the robot counts as relocated, and the next one restarts the pose.

  /// @param left, right [m] rolled since the start
  Verdict add_encoder(std::int64_t time, double left, double right);
  /// @param rate [rad/s]
  Verdict add_gyro(std::int64_t time, double rate);
  /// @param x, y [m] world frame, of an antenna above the robot's origin
  /// @param hdop NaN without a fix
  Verdict add_gps(std::int64_t time, double x, double y, double hdop);
  /// @param covariance xx, xy, x yaw, yy, y yaw, yaw yaw [m^2, m rad, rad^2], positive definite
  Verdict add_pose(std::int64_t time, const base::Pose& X_WM, const std::array<double, 6>& covariance);

  /// @param landmark [m] its position in the world frame @param seen [m] the same in the robot's frame, as measured
  /// @param covariance xx, xy, yy [m^2] of `seen`, positive definite
  /// @return no_track for sightings that do not determine a pose, alone or with the others of their time
  Verdict add_sighting(std::int64_t time, const glm::dvec2& landmark, const glm::dvec2& seen,
                       const std::array<double, 3>& covariance);

  static constexpr std::int64_t kWindow = 1'000'000'000;               ///< [ns]
  static constexpr std::int64_t kRelocated = 1'000'000'000;            ///< [ns]
  static constexpr std::int64_t kRelocatedPositions = 60'000'000'000;  ///< [ns]

  /// Continues without encoders: their distances no longer bound the motion, and the speeds change as those of a body.
  void pause_encoder() { model_ = model_of(options_, false); }
  /// Uses encoders again. The distance rolled in between does not count: their next reading is a start.
  /// @pre paused for longer than `kWindow`, or no encoder reading is in the window
  void resume_encoder();

  /// Returns the estimate at `time`. Its age is the time since the last used pose, position or sighting. Never
  /// stale.
  Prediction predict(std::int64_t time) const;
  /// Returns the newest estimates of the constants; the initial ones before the first pose.
  Calibration calibration() const;
  const VerdictCounts& counts() const { return window_.counts(); }

 private:
  struct Weighted {
    double weight = 1.0;
    WheeledState state;
  };
  /// Mean of innovations in the direction of motion, relative to their root mean square, which makes it independent of
  /// stated covariances: 0 with a standard deviation of 0.1 unless wheels slip.
  struct Lag {
    double mean = 0.0, square = 0.0;
    int count = 0;
    double innovation_before = 0.0, velocity_before = 0.0;
    void add(double innovation, double velocity, double least);
    bool lasts() const;
  };
  struct State {
    std::int64_t last_fix = 0;                  ///< [ns] time of the last used pose, position or sighting
    glm::dvec2 fixed;                           ///< [m] position at that time
    int rejected = 0;                           ///< poses, positions and sightings rejected since then
    Lag ahead, turned;                          ///< of the fixes, in the directions of driving and turning
    bool rolled = false;                        ///< the encoders' distances are part of the hypotheses
    std::int64_t counted_at = -1;               ///< [ns] of the last encoder reading before that; -1: none
    std::array<double, 2> counted{};            ///< [m] its values
    std::vector<WheeledMeasurement> sightings;  ///< of one time, which may start a pose
    std::vector<Weighted> hypotheses;           ///< weights sum to 1; empty: no pose yet

    bool known() const { return !hypotheses.empty(); }
    std::int64_t time() const { return hypotheses[0].state.time; }
  };

  static WheeledModel model_of(const LocalizationOptions& options, bool encoder);
  Verdict take(WheeledMeasurement measurement);
  Verdict apply(const WheeledMeasurement& measurement, State& state);
  Verdict start(const WheeledMeasurement& measurement, State& state) const;
  Verdict start_by_sightings(const WheeledMeasurement& measurement, State& state) const;
  Verdict reject(const WheeledMeasurement& measurement, State& state) const;
  void start_encoders(const WheeledMeasurement& measurement, State& state) const;
  Innovation weigh(const WheeledMeasurement& measurement);
  void watch_slip(const WheeledMeasurement& measurement, State& state);

  LocalizationOptions options_;
  WheeledModel model_;
  MeasurementWindow<WheeledMeasurement, State> window_;
  std::vector<Weighted> predicted_;  ///< reused
  std::uint32_t sequence_ = 0;
};

}  // namespace sf::estimation
