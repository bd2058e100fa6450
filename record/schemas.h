#pragma once
// The message types of recordings and bridges, with their names and definitions in ROS 2.

#include <string>
#include <string_view>

namespace sf::record {

inline constexpr std::string_view kOdometry = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kLaserScan = "sensor_msgs/msg/LaserScan";
inline constexpr std::string_view kImage = "sensor_msgs/msg/Image";
inline constexpr std::string_view kCameraInfo = "sensor_msgs/msg/CameraInfo";
inline constexpr std::string_view kPointCloud = "sensor_msgs/msg/PointCloud2";
inline constexpr std::string_view kTwistStamped = "geometry_msgs/msg/TwistStamped";
inline constexpr std::string_view kTransforms = "tf2_msgs/msg/TFMessage";
inline constexpr std::string_view kClock = "rosgraph_msgs/msg/Clock";
inline constexpr std::string_view kOccupancyGrid = "nav_msgs/msg/OccupancyGrid";
inline constexpr std::string_view kMarkers = "visualization_msgs/msg/MarkerArray";
inline constexpr std::string_view kRange = "sensor_msgs/msg/Range";
inline constexpr std::string_view kMagneticField = "sensor_msgs/msg/MagneticField";
inline constexpr std::string_view kNavSatFix = "sensor_msgs/msg/NavSatFix";
inline constexpr std::string_view kImu = "sensor_msgs/msg/Imu";
inline constexpr std::string_view kRadarScan = "radar_msgs/msg/RadarScan";
inline constexpr std::string_view kCompressedImage = "sensor_msgs/msg/CompressedImage";
inline constexpr std::string_view kTags = "sensorfarm_msgs/msg/Tags";
inline constexpr std::string_view kStateQuality = "sensorfarm_msgs/msg/StateQuality";
inline constexpr std::string_view kLights = "sensorfarm_msgs/msg/Lights";
inline constexpr std::string_view kFaults = "sensorfarm_msgs/msg/Faults";
inline constexpr std::string_view kShapes = "sensorfarm_msgs/msg/Shapes";
inline constexpr std::string_view kTilts = "sensorfarm_msgs/msg/Tilts";
inline constexpr std::string_view kWheels = "sensorfarm_msgs/msg/Wheels";
inline constexpr std::string_view kClouds = "sensorfarm_msgs/msg/Clouds";
inline constexpr std::string_view kSolids = "sensorfarm_msgs/msg/Solids";
inline constexpr std::string_view kIntents = "sensorfarm_msgs/msg/Intents";
inline constexpr std::string_view kFleet = "sensorfarm_msgs/msg/Fleet";
inline constexpr std::string_view kRunInfo = "sensorfarm_msgs/msg/RunInfo";

/// Returns the `ros2msg` text of one of the types above: its fields, then all types that it needs, each once, after a
/// line of 80 '=' and a line `MSG: package/Name`.
std::string schema_text(std::string_view type);
/// Returns the same for a type of the caller, given its fields, one per line.
std::string with_dependencies(std::string_view fields);

}  // namespace sf::record
