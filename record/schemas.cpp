#include "record/schemas.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/error.h"

namespace sf::record {

namespace {

struct Definition {
  std::string_view name;  ///< package/Name
  std::string_view fields;
};

constexpr std::array kDefinitions = {
    Definition{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    Definition{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    Definition{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"},
    Definition{"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    Definition{"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    Definition{"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
    Definition{"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
    Definition{"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    Definition{"geometry_msgs/TransformStamped",
               "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    Definition{"nav_msgs/Odometry",
               "std_msgs/Header header\nstring child_frame_id\n"
               "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"},
    Definition{"sensor_msgs/LaserScan",
               "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
               "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
               "float32[] ranges\nfloat32[] intensities\n"},
    Definition{"sensor_msgs/RegionOfInterest",
               "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"},
    Definition{"sensor_msgs/CameraInfo",
               "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
               "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
               "sensor_msgs/RegionOfInterest roi\n"},
    Definition{"sensor_msgs/Image",
               "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
               "uint32 step\nuint8[] data\n"},
    Definition{"sensor_msgs/PointField",
               "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
               "uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    Definition{"sensor_msgs/PointCloud2",
               "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
               "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
    Definition{"geometry_msgs/TwistStamped", "std_msgs/Header header\ngeometry_msgs/Twist twist\n"},
    Definition{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},

    Definition{"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"},
    Definition{"std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n"},
    Definition{"rosgraph_msgs/Clock", "builtin_interfaces/Time clock\n"},
    Definition{"nav_msgs/MapMetaData",
               "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n"
               "geometry_msgs/Pose origin\n"},
    Definition{"nav_msgs/OccupancyGrid", "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n"},
    Definition{"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
    Definition{"sensor_msgs/Range",
               "uint8 ULTRASOUND=0\nuint8 INFRARED=1\nstd_msgs/Header header\nuint8 radiation_type\n"
               "float32 field_of_view\nfloat32 min_range\nfloat32 max_range\nfloat32 range\nfloat32 variance\n"},
    Definition{"sensor_msgs/MagneticField",
               "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\n"
               "float64[9] magnetic_field_covariance\n"},
    Definition{"sensor_msgs/NavSatStatus",
               "int8 STATUS_UNKNOWN=-2\nint8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\n"
               "int8 STATUS_GBAS_FIX=2\nint8 status -2\nuint16 SERVICE_UNKNOWN=0\nuint16 SERVICE_GPS=1\n"
               "uint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\nuint16 SERVICE_GALILEO=8\nuint16 service\n"},
    Definition{"sensor_msgs/NavSatFix",
               "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
               "float64 altitude\nfloat64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN=0\n"
               "uint8 COVARIANCE_TYPE_APPROXIMATED=1\nuint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\n"
               "uint8 COVARIANCE_TYPE_KNOWN=3\nuint8 position_covariance_type\n"},
    Definition{"sensor_msgs/Imu",
               "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
               "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
               "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
               "float64[9] linear_acceleration_covariance\n"},
    Definition{"radar_msgs/RadarReturn",
               "float32 range\nfloat32 azimuth\nfloat32 elevation\nfloat32 doppler_velocity\nfloat32 amplitude\n"},
    Definition{"radar_msgs/RadarScan", "std_msgs/Header header\nradar_msgs/RadarReturn[] returns\n"},
    Definition{"visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"},
    Definition{"visualization_msgs/MeshFile", "string filename\nuint8[] data\n"},
    Definition{"visualization_msgs/Marker",
               "int32 LINE_LIST=5\nint32 ADD=0\nstd_msgs/Header header\nstring ns\nint32 id\nint32 type\n"
               "int32 action\ngeometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n"
               "builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n"
               "std_msgs/ColorRGBA[] colors\nstring texture_resource\nsensor_msgs/CompressedImage texture\n"
               "visualization_msgs/UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\n"
               "visualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n"},
    Definition{"visualization_msgs/MarkerArray", "visualization_msgs/Marker[] markers\n"},

    Definition{"sensorfarm_msgs/Pose", "float64 x\nfloat64 y\nfloat64 z\nfloat64 yaw\n"},
    Definition{"sensorfarm_msgs/Twist", "float64 forward\nfloat64 left\nfloat64 turn\n"},
    Definition{"sensorfarm_msgs/State",
               "uint32 mover\nbool contact\nsensorfarm_msgs/Pose pose\n"
               "sensorfarm_msgs/Twist velocity\nsensorfarm_msgs/Twist command\n"},
    Definition{"sensorfarm_msgs/Fleet", "std_msgs/Header header\nuint64 tick\nsensorfarm_msgs/State[] states\n"},
    Definition{"sensorfarm_msgs/Tilt", "uint32 mover\nfloat64 roll\nfloat64 pitch\n"},
    Definition{"sensorfarm_msgs/Tilts", "std_msgs/Header header\nsensorfarm_msgs/Tilt[] tilts\n"},
    Definition{"sensorfarm_msgs/MoverWheels", "uint32 mover\nfloat32 left\nfloat32 right\n"},
    Definition{"sensorfarm_msgs/Wheels", "std_msgs/Header header\nsensorfarm_msgs/MoverWheels[] wheels\n"},
    Definition{"sensorfarm_msgs/Cloud",
               "uint32 mover\nuint8 type\nuint32 sensor\nbool planar\nfloat32[3] position\nfloat32[] points\n"},
    Definition{"sensorfarm_msgs/Clouds",
               "std_msgs/Header header\nfloat64[3] origin\nuint32 stride\nsensorfarm_msgs/Tilt[] tilts\n"
               "sensorfarm_msgs/Cloud[] clouds\n"},
    Definition{"sensorfarm_msgs/Place", "uint32 mover\nsensorfarm_msgs/Pose pose\nuint32 color\n"},
    Definition{"sensorfarm_msgs/Solid",
               "string kind\nfloat32[] vertices\nuint32[] corners\nsensorfarm_msgs/Place[] places\n"},
    Definition{"sensorfarm_msgs/Solids", "string note\nsensorfarm_msgs/Solid[] solids\n"},
    Definition{"sensorfarm_msgs/Intent",
               "uint32 NONE=4294967295\nuint32 mover\nuint32 follows\nuint32 checkpoint\nfloat64 x\nfloat64 y\n"
               "bool docking\n"},
    Definition{"sensorfarm_msgs/Intents", "std_msgs/Header header\nsensorfarm_msgs/Intent[] intents\n"},
    Definition{"sensorfarm_msgs/Light",
               "uint8 DARK=0\nuint8 RED=1\nuint8 YELLOW=2\nuint8 GREEN=3\nuint8 FLASHING_RED=4\n"
               "uint8 FLASHING_YELLOW=5\nstring name\nuint8 state\nfloat64 left\n"},
    Definition{"sensorfarm_msgs/Lights", "std_msgs/Header header\nsensorfarm_msgs/Light[] lights\n"},
    Definition{"sensorfarm_msgs/Fault",
               "uint16 BIAS=1\nuint16 DRIFT=2\nuint16 SCALE=4\nuint16 STUCK=8\nuint16 SPIKES=16\nuint16 NOISE=32\n"
               "uint16 QUANTIZATION=64\nuint16 SWAP=128\nuint16 DROPOUT=256\nuint16 DELAY=512\n"
               "builtin_interfaces/Time stamp\nuint32 mover\nuint32 sensor\nuint32 sequence\nuint16 faults\n"
               "uint8 kind\n"},
    Definition{"sensorfarm_msgs/Faults", "std_msgs/Header header\nsensorfarm_msgs/Fault[] faults\n"},
    Definition{"sensorfarm_msgs/Shape",
               "uint32 ORIGINAL=4294967295\nuint32 mover\nuint32 shape\nuint32 color\nfloat64[3] size\n"
               "sensorfarm_msgs/Pose origin\n"},
    Definition{"sensorfarm_msgs/Shapes", "std_msgs/Header header\nsensorfarm_msgs/Shape[] shapes\n"},
    Definition{"sensorfarm_msgs/StateQuality",
               "std_msgs/Header header\nbool stale\nfloat64 age\nfloat32[6] covariance\n"},
    Definition{"sensorfarm_msgs/Tag",
               "uint32 id\nsensorfarm_msgs/Pose pose\nsensorfarm_msgs/Twist velocity\nuint32 cameras\n"},
    Definition{"sensorfarm_msgs/Tags", "std_msgs/Header header\nsensorfarm_msgs/Tag[] tags\n"},
    Definition{"sensorfarm_msgs/Laser",
               "string name\nstring topic\nsensorfarm_msgs/Pose pose\nfloat64 fov\nuint32 samples\n"
               "float64 range_min\nfloat64 range_max\nfloat64 rate\n"},
    Definition{"sensorfarm_msgs/Column", "string name\nuint32 width\nbool whole\n"},
    Definition{"sensorfarm_msgs/Kind", "uint8 id\nstring name\nstring list\nsensorfarm_msgs/Column[] columns\n"},
    Definition{"sensorfarm_msgs/Sensor",
               "uint8 kind\nstring name\nstring topic\nsensorfarm_msgs/Pose pose\nfloat64 rate\n"},
    Definition{"sensorfarm_msgs/Mover",
               "string name\nstring frame\nuint32 id\nsensorfarm_msgs/Laser[] lasers\n"
               "sensorfarm_msgs/Sensor[] sensors\n"},
    Definition{"sensorfarm_msgs/Option", "string key\nstring value\n"},
    Definition{"sensorfarm_msgs/RunInfo",
               "string world\nuint64 world_hash\nuint64 seed\nstring mode\nfloat64 interval\n"
               "bool readings\nfloat64 odometry_rate\nsensorfarm_msgs/Kind[] kinds\n"
               "sensorfarm_msgs/Mover[] movers\nsensorfarm_msgs/Option[] options\n"},

    // Types of services and of discovery, without their constants.
    Definition{"action_msgs/GoalInfo", "unique_identifier_msgs/UUID goal_id\nbuiltin_interfaces/Time stamp\n"},
    Definition{"action_msgs/GoalStatus", "action_msgs/GoalInfo goal_info\nint8 status\n"},
    Definition{"geometry_msgs/Accel", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    Definition{"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
    Definition{"rmw_dds_common/Gid", "char[16] data\n"},
    Definition{"rmw_dds_common/NodeEntitiesInfo",
               "string<=256 node_namespace\nstring<=256 node_name\n"
               "rmw_dds_common/Gid[] reader_gid_seq\nrmw_dds_common/Gid[] writer_gid_seq\n"},
    Definition{"simulation_interfaces/Bounds", "uint8 type\ngeometry_msgs/Vector3[] points\n"},
    Definition{"simulation_interfaces/EntityCategory", "uint8 category\n"},
    Definition{"simulation_interfaces/EntityFilters",
               "string filter\nsimulation_interfaces/EntityCategory[] categories\n"
               "simulation_interfaces/TagsFilter tags\nsimulation_interfaces/Bounds bounds\n"},
    Definition{"simulation_interfaces/EntityInfo",
               "simulation_interfaces/EntityCategory category\nstring description\nstring[] tags\n"},
    Definition{"simulation_interfaces/EntityState",
               "std_msgs/Header header\ngeometry_msgs/Pose pose\n"
               "geometry_msgs/Twist twist\ngeometry_msgs/Accel acceleration\n"},
    Definition{"simulation_interfaces/NamedPose",
               "string name\nstring description\nstring[] tags\ngeometry_msgs/Pose pose\n"},
    Definition{"simulation_interfaces/Resource", "string uri\nstring resource_string\n"},
    Definition{"simulation_interfaces/Result", "uint8 result\nstring error_message\n"},
    Definition{"simulation_interfaces/SimulationState", "uint8 state\n"},
    Definition{"simulation_interfaces/SpawnEntity",
               "string name\nbool allow_renaming\nsimulation_interfaces/Resource entity_resource\n"
               "string entity_namespace\ngeometry_msgs/PoseStamped initial_pose\n"},
    Definition{"simulation_interfaces/SpawnResult", "simulation_interfaces/Result result\nstring entity_name\n"},
    Definition{"simulation_interfaces/Spawnable",
               "simulation_interfaces/Resource entity_resource\nstring description\n"
               "simulation_interfaces/Bounds spawn_bounds\n"},
    Definition{"simulation_interfaces/WorldResource",
               "string name\nsimulation_interfaces/Resource world_resource\nstring description\nstring[] tags\n"},
    Definition{"simulation_interfaces/action/SimulateSteps_Feedback",
               "uint64 completed_steps\nuint64 remaining_steps\n"},
    Definition{"simulation_interfaces/action/SimulateSteps_Goal", "uint64 steps\n"},
    Definition{"simulation_interfaces/action/SimulateSteps_Result", "simulation_interfaces/Result result\n"},
    Definition{"simulation_interfaces/SimulatorFeatures",
               "uint16[] features\nstring[] spawn_formats\nstring custom_info\n"},
    Definition{"simulation_interfaces/TagsFilter", "string[] tags\nuint8 filter_mode\n"},
    Definition{"unique_identifier_msgs/UUID", "uint8[16] uuid\n"},
};

const Definition& find(std::string_view name) {
  const auto found = std::find_if(kDefinitions.begin(), kDefinitions.end(),
                                  [&](const Definition& definition) { return definition.name == name; });
  SF_CHECK(found != kDefinitions.end(), "no message type " + std::string(name));
  return *found;
}

/// Adds the types mentioned in `fields`, and their dependencies, in order of first mention.
void add_dependencies(std::string_view fields, std::vector<std::string_view>& needed) {
  while (!fields.empty()) {
    std::string_view type = fields.substr(0, fields.find(' '));
    fields.remove_prefix(fields.find('\n') + 1);
    type = type.substr(0, type.find('['));
    if (type.find('/') == std::string_view::npos) continue;
    if (std::find(needed.begin(), needed.end(), type) != needed.end()) continue;
    needed.push_back(type);
    add_dependencies(find(type).fields, needed);
  }
}

}  // namespace

std::string schema_text(std::string_view type) {
  constexpr std::string_view kMiddle = "/msg/";
  const std::size_t middle = type.find(kMiddle);
  SF_CHECK(middle != std::string_view::npos, "not a message type: " + std::string(type));
  const std::string name =
      std::string(type.substr(0, middle)) + "/" + std::string(type.substr(middle + kMiddle.size()));

  return with_dependencies(find(name).fields);
}

std::string with_dependencies(std::string_view fields) {
  std::string text(fields);
  std::vector<std::string_view> needed;
  add_dependencies(fields, needed);
  for (const std::string_view other : needed) {
    text += std::string(80, '=') + "\nMSG: " + std::string(other) + "\n" + std::string(find(other).fields);
  }
  return text;
}

}  // namespace sf::record
