#pragma once
// Adds robots to a world after it was loaded.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "world/world.h"

namespace sf::world {

inline constexpr std::size_t kMostMovers = 65'534;  ///< rows of a world with added robots, since ids have 16 bits
inline constexpr std::size_t kMostNameLength = 64;  ///< characters of an added robot's name

inline constexpr const char* kNameRule =
    "expected 1 to 64 letters, digits or '_', a letter first, and no '_' last or twice in a row";
bool is_robot_name(const std::string& name);

/// Returns the row of the robot called `like`, or else of the first robot whose type has that word.
/// @throws base::InputError with the names that exist
std::uint32_t robot_like(const World& world, const std::string& like);

/// @throws base::InputError if a robot cannot join as `name`. The name must be a robot name (valid in ROS topics) that
/// no other model has.
void check_name(const World& world, const std::string& name);

/// Appends a copy of the robot in row `original`, at rest at `X_WM` (on the highest road there, as high above it
/// as the original above the ground), with all models that it carries. Existing rows keep their places. The copy's id
/// is the smallest unused one from 1. Updates extent and hash, in time proportional to the size of the world.
/// Precondition: `check_name` accepts the name.
/// @return its row
/// @throws base::InputError beyond kMostMovers
std::uint32_t append_robot(World& world, std::uint32_t original, const std::string& name, const Pose& X_WM);

/// Same, for the robot in row `original` of another world. @param from may be `world`
std::uint32_t append_robot(World& world, const World& from, std::uint32_t original, const std::string& name,
                           const Pose& X_WM);

/// Appends copies of the robot in row `original`, at its place, with the ids `ids`, which no robot has, and names such
/// as roomba1_100. Updates extent and hash once.
/// @return the first row
/// @throws base::InputError beyond kMostMovers, or if a name is taken
std::uint32_t append_robots(World& world, std::uint32_t original, std::span<const std::uint32_t> ids);

/// Appends copies of the mover in row `original` of `from`, which may be `world`, as above. Does not update extent and
/// hash.
/// @throws base::InputError beyond kMostMovers, if a name is taken, or if that of a robot is invalid
void append_copies(World& world, const World& from, std::uint32_t original, std::span<const std::uint32_t> ids);

/// Appends the robot `name` of the world file `file`, at rest at the origin: a robot of that world, or else one of the
/// type that the file or its includes define under that name. Renames the robot if a model of `world` has that name.
/// Adds the file's warnings to those of `world`. Takes time proportional to the size of both worlds.
/// @return its row
/// @throws base::InputError if the file is not such a world, or does not have the name; lists the names that it has
std::uint32_t append_robot_of(World& world, const std::string& file, const std::string& name,
                              const LoadOptions& options);

/// Returns the pose of a part at `X_WM` after its robot has moved from `X_before` to `X_after`.
Pose moved_with(const Pose& X_before, const Pose& X_after, const Pose& X_WM);

/// Returns whether both rows have the same type, body, drive and sensors.
bool is_same_kind(const World& world, std::uint32_t a, std::uint32_t b);

/// Returns the rows of a table, such as `world.fiducials`, that the mover carries (kNone: the static ones), on their
/// new models.
/// @param rows new rows of models by old row; kNone: removed
template <class Row>
std::vector<Row> rows_on(const std::vector<Row>& table, const World& world, std::uint32_t mover,
                         std::span<const std::uint32_t> rows) {
  std::vector<Row> found;
  for (Row row : table) {
    if (world.models[row.model].mover != mover) continue;
    row.model = rows[row.model];
    if (row.model != kNone) found.push_back(row);
  }
  return found;
}

}  // namespace sf::world
