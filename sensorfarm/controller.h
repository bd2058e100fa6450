#pragma once
// Your own controllers, in your own library: readings in, twist out (docs/own_controller.md).
//
//   #include <sensorfarm/plugin.h>
//
//   class Straight : public sensorfarm::Controller {
//    public:
//     Straight(const sensorfarm::Robot&, sensorfarm::Settings& settings) : speed_(settings.number("speed", 0.2, 0, 2))
//     {}
//     sensorfarm::Twist step(const sensorfarm::Input& input) override { return {input.contact ? 0.0 : speed_}; }
//
//    private:
//     double speed_;
//   };
//
//   SENSORFARM_PLUGIN(plugin) { plugin.add_controller<Straight>("straight", "drives straight on"); }
//
// Load such a library with `sensorfarm run WORLD --controller ./libstraight.so --set speed=0.3`.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sensorfarm/types.h"

namespace sensorfarm {

/// One sensor of a robot.
struct SensorInfo {
  std::string type;                  ///< such as "laser"
  std::uint32_t number = 0;          ///< 0-based among the robot's sensors of this type
  std::string name;                  ///< unique among the robot's sensors
  Pose X_RS;                         ///< pose of the sensor in the robot's frame
  double rate = 0.0;                 ///< [Hz]
  std::uint32_t elements = 1;        ///< rows of a reading: beams of a laser, cones of a sonar ring, otherwise 1
  std::vector<std::string> columns;  ///< names of a row's columns, with units: "range_m"; a 3-D vector takes three
                                     ///< columns. Those of the type that this sensor was asked for
  double limit = 0.0;                ///< largest value of the first column of a row: a laser's range [m]
  std::vector<double> bearings;      ///< [rad] bearings of a laser's beams in the sensor's frame; empty for other types
};

/// The robot that a controller drives, at the time when the controller is created.
struct Robot {
  std::string name;          ///< name in the world file
  std::uint32_t id = 0;      ///< number in packets
  std::uint32_t row = 0;     ///< among all robots and tags of the world
  Pose pose;                 ///< pose at the start
  double radius = 0.0;       ///< [m] radius of the circle about its origin that contains its body
  double max_forward = 0.0;  ///< [m/s]
  double max_turn = 0.0;     ///< [rad/s]
  std::vector<SensorInfo> sensors;
  std::uint64_t seed = 0;  ///< seed of random choices; the same for all robots of a run
  std::string world;       ///< path of the world file, as given by the user
};

/// One reading of one sensor.
struct Reading {
  std::string_view type;           ///< such as "laser"
  std::uint32_t number = 0;        ///< 0-based among the robot's sensors of this type
  double time = 0.0;               ///< [s] time of the measurement
  Pose X_WS;                       ///< pose of the sensor at the measurement
  std::span<const double> values;  ///< row by row, each with the columns of the sensor; a range without a return
                                   ///< equals the limit
  std::span<const std::uint32_t>
      hits;  ///< lasers in a simulation: index of the model hit by each beam, kFloor or kNone
  /// Largest error of the first column, in rows without a flag; infinite: not stated, as for noisy sensors.
  double bound = std::numeric_limits<double>::infinity();
  double bound_without_noise = std::numeric_limits<double>::infinity();  ///< the same before noise is added
  /// Largest standard deviation of the first column's noise; 0: no noise; infinite: unknown.
  double sigma = 0.0;
  /// One per row: 0, or the reason why the bound does not hold (docs/accuracy.md); empty: 0 for all rows. Always empty
  /// in `sensorfarm robot`, which states a bound only if it holds for all rows.
  std::span<const std::uint8_t> flags;
};

/// Another robot, as it broadcasts itself (V2V).
struct Neighbour {
  std::uint32_t id = 0;
  Pose pose;
  Twist velocity;
  std::uint32_t follows = kNone;  ///< id of the robot that it follows, or kNone
};

enum class LightState : std::uint8_t { dark, red, yellow, green, flashing_red, flashing_yellow };

/// One traffic light of the world.
struct Light {
  std::string_view name;
  Pose pose;  ///< pose of the light; its lamps face along x
  LightState state = LightState::dark;
  double left = 0.0;  ///< [s] until its next change; infinity: never
};

/// The input of one control step. Spans are valid during the call.
struct Input {
  double time = 0.0;  ///< [s] simulated, or on the robot's clock; does not decrease
  Pose pose;          ///< pose of the robot: true in a simulation, estimated in `sensorfarm robot`
  Twist velocity;
  std::span<const Reading> readings;  ///< the newest reading of each of its sensors, whether or not it is new since the
                                      ///< last call
  bool contact = false;               ///< the bumper is pressed, or an obstacle blocked the last motion
  bool started = true;                ///< the start signal was given
  std::span<const Neighbour> others;  ///< robots within `Controller::radio_range`, in order of id
  std::span<const Light> lights;      ///< all lights of the world

