#pragma once
// Localization: a robot's pose from its own sensors, as a derived sensor (docs/derived.md).
//
// In a world file, inside a robot:
//   derived( type "localization"  inputs ["encoder" "gyro" "gps"]  rate 20  noise [0.05 1.1] )
// Inputs: at most one encoder, gyro and gps, with the errors that their settings state (in place of the gyro an imu, of
// which the rate about the robot's z axis is used), and up to four sensors whose
// columns begin with x_m, y_m, yaw_rad, and up to four fiducial finders, whose landmarks are the fiducials that stand
// still. `noise`: standard deviations of such a pose that states no covariance. It needs an encoder, a gps, a pose or a
// fiducial finder.
//
// A reading is one row: x, y and yaw of the robot's origin in the world frame, whether they are valid, and their
// covariance. Not valid: before the first pose or position. A run that starts with the sensor gives it the start pose.

#include <array>
#include <optional>

#include "robots/estimation/localization.h"
#include "sensors/encoder.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kLocalization = 32;  ///< wire id

/// The sensors by which a robot estimates its own pose: the first of each type, or the inputs of a localization.
struct PositionSensors {
  std::optional<Encoder> wheels;  ///< as the robot knows them: without the error `scale`
  std::optional<Gyro> gyro;
  std::optional<Gps> gps;
  std::array<double, 3> periods{}, latencies{};  ///< [s] of encoder, gyro and gps

  /// @param kind 0: an encoder, 1: a gyro, 2: a gps
  /// @throws base::InputError for invalid settings
  void add(std::size_t kind, const world::Sensor& settings, const world::Mover& mover);
};
estimation::LocalizationOptions localization_options(const world::Mover& mover, const PositionSensors& sensors);

/// Returns the position of the robot's origin, given that of an antenna. @param p_MS [m] antenna in the robot's frame
inline glm::dvec2 origin_of(const glm::dvec2& antenna, double yaw, const glm::dvec2& p_MS) {
  return antenna - base::rotate(yaw, p_MS);
}

extern const SensorType localization_type;

}  // namespace sf::sensors
