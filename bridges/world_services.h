#pragma once
// Robots of a run as entities of simulation_interfaces, places for new ones, kinds of robots, and worlds.

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "bridges/bridge.h"
#include "record/cdr.h"

namespace sf::bridges {

/// Result codes of simulation_interfaces: those of all services, then those of SpawnEntity.
inline constexpr std::uint8_t kUnsupported = 0, kOk = 1, kNotFound = 2, kFailed = 4, kNameTaken = 101,
                              kNameInvalid = 102, kUnsupportedFormat = 103, kNoResource = 104, kNamespaceInvalid = 105,
                              kPoseInvalid = 109;

/// A `simulation_interfaces/TagsFilter`.
struct TagsFilter {
  std::set<std::string> tags;  ///< empty: all match
  bool all = false;            ///< all of them are needed; false: any

  bool matches(const std::vector<std::string>& of) const;
};
TagsFilter get_tags_filter(record::CdrReader& cdr);

/// Appends a `simulation_interfaces/EntityInfo` of a mover.
void put_entity_info(record::CdrWriter& cdr, const Scene& scene, std::uint32_t row);
/// Appends the box of a mover's body in its frame as `simulation_interfaces/Bounds`; none where it has no body.
void put_bounds(record::CdrWriter& cdr, const Scene& scene, std::uint32_t row);

/// A place of a world: where a robot is at load, a dock, or the begin of a path.
struct NamedPose {
  std::string name, description;
  std::vector<std::string> tags;
  base::Pose X_W;
  std::uint32_t mover = ~0u;  ///< that starts there; none for other places
};
std::vector<NamedPose> named_poses_of(const Scene& scene);
/// Appends a `simulation_interfaces/NamedPose`.
void put_named_pose(record::CdrWriter& cdr, const NamedPose& pose);

/// Rows of the robots that can be spawned: the first of each kind, at most kMostKinds.
inline constexpr std::size_t kMostKinds = 64;
std::vector<std::uint32_t> kinds_of(const world::World& world);
/// Appends a `simulation_interfaces/Spawnable`, whose URI is the robot's name.
void put_spawnable(record::CdrWriter& cdr, const Scene& scene, std::uint32_t row);

/// A request to spawn an entity, or why it is refused.
struct Spawn {
  std::uint8_t code = 1;
  std::string message;
  Joining joining;  ///< where the code is kOk
};
/// Reads the fields of a SpawnEntity and checks them. @param taken names of requests before, which it adds to
Spawn get_spawn(record::CdrReader& cdr, const Scene& scene, const std::vector<base::Report>& movers,
                std::set<std::string>& taken);

/// A world that users may load.
struct AvailableWorld {
  std::string uri;   ///< its path in one of the folders
  std::string file;  ///< to open it
};
/// World files and maps in folders and their subfolders, at most kMostWorlds, by URI. Links are not followed.
inline constexpr std::size_t kMostWorlds = 1000;
std::vector<AvailableWorld> worlds_in(const std::vector<std::string>& folders);
/// Appends a `simulation_interfaces/WorldResource`.
void put_world(record::CdrWriter& cdr, const std::string& uri, const std::string& name);

}  // namespace sf::bridges
