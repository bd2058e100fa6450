#pragma once
// Names and hashes of ROS 2 types in DDS. Their definitions are in record/schemas.cpp.

#include <string>
#include <string_view>

namespace sf::bridges {

/// Converts "sensor_msgs/msg/LaserScan" to "sensor_msgs::msg::dds_::LaserScan_".
std::string dds_type(std::string_view type);

/// Returns the type hash of ROS 2 (REP 2011): SHA-256 of the type's description as JSON. Nodes announce it and warn
/// about differing definitions of a type.
/// @param type "sensor_msgs/msg/LaserScan" or "std_srvs/srv/Trigger_Request" @param text definition (`ros2msg`): its
/// fields, then the types that it uses, each after a line of '=' and a line "MSG: package/Name"
/// @return "RIHS01_" and 64 digits; empty if the text lacks a type or a field cannot be parsed
std::string type_hash(std::string_view type, std::string_view text);

/// Returns the type hash that an endpoint announces: "typehash=RIHS01_...;"; empty if no hash can be computed.
/// @param definition as in `type_hash`
std::string type_user_data(std::string_view type, std::string_view definition);

}  // namespace sf::bridges