  /// Returns the newest reading of a sensor; null if there is none.
  const Reading* newest(std::string_view type, std::uint32_t number = 0) const {
    for (const Reading& reading : readings)
      if (reading.number == number && reading.type == type) return &reading;
    return nullptr;
  }
};

/// One object per robot. Calls of one object never overlap; calls of different objects may run in parallel. An
/// exception ends the run with its message.
class Controller {
 public:
  virtual ~Controller() = default;
  /// @return the twist to drive until the next call; finite
  virtual Twist step(const Input& input) = 0;
  /// Returns the radius [m] within which the states of other robots are received. Read once. 0: none.
  virtual double radio_range() const { return 0.0; }
  /// Returns whether the task is finished. The robot stops from then on, and a run ends when all controllers are done.
  virtual bool done() const { return false; }
  /// Returns the control error of the last step in your own unit, for statistics and scenarios; NaN: none.
  virtual double error() const { return std::numeric_limits<double>::quiet_NaN(); }
  /// Returns types of sensors such as "sonar" of which readings of any one suffice to drive: with those of a real
  /// robot's own sensors, `sensorfarm robot` drives on while the farm is away. Empty: it needs no readings. nullopt: it
  /// needs those of the farm. Read once.
  virtual std::optional<std::vector<std::string>> sufficient_sensors() const { return std::nullopt; }
  /// Returns the digital outputs that a real robot with such pins sets after a step, by bit (docs/robots.md#create).
  virtual std::uint8_t outputs() const { return 0; }
};

/// Settings by key, from `--set KEY=VALUE` or a scenario's `[robots.settings]`. Each function returns the fallback if
/// the key is absent. Values of another type or outside [least, most], and keys that were not read during the
/// construction of the controller, are errors that name their place.
class Settings {
 public:
  virtual ~Settings() = default;
  virtual double number(std::string_view key, double fallback, double least, double most) = 0;
  virtual bool flag(std::string_view key, bool fallback) = 0;
  virtual std::string text(std::string_view key, const std::string& fallback) = 0;
  virtual std::vector<double> numbers(std::string_view key, const std::vector<double>& fallback) = 0;
};

/// A kind of controller: its name, and how to create one.
struct ControllerEntry {
  std::string name;             ///< name by which users choose it
  std::string summary;          ///< one line
  double rate = 10.0;           ///< [Hz] rate of its calls, in (0, 10000]
  bool stops_on_bumper = true;  ///< while `Input::contact`, the robot stops and `step` is not called (the user's
                                ///< setting `wait_on_bumper` overrides this)
  /// Throws an exception to refuse the robot; its message is reported.
  std::function<std::unique_ptr<Controller>(const Robot&, Settings&)> make;
  /// Unless the user sets a rate, calls the controller of a robot with a laser on each new scan and on contact instead
  /// of at `rate`.
  bool on_scans = false;
};

}  // namespace sensorfarm
