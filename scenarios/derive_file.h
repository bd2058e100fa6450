#pragma once
// Files of derived sensors (.toml) for `derive`; docs/recordings.md lists their keys.
//
//   [[derived]]
//   robot = "r0"            # "*": each robot
//   type = "localization"
//   name = "pose"
//   inputs = ["encoder", "gyro"]
//   rate = 20               # and all other properties of `derived( ... )` in world files

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "world/world.h"

namespace sf::scenarios {

/// A sensor to be added to a robot, as an entity of a world file: `gyro( noise 0.1 )`.
struct SensorText {
  std::string robot;
  std::string word;                                             ///< "derived", "gyro"
  std::vector<std::pair<std::string, std::string>> properties;  ///< keys and values as in world files
  int line = 0;                                                 ///< in the file, 1-based
  /// Returns the value as in world files; empty if it has no such property.
  std::string value(std::string_view key) const;
  std::string name() const;
};

/// Readings of another program: one sensor.
struct ForeignInput {
  SensorText sensor;  ///< its word is empty if the file states none
  std::string topic;  ///< in MCAP; empty: a table
  std::string table;  ///< CSV file, relative to the recording's folder; empty: the recording itself
  std::string time;   ///< column of the table with the times
  std::vector<std::pair<std::string, std::string>> columns;  ///< of the sensor, and of the source
};

/// Which times of messages count: `stamp`, the measurement's, and `log`, the delivery's.
enum class ForeignClock : std::uint8_t { both, stamp, log };

struct DeriveFile {
  std::string file;
  std::vector<SensorText> derived;
  std::vector<ForeignInput> inputs;  ///< empty: the recording is one of sensorfarm's
  std::optional<std::pair<double, double>>
      origin;  ///< [deg] latitude and longitude of x = y = 0; absent: the first fix
  ForeignClock clock = ForeignClock::both;
};

/// @throws base::InputError with file and line
DeriveFile read_derive_file(const std::string& file);

/// Adds sensors to robots, behind those that they have. @param file of the sensors
/// @return per added sensor its robot's row
/// @throws base::InputError with file and line for an unknown robot, type or property, and for a name that is taken
std::vector<std::uint32_t> add_sensors(const std::string& file, std::span<const SensorText> sensors,
                                       world::World& world);

}  // namespace sf::scenarios
