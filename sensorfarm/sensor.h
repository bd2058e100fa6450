#pragma once
// Your own sensors: a type, its settings in world files, and one function that measures, on the host or with your own
// Vulkan kernel (docs/own_controller.md).

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sensorfarm/types.h"

namespace sensorfarm {

/// Reads properties of a sensor in a world file. Each function returns the fallback if the key is absent. Values of
/// another type or outside [least, most] are errors with file and line.
class SensorSettings {
 public:
  virtual ~SensorSettings() = default;
  virtual double number(std::string_view key, double fallback, double least, double most) const = 0;
  virtual double length(std::string_view key, double fallback, double least, double most) const = 0;  ///< [m]
  virtual double angle(std::string_view key, double fallback, double least, double most) const = 0;   ///< [rad]
  virtual std::string text(std::string_view key, const std::string& fallback) const = 0;
  /// Stops the load with that message at the key's line.
  [[noreturn]] virtual void refuse(std::string_view key, const std::string& message) const = 0;
};

/// One sensor of a world file.
struct SensorSite {
  std::string name;          ///< unique among its robot's sensors
  std::uint32_t robot = 0;   ///< row of its robot
  std::uint32_t number = 0;  ///< 0-based among the robot's sensors of this type
  Pose X_RS;                 ///< pose of the sensor in the robot's frame; z is the foot of its model
  double height = 0.0;       ///< [m] height of its model
};

/// A point where a ray meets a surface.
struct Hit {
  double range = 0.0;           ///< [m]; the ray's length if it meets no surface
  std::uint32_t model = kNone;  ///< index of the model, or kNone if it meets no surface
};

/// The surroundings of a sensor at the time of its measurement.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  /// Returns the nearest surface along a horizontal ray, computed in 64 bits as for lasers in mode `exact`. Ignores the
  /// sensor's own robot.
  /// @param bearing [rad] in the world  @param range [m] >= 0, finite
  virtual Hit cast(double x, double y, double z, double bearing, double range) const = 0;
  virtual std::size_t robots() const = 0;             ///< number of rows: robots and tags
  virtual Pose pose(std::size_t row) const = 0;       ///< not finite if absent
  virtual Twist velocity(std::size_t row) const = 0;  ///< in its own frame
  /// Returns two independent numbers of a standard normal distribution, which depend only on seed, sensor, reading and
  /// `draw`; zero if noise is off.
  virtual std::array<double, 2> normal(std::uint32_t draw) const = 0;
};

/// One measurement to take.
struct Measurement {
  double time = 0.0;  ///< [s]
  Pose X_WS;          ///< pose of the sensor; z is fixed at load
  const Surroundings& around;
};

/// One sensor. Measurements of different sensors run in parallel, so a measurement must not change its object.
class Sensor {
 public:
  virtual ~Sensor() = default;
  /// Returns the rows of a reading, at least 1. Called once.
  virtual std::uint32_t elements() const { return 1; }
  /// Returns numbers for the kernel, at each measurement. Not used without a kernel.
  virtual std::array<double, 8> parameters() const { return {}; }
  /// Fills in a reading, row by row. With a kernel, `values` contains the kernel's results, which may be left
  /// unchanged. An exception ends the run with its message.
  virtual void read(const Measurement& measurement, std::span<double> values) const = 0;
};

/// One number of a row.
struct SensorColumn {
  std::string name;    ///< name with its unit: "distance_m"
  double unit = 1e-3;  ///< > 0: resolution of the number in packets, which hold 32 bits
};

/// A sensor type.
struct SensorEntry {
  std::string name;                   ///< keyword in world files, name in commands, JSON and recordings
  std::uint8_t id = 0;                ///< in packets: 13 to 26, not that of another type
  std::vector<SensorColumn> columns;  ///< at least one
  std::vector<std::string> keys;      ///< its own properties in world files, in addition to `rate`, `phase`, `latency`,
                                      ///< `pose`
  double rate = 10.0;                 ///< [Hz] default
  /// SPIR-V file of a kernel, relative to the plug-in's file; empty: none. For its tables see
  /// shaders/lib/own_sensor.glsl.
  std::string kernel;
  std::function<std::unique_ptr<Sensor>(const SensorSite&, const SensorSettings&)> make;
};

}  // namespace sensorfarm
