#pragma once
// Your own derived sensors: sensors that are computed from readings of other sensors (docs/derived.md).
//
//   class Speed : public sensorfarm::DerivedSensor {
//    public:
//     Speed(const sensorfarm::DerivedSite&, const sensorfarm::SensorSettings&) {}
//     void take(std::uint32_t, const sensorfarm::Reading& encoder) override { ... }
//     void read(double time, sensorfarm::DerivedReading out) override { out.values[0] = speed_; }
//   };
//
// In a world file, inside a robot:
//   derived( type "speed"  inputs ["encoder"]  rate 20 )

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sensorfarm/controller.h"
#include "sensorfarm/sensor.h"

namespace sensorfarm {

/// A kind of input of a derived sensor type.
struct InputPort {
  std::string name;                  ///< used in messages, and in world files as "name=laser:1"
  std::vector<std::string> columns;  ///< first columns of its readings, with their units: {"left_m", "right_m"}; empty:
                                     ///< readings of any sensor
  std::uint32_t least = 0;           ///< fewest inputs of this kind
  std::uint32_t most = 1;            ///< most inputs of this kind
};

/// One input of a derived sensor, as wired by its world file.
struct DerivedInput {
  std::uint32_t port = 0;   ///< row in `DerivedEntry::ports`
  std::uint32_t robot = 0;  ///< row of the robot that carries it
  SensorInfo sensor;
};

/// One derived sensor of a world file.
struct DerivedSite {
  SensorSite sensor;
  Pose start;                        ///< pose of its robot when the run starts; NaN if the sensor starts later
  std::vector<DerivedInput> inputs;  ///< by robot, then in the order of the world file
};

/// A reading to be filled in.
struct DerivedReading {
  std::span<double> values;  ///< row by row, each with the columns of the entry; initially 0
  /// Row by row: the upper triangle of the covariance of the row's columns, line by line, in products of their units.
  /// Initially NaN, which means that none is stated. Empty for types without covariance.
  std::span<double> covariance;
  std::span<std::uint8_t> valid;  ///< one per row: 1, or 0 if the row has no meaning; initially 1
};

/// One derived sensor: its state between readings. Calls of one object never overlap; calls of different objects run in
/// parallel. It is called while its robot's readings of this type are subscribed; when they are subscribed again, a new
/// object starts. An exception ends the run with its message.
class DerivedSensor {
 public:
  virtual ~DerivedSensor() = default;
  /// Processes one input reading, at its delivery: measurement and latency. Readings that are delivered together are
  /// in order of `time`, then of `input`. Lost readings are not passed on.
  /// @param input row in `DerivedSite::inputs`
  /// @param reading `X_WS` is NaN: a derived sensor knows poses from its inputs only
  virtual void take(std::uint32_t input, const Reading& reading) = 0;
  /// Fills in the reading at `time` [s], after all inputs delivered by then.
  virtual void read(double time, DerivedReading out) = 0;
  /// Adds an input of a robot that joined: the next row.
  virtual void add_input(const DerivedInput&) {}
};

/// A derived sensor type.
struct DerivedEntry {
  std::string name;                   ///< `type` in world files, name in commands, JSON and recordings
  std::uint8_t id = 0;                ///< in packets: 13 to 26, not that of another type
  std::vector<SensorColumn> columns;  ///< at least one
  std::vector<InputPort> ports;       ///< at least one
  std::vector<std::string> keys;  ///< its own properties in world files, in addition to those of all derived sensors
  double rate = 10.0;             ///< [Hz] default
  std::uint32_t rows = 1;         ///< of a reading
  bool covariance = false;        ///< readings state a covariance per row
  std::function<std::unique_ptr<DerivedSensor>(const DerivedSite&, const SensorSettings&)> make;
};

}  // namespace sensorfarm
