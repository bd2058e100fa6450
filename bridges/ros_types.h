#pragma once
// Names and definitions of ROS 2 types, as nodes of ROS 2 see them in DDS.

#include <string>
#include <string_view>

namespace sf::bridges {

/// "sensor_msgs/msg/LaserScan" as "sensor_msgs::msg::dds_::LaserScan_".
std::string dds_type(std::string_view type);

/// The definition of a type of these fields (`ros2msg`): the fields, one per line, then all types that they need. Types
/// are those of recordings, of simulation_interfaces and of rmw_dds_common.
std::string ros_definition(std::string_view fields);

/// What an endpoint says of its type to others: "typehash=RIHS01_...;"; empty where no hash can be computed.
/// @param definition as in `type_hash`
std::string type_user_data(std::string_view type, std::string_view definition);

}  // namespace sf::bridges
