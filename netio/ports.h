#pragma once
// One UDP port per sensor: f(base port of the sensor kind, robot id, sensor id) = base + robot * stride + sensor.

#include <cstdint>
#include <span>
#include <string>

namespace sf::netio {

inline constexpr std::uint16_t kInboxPort = 9000;  ///< where states are sent to, unless told otherwise

/// The ports of one sensor kind. With the defaults robot 0's sensors are at 10000 to 10007, robot 6941's last at 65535.
struct PortRule {
  std::uint32_t base = 10000;  ///< the kind's own; ports below 32768 keep clear of those Linux lends out
  std::uint32_t stride = 8;    ///< ports per robot, >= 1; more sensors of the kind run into the next robot's
};

/// May exceed 65535: see require_ports.
inline std::uint64_t port(const PortRule& rule, std::uint32_t robot, std::uint32_t sensor) {
  return std::uint64_t{rule.base} + std::uint64_t{robot} * rule.stride + sensor;
}

/// The sensors of one kind on one robot.
struct SensorPorts {
  std::uint32_t robot = 0;
  std::uint32_t sensors = 0;  ///< numbered `first` to `first` + `sensors` - 1
  PortRule rule;
  std::string name;  ///< for the error: the robot's name in the world file
  std::uint32_t first = 0;
  std::string kind = "sensor";  ///< for the error too
  std::string option;           ///< for the error: what sets the rule's base; empty: it says "base port"
};

/// @throws base::InputError, one line, when an id or a port is past 65535, a port is 0, or two sensors share one; it
/// names both, and says which base or stride would do.
void require_ports(std::span<const SensorPorts> uses);

/// `usual` where it keeps all ports apart and within 65535, else the least stride that does; `usual` where none does.
/// The uses' own strides are not looked at.
std::uint32_t smallest_stride(std::span<const SensorPorts> uses, std::uint32_t usual);

}  // namespace sf::netio
