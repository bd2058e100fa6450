#pragma once
// Robots of a run as entities of simulation_interfaces, named poses, spawnable robots, and worlds.

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "bridges/bridge.h"
#include "record/cdr.h"

namespace sf::bridges {

/// Result codes of simulation_interfaces: first those shared by all services, then those of SpawnEntity.
inline constexpr std::uint8_t kUnsupported = 0, kOk = 1, kNotFound = 2, kFailed = 4, kNameTaken = 101,
                              kNameInvalid = 102, kUnsupportedFormat = 103, kNoResource = 104, kNamespaceInvalid = 105,
                              kPoseInvalid = 109;

/// A `simulation_interfaces/TagsFilter`.
struct TagsFilter {
  std::set<std::string> tags;  ///< empty: all match
  bool all = false;            ///< whether all tags are required; false: any

  bool matches(const std::vector<std::string>& of) const;
};
TagsFilter get_tags_filter(record::CdrReader& cdr);

/// Appends a `simulation_interfaces/EntityInfo` of a mover.
void put_entity_info(record::CdrWriter& cdr, const Scene& scene, std::uint32_t row);
/// Appends the box of a mover's body in its frame as `simulation_interfaces/Bounds`; empty without a body.
void put_bounds(record::CdrWriter& cdr, const Scene& scene, std::uint32_t row);

/// A pose in a world: the start of a robot, a dock, or the start of a path.
struct NamedPose {
  std::string name, description;
  std::vector<std::string> tags;
  base::Pose X_W;
  std::uint32_t mover = ~0u;  ///< mover that starts there, if any
};
std::vector<NamedPose> named_poses_of(const Scene& scene);
/// Appends a `simulation_interfaces/NamedPose`.
void put_named_pose(record::CdrWriter& cdr, const NamedPose& pose);

/// Returns the rows of the spawnable robots: the first of each kind, at most kMostKinds.
inline constexpr std::size_t kMostKinds = 64;
std::vector<std::uint32_t> kinds_of(const world::World& world);
/// Appends a `simulation_interfaces/Spawnable`, whose URI is the robot's name.
void put_spawnable(record::CdrWriter& cdr, const Scene& scene, std::uint32_t row);

/// A request to spawn an entity, or the reason why it is refused.
struct Spawn {
  std::uint8_t code = 1;
  std::string message;
  Joining joining;  ///< valid if the code is kOk
};
/// Reads and checks the fields of a SpawnEntity.
/// @param taken names of earlier requests; adds its own name
Spawn get_spawn(record::CdrReader& cdr, const Scene& scene, const std::vector<base::Report>& movers,
                std::set<std::string>& taken);

/// A world that users may load.
struct AvailableWorld {
  std::string uri;   ///< relative path in one of the folders
  std::string file;  ///< to open it
};
/// Returns world files and maps in folders and their subfolders, sorted by URI, at most kMostWorlds. Does not follow
/// links.
inline constexpr std::size_t kMostWorlds = 1000;
std::vector<AvailableWorld> worlds_in(const std::vector<std::string>& folders);
/// Appends a `simulation_interfaces/WorldResource`.
void put_world(record::CdrWriter& cdr, const std::string& uri, const std::string& name);

}  // namespace sf::bridges
