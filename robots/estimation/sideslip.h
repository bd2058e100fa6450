#pragma once
// Observers of a car's sideslip and of the lateral forces of its tyres, on the single-track model. All functions are
// pure; a MeasurementWindow sorts measurements that arrive late.
//
//   SideslipState state = started(model, 0, 25.0);
//   apply(model, {time, SideslipMeasurement::Kind::steer, 0, 0.02}, state);
//   apply(model, {time, SideslipMeasurement::Kind::turn, 0, 0.11}, state);
//   estimate_of(model, predict(model, state, later)).sideslip
//
// Where the yaw rate does not depend on the sideways speed (l_f C_f = l_r C_r, with the local stiffnesses), no gain can
// pass information from one to the other. The Luenberger and sliding-mode observers then leave the sideways speed to
// the model; the filter's covariance says the same.
//
// References: J. Stephant, A. Charara and D. Meizel, Virtual sensor: application to vehicle sideslip angle and
// transversal forces, IEEE Transactions on Industrial Electronics 51, 2004, for the choice of observers; Y. Bar-Shalom
// and others (kalman.h) for the filter; S. Drakunov and V. Utkin, Sliding mode observers, CDC 1995, for equivalent
// control.

#include <array>
#include <compare>
#include <cstdint>
#include <string_view>

#include "robots/estimation/measurement_window.h"
#include "robots/estimation/single_track.h"

namespace sf::estimation {

enum class SideslipObserver : std::uint8_t {
  luenberger,           ///< linear tyres, speed as measured or as at the start
  extended_luenberger,  ///< Burckhardt's tyres, poles placed at each estimate
  ekf,                  ///< the same model, extended Kalman filter
  sliding_mode          ///< the same model, saturated corrections
};
inline constexpr std::array<std::string_view, 4> kSideslipObservers{"luenberger", "extended-luenberger", "ekf",
                                                                    "sliding-mode"};

struct SideslipModel {
  robots::CarModel car;
  SideslipObserver observer = SideslipObserver::ekf;

  // Filter: standard deviations of measurements, and spectral densities of what the model leaves out. All > 0.
  double turn_noise = 3.5e-3;  ///< [rad/s]
  double speed_noise = 0.05;   ///< [m/s]
  double forward = 0.02;       ///< [m^2/s^3]
  double left = 0.1;           ///< [m^2/s^3]
  double turn = 0.01;          ///< [rad^2/s^3]

  // Other observers.
  double pace = 1.0;         ///< [-] > 0 poles over the frequency of the car's own yaw motion
  double speed_pole = 10.0;  ///< [1/s] > 0 of the speed's error
  double turn_reach = 2.0;   ///< [rad/s^2] > 0 largest correction of a sliding mode; must exceed the disturbances
  double turn_layer = 0.06;  ///< [rad/s] > 0 errors within it are corrected in proportion
  double speed_reach = 2.0;  ///< [m/s^2] > 0 the same of the speed
  double speed_layer = 0.2;  ///< [m/s] > 0

  SingleTrack track() const { return {car, observer == SideslipObserver::luenberger}; }
};

struct SideslipMeasurement {
  /// Inputs come first among simultaneous readings.
  enum class Kind : std::uint8_t {
    steer,   ///< [rad] angle of the front wheels
    torque,  ///< [N m] of engine (> 0) or brakes (< 0)
    speed,   ///< [m/s] forward; the first one starts an observer
    turn     ///< [rad/s] yaw rate
  };
  static constexpr std::size_t kKinds = 4;
  std::int64_t time = 0;  ///< [ns]
  Kind kind = Kind::steer;
  std::uint32_t sequence = 0;  ///< order of arrival of equal readings
  double value = 0.0;          ///< finite

  auto operator<=>(const SideslipMeasurement&) const = default;
};

struct SideslipState {
  std::int64_t at = -1;  ///< [ns] of the mean; -1: not started
  SingleTrackState mean{};
  std::array<double, 9> covariance{};                                          ///< of the filter; symmetric
  SingleTrackInput input;                                                      ///< held until the next one
  std::array<std::int64_t, SideslipMeasurement::kKinds> last{-1, -1, -1, -1};  ///< [ns] of each kind; -1: none

  bool known() const { return at >= 0; }
  std::int64_t time() const { return at; }
};

/// [ns] An observer that gets nothing for longer stops, and starts again with the next speed.
inline constexpr std::int64_t kSideslipGap = 1'000'000'000;

/// Returns an observer of a car that drives straight ahead at a known speed [m/s].
SideslipState started(const SideslipModel& model, std::int64_t time, double speed);

/// Returns the state at `time` with its inputs held; not known beyond kSideslipGap. Earlier times leave it unchanged.
SideslipState predict(const SideslipModel& model, const SideslipState& state, std::int64_t time);

/// Applies a measurement. @return `started`, `used`, `no_track` before the start, or `invalid` if no car could
/// have it
Verdict apply(const SideslipModel& model, const SideslipMeasurement& measurement, SideslipState& state);

struct SideslipEstimate {
  double sideslip = 0.0;  ///< [rad] from forward to the velocity of the centre of gravity, left positive
  AxleForces force;
  std::array<double, 6> covariance{};  ///< upper triangle of sideslip, front and rear force; NaN: none stated
};

/// @param state known
SideslipEstimate estimate_of(const SideslipModel& model, const SideslipState& state);

}  // namespace sf::estimation
