#pragma once
// Names and definitions of ROS 2 types in DDS.

#include <string>
#include <string_view>

namespace sf::bridges {

/// Converts "sensor_msgs/msg/LaserScan" to "sensor_msgs::msg::dds_::LaserScan_".
std::string dds_type(std::string_view type);

/// Returns the definition of a type with these fields (`ros2msg`): the fields, one per line, then all types that they
/// use. Known types are those of recordings, simulation_interfaces and rmw_dds_common.
std::string ros_definition(std::string_view fields);

/// Returns the type hash that an endpoint announces: "typehash=RIHS01_...;"; empty if no hash can be computed.
/// @param definition as in `type_hash`
std::string type_user_data(std::string_view type, std::string_view definition);

}  // namespace sf::bridges
