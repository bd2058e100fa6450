#pragma once
// Assigns one UDP port per sensor: base port of the sensor type + robot id * stride + sensor index.

#include <cstdint>
#include <span>
#include <string>

namespace sf::netio {

inline constexpr std::uint16_t kInboxPort = 9000;  ///< default port for states

/// Ports of one sensor type. With the defaults, robot 0 has ports 10000 to 10007, and robot 6941 has the last port,
/// 65535.
struct PortRule {
  std::uint32_t base = 10000;  ///< base port of the sensor type; sensor ports below 32768 avoid Linux's ephemeral ports
  std::uint32_t stride = 8;    ///< ports per robot, >= 1; further sensors use ports of the next robot
};

/// Returns a number that may exceed 65535, see require_ports.
inline std::uint64_t port(const PortRule& rule, std::uint32_t robot, std::uint32_t sensor) {
  return std::uint64_t{rule.base} + std::uint64_t{robot} * rule.stride + sensor;
}

/// The sensors of one type on one robot.
struct SensorPorts {
  std::uint32_t robot = 0;
  std::uint32_t sensors = 0;  ///< numbered `first` to `first` + `sensors` - 1
  PortRule rule;
  std::string name;  ///< the robot's name in the world file, for messages
  std::uint32_t first = 0;
  std::string type = "sensor";  ///< used in messages
  std::string option;           ///< option that sets the base port, for messages; empty: none
};

/// @throws base::InputError, in one line, if an id or a port exceeds 65535, a port is 0, or two sensors share a port;
/// the message names them and suggests a base port or stride
void require_ports(std::span<const SensorPorts> uses);

/// Returns `usual` if it keeps all ports distinct and at most 65535, otherwise the smallest stride that does, or
/// `usual` if there is none. Ignores the strides in `uses`.
std::uint32_t smallest_stride(std::span<const SensorPorts> uses, std::uint32_t usual);

}  // namespace sf::netio
