#include "bridges/ros_types.h"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>

#include "bridges/type_hash.h"
#include "record/schemas.h"

namespace sf::bridges {

namespace {

struct Definition {
  std::string_view name;  ///< package/Name
  std::string_view fields;
};

// Types that do not occur in recordings, without their constants.
constexpr std::array kDefinitions = {
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

/// Converts "package/Name" to "package/msg/Name". Parts of actions already have full names.
std::string message_name(const std::string& type) {
  const std::size_t slash = type.find('/');
  if (type.find('/', slash + 1) != std::string::npos) return type;
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

void add_needed(std::string_view fields, std::set<std::string>& added, std::string& text) {
  std::istringstream lines{std::string(fields)};
  for (std::string line; std::getline(lines, line);) {
    const std::string type = line.substr(0, line.find_first_of(" [<"));
    if (type.find('/') == std::string::npos || !added.insert(type).second) continue;
    text += std::string(80, '=') + "\nMSG: " + type + "\n";
    const auto own = std::find_if(kDefinitions.begin(), kDefinitions.end(),
                                  [&](const Definition& definition) { return definition.name == type; });
    if (own == kDefinitions.end()) {
      text += record::schema_text(message_name(type));  // with all types that it uses
    } else {
      text += own->fields;
      add_needed(own->fields, added, text);
    }
  }
}

}  // namespace

std::string dds_type(std::string_view type) {
  std::string name;
  for (const char c : type.substr(0, type.rfind('/'))) name += c == '/' ? std::string("::") : std::string(1, c);
  return name + "::dds_::" + std::string(type.substr(type.rfind('/') + 1)) + "_";
}

std::string ros_definition(std::string_view fields) {
  std::string text(fields);
  std::set<std::string> added;
  add_needed(fields, added, text);
  return text;
}

std::string type_user_data(std::string_view type, std::string_view definition) {
  const std::string hash = type_hash(type, definition);
  return hash.empty() ? hash : "typehash=" + hash + ";";
}

}  // namespace sf::bridges
