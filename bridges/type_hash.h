#pragma once
// Type hashes of ROS 2 (REP 2011, "RIHS01"): SHA-256 of a type's description as JSON. Nodes announce them and warn
// about differing definitions of a type.

#include <string>
#include <string_view>

namespace sf::bridges {

/// @param type "sensor_msgs/msg/LaserScan" or "std_srvs/srv/Trigger_Request" @param text definition (`ros2msg`): its
/// fields, then the types that it uses, each after a line of '=' and a line "MSG: package/Name"
/// @return "RIHS01_" and 64 digits; empty if the text lacks a type or a field cannot be parsed
std::string type_hash(std::string_view type, std::string_view text);

}  // namespace sf::bridges
