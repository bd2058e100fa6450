#pragma once
// Sensors of your own: a type, its settings in world files, and one function that measures, on the host or by a Vulkan
// kernel of your own (docs/own_controller.md).

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

/// Reads properties of a sensor in a world file. Each function returns the fallback where the key is absent. Values of
/// another kind or outside [least, most] are errors with file and line.
class SensorSettings {
 public:
  virtual ~SensorSettings() = default;
  virtual double number(std::string_view key, double fallback, double least, double most) const = 0;
  virtual double length(std::string_view key, double fallback, double least, double most) const = 0;  ///< [m]
  virtual double angle(std::string_view key, double fallback, double least, double most) const = 0;   ///< [rad]
  virtual std::string text(std::string_view key, const std::string& fallback) const = 0;
  /// Ends the load with that message at the key's line.
  [[noreturn]] virtual void refuse(std::string_view key, const std::string& message) const = 0;
};

/// One sensor of a world file.
struct SensorSite {
  std::string name;          ///< unique among its robot's sensors
  std::uint32_t robot = 0;   ///< row of its robot
  std::uint32_t number = 0;  ///< 0-based among the robot's sensors of this type
  Pose X_RS;                 ///< the sensor in the robot's frame; z is the foot of its model
  double height = 0.0;       ///< [m] of its model
};

/// A point where a ray meets a surface.
struct Hit {
  double range = 0.0;           ///< [m]; the ray's length without one
  std::uint32_t model = kNone;  ///< number of the model, or kNone without one
};

/// What stands around a sensor at the time of its measurement.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  /// The nearest surface along a horizontal ray, decided and measured in 64 bits as lasers measure in mode `exact`. The
  /// sensor's own robot is not seen.
  /// @param bearing [rad] in the world  @param range [m] >= 0, finite
  virtual Hit cast(double x, double y, double z, double bearing, double range) const = 0;
  virtual std::size_t robots() const = 0;             ///< rows: robots and tags
  virtual Pose pose(std::size_t row) const = 0;       ///< not finite: absent
  virtual Twist velocity(std::size_t row) const = 0;  ///< in its own frame
  /// Two independent numbers of a standard normal distribution, the same for the same seed, sensor, reading and `draw`;
  /// zero where noise is off.
  virtual std::array<double, 2> normal(std::uint32_t draw) const = 0;
};

/// One measurement to be taken.
struct Measurement {
  double time = 0.0;  ///< [s]
  Pose X_WS;          ///< the sensor; z is fixed at load
  const Surroundings& around;
};

/// One sensor. Measurements of different sensors run in parallel; one object is not changed by them.
class Sensor {
 public:
  virtual ~Sensor() = default;
  /// Rows of a reading, at least 1; asked once.
  virtual std::uint32_t elements() const { return 1; }
  /// Numbers for the kernel, at each measurement. Without a kernel they mean nothing.
  virtual std::array<double, 8> parameters() const { return {}; }
  /// Fills in a reading, row by row. With a kernel, `values` holds the kernel's results, which may stay as they are. An
  /// exception ends the run with its message.
  virtual void read(const Measurement& measurement, std::span<double> values) const = 0;
};

/// One number of a row.
struct SensorColumn {
  std::string name;    ///< with its unit: "distance_m"
  double unit = 1e-3;  ///< > 0: step of the number in packets, which hold 32 bits
};

/// A sensor type.
struct SensorEntry {
  std::string name;                   ///< keyword in world files, name in commands, JSON and recordings
  std::uint8_t id = 0;                ///< in packets: 13 to 31, not that of another type
  std::vector<SensorColumn> columns;  ///< at least one
  std::vector<std::string> keys;      ///< its own properties in world files, beside `rate`, `phase`, `latency`, `pose`
  double rate = 10.0;                 ///< [Hz] default
  /// File of a kernel in SPIR-V, relative to the plug-in's; empty: none. Its tables: shaders/lib/own_sensor.glsl.
  std::string kernel;
  std::function<std::unique_ptr<Sensor>(const SensorSite&, const SensorSettings&)> make;
};

}  // namespace sensorfarm
