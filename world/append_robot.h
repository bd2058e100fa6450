#pragma once
// Robots that join a world after it was loaded.

#include <cstdint>
#include <string>

#include "world/world.h"

namespace sf::world {

inline constexpr std::size_t kMostMovers = 65'534;  ///< rows of a world that robots join, since ids have 16 bits
inline constexpr std::size_t kMostNameLength = 64;  ///< of a robot that joins

inline constexpr const char* kNameRule =
    "expected 1 to 64 letters, digits or '_', a letter first, and no '_' last or twice in a row";
bool is_robot_name(const std::string& name);

/// The row of the robot that `like` names: by its name, else the first with that word for its type.
/// @throws base::InputError with the names that exist
std::uint32_t robot_like(const World& world, const std::string& like);

/// @throws base::InputError where a robot cannot join under `name`, which must be a robot name, such as topics of ROS
/// have, and the name of no other model
void check_name(const World& world, const std::string& name);

/// Appends a copy of the robot in row `original` at rest at `X_WM` (its height above ground stays that of the
/// original), with all models that it carries. Rows that exist keep their places; its id is the smallest from 1 that no
/// row has. Updates extent and hash: takes time in proportion to the world.
/// Rule: `check_name` accepts the name.
/// @return its row @throws base::InputError beyond kMostMovers
std::uint32_t append_robot(World& world, std::uint32_t original, const std::string& name, const Pose& X_WM);

/// The same for the robot in row `original` of another world. @param from may be `world`
std::uint32_t append_robot(World& world, const World& from, std::uint32_t original, const std::string& name,
                           const Pose& X_WM);

/// Appends the robot `name` of the world file `file`, at rest at the origin: a robot of that world, else one of the
/// type that the file or its includes define by that name. `name` is changed where a model of `world` has it. Warnings
/// of the file are added to those of `world`. Takes time in proportion to both worlds.
/// @return its row @throws base::InputError for a file that is no such world, and a name that it does not have, with
/// the names that it has
std::uint32_t append_robot_of(World& world, const std::string& file, const std::string& name,
                              const LoadOptions& options);

/// Both rows have the same type, body, drive and sensors.
bool is_same_kind(const World& world, std::uint32_t a, std::uint32_t b);

}  // namespace sf::world
