#pragma once
// Which readings each derived sensor of a world takes as inputs, checked when the world is loaded.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sensors/derived/derived_type.h"
#include "sensors/sensor_set.h"

namespace sf::sensors {

// Wire ids of pseudo-types, which only derived sensors read: in runs, and kV2vInput in services too.
inline constexpr std::uint8_t kCommandInput = 63;  ///< `command`: the twist that a robot executed since the last tick
inline constexpr std::uint8_t kCameraInput = 62;   ///< `camera`: poses that a robot received from overhead cameras
inline constexpr std::uint8_t kV2vInput = 61;      ///< `v2v`: states of that robot, as the sensor's robot receives them
constexpr bool is_received(std::uint8_t type) { return type >= kV2vInput; }
/// Returns the type with that id, or the pseudo-type. @pre it exists
const SensorType& input_type(std::uint8_t id);

/// An input as written: "[port=][robot/]type[:number]". Views of that text.
struct InputText {
  std::string_view port, robot, type;
  std::optional<std::uint32_t> number = 0;  ///< nullopt: not a number
};
InputText read_input(std::string_view text);
/// Returns whether inputs may call the type so: by its name or a word of world files.
bool is_called(const SensorType& type, std::string_view word);

/// Returns the rows of the robots that an input names, in the copy of the world of `own`: "" is `own`, "*" all.
/// @param why out: if there is none, the reason with a suggestion
std::vector<std::uint32_t> movers_named(const world::World& world, std::uint32_t own, std::string_view robot,
                                        std::string& why);

/// A derived sensor of a world.
struct DerivedNode {
  const SensorType* type = nullptr;
  const world::Sensor* settings = nullptr;  ///< in the world
  SensorSpec spec;
  std::uint32_t row = 0;           ///< among the world's sensors of its type
  std::uint32_t level = 0;         ///< above the levels of all its inputs; 0: it has no derived input
  std::vector<WiredInput> inputs;  ///< by robot, then in the order of the world file
};

/// The sensors of a type: SensorSet::Group, as far as wiring needs it.
struct WiredGroup {
  const SensorType* type;
  std::span<const SensorSpec> rows;  ///< by mover
};

/// Returns the world's derived sensors, in order of type and row. @param groups all types of the world
/// @throws base::InputError with file and line for an input that does not exist, that no port of the type accepts, or
/// that depends on the sensor itself, and for too few or too many inputs
std::vector<DerivedNode> wire(const world::World& world, std::span<const WiredGroup> groups);
std::vector<DerivedNode> wire(const world::World& world, const SensorSet& sensor_set);

/// Returns "localization 'pose' of 'r0'", for messages.
std::string derived_name(const world::World& world, const DerivedNode& node);

}  // namespace sf::sensors
