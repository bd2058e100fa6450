// Robots of other world files.

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "base/files.h"
#include "base/suggest.h"
#include "world/append_robot.h"
#include "world/ros_map.h"
#include "world/stage/document.h"
#include "world/stage/stage.h"

namespace sf::world {

namespace {

/// Returns the row of the robot with that name, or kNone.
std::uint32_t row_named(const World& world, const std::string& name) {
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (!world.movers[row].is_tag && world.movers[row].name == name) return row;
  return kNone;
}

/// Robots of the file, and those that it defines.
struct RobotsOfFile {
  World world;
  std::string text;                  ///< text of the file
  std::vector<std::string> defined;  ///< names of types
};

RobotsOfFile read_robots(const std::string& file, const LoadOptions& options) {
  RobotsOfFile robots{load_world(file, options), "", {}};
  if (is_ros_map(file)) return robots;
  robots.text = base::read_text(file);
  robots.defined = parse(file, robots.text).robots;
  return robots;
}

[[noreturn]] void refuse_name(const RobotsOfFile& robots, const std::string& file, const std::string& name) {
  constexpr std::size_t kShown = 20;
  std::vector<std::string_view> names;
  for (const Mover& mover : robots.world.movers)
    if (!mover.is_tag) names.emplace_back(mover.name);
  names.insert(names.end(), robots.defined.begin(), robots.defined.end());
  if (names.empty())
    throw base::InputError(file, 0, "has no robots; expected a world file with one, or with define NAME position( )");
  const std::string problem = name.empty() ? "no robot of it is named, as in FILE:NAME"
                                           : fmt::format("has no robot '{}'{}", name, base::suggest(name, names));
  const std::size_t more = names.size() > kShown ? names.size() - kShown : 0;
  names.resize(names.size() - more);
  throw base::InputError(file, 0,
                         fmt::format("{}; expected one of: {}{}", problem, fmt::join(names, ", "),
                                     more > 0 ? fmt::format(" and {} more", more) : ""));
}

/// Appends to `name` until no model of `world` has it.
std::string free_model_name(const World& world, std::string name) {
  const auto taken = [&] {
    return std::any_of(world.models.begin(), world.models.end(), [&](const Model& m) { return m.name == name; });
  };
  while (taken()) name += "_";
  return name;
}

}  // namespace

std::uint32_t append_robot_of(World& world, const std::string& file, const std::string& name,
                              const LoadOptions& options) {
  LoadOptions load = options;
  load.leave_outlines = true;
  RobotsOfFile robots = read_robots(file, load);
  std::uint32_t original = row_named(robots.world, name);
  if (original == kNone) {
    const auto& defined = robots.defined;
    if (std::find(defined.begin(), defined.end(), name) == defined.end()) refuse_name(robots, file, name);
    robots.world = build_world(file, fmt::format("{}\n{}( )\n", robots.text, name), load);
    original = static_cast<std::uint32_t>(robots.world.movers.size() - 1);
    // The robot's place in that world does not matter.
    const auto lines = std::count(robots.text.begin(), robots.text.end(), '\n') + 1;
    std::erase_if(robots.world.warnings, [&](const Warning& w) { return w.file == file && w.line > lines; });
  }
  world.warnings.insert(world.warnings.end(), robots.world.warnings.begin(), robots.world.warnings.end());
  return append_robot(world, robots.world, original, free_model_name(world, name), {});
}

}  // namespace sf::world
