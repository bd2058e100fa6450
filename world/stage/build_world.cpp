#include "world/stage/build_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "world/foreign_world.h"
#include "world/free_space.h"
#include "world/keys.h"
#include "world/meshes/textures.h"
#include "world/outlines.h"
#include "world/overlaps.h"
#include "world/ros_map.h"
#include "world/stage/build_state.h"
#include "world/stage/earth_field.h"
#include "world/stage/entity_color.h"
#include "world/stage/light_entities.h"
#include "world/stage/mover_entities.h"
#include "world/stage/read_keys.h"
#include "world/stage/terrain_entity.h"

namespace sf::world {

namespace {

void read_units(StageContext& context, const Entity& root) {
  const std::string length_unit = text(context, root, "unit_length", "m");
  if (length_unit == "cm") {
    context.metres_per_unit = 0.01;
  } else if (length_unit == "mm") {
    context.metres_per_unit = 0.001;
  } else if (length_unit != "m") {
    fail(context, find(root, "unit_length")->at,
         fmt::format("'unit_length' is \"{}\"; expected \"m\", \"cm\" or \"mm\"", length_unit));
  }
  const std::string angle_unit = text(context, root, "unit_angle", "degrees");
  if (angle_unit == "radians") {
    context.radians_per_unit = 1.0;
  } else if (angle_unit != "degrees") {
    fail(context, find(root, "unit_angle")->at,
         fmt::format("'unit_angle' is \"{}\"; expected \"degrees\" or \"radians\"", angle_unit));
  }
}

// Files of other programs may match Stage's grammar by chance.
void warn_of_nothing(BuildState& b, const Entity& root) {
  const bool has_known = std::any_of(root.children.begin(), root.children.end(), [](const Entity& child) {
    const EntityKind kind = entity_kind(child.type);
    return kind != EntityKind::unknown && kind != EntityKind::ignored;
  });
  if (has_known || !b.world.walls.empty() || !b.world.movers.empty()) return;
  warn(b.context, {0, 0}, "no wall, robot or other known model in this file: is it a Stage world? The world is empty");
}

/// @param option the user's option, which overrides the file
StageRule stage_rule(const StageContext& context, const Entity& root, std::string_view key, bool option) {
  return {option || flag(context, root, key, false), option || find(root, key) != nullptr};
}

// Player's configuration files have Stage's grammar and refer to a world.
void refuse_player_file(const Document& document) {
  for (const Entity& child : document.root.children) {
    if (child.type != "driver") continue;
    const Property* world = find(child, "worldfile");
    if (world == nullptr && find(child, "provides") == nullptr && find(child, "plugin") == nullptr) continue;
    throw base::InputError(
        document.files[child.at.file], child.at.line,
        fmt::format("'driver' belongs to a configuration file of Player; expected a world: load {}",
                    world != nullptr && !world->values.empty() ? '"' + world->values[0].text + '"'
                                                               : std::string("the world that its `worldfile` names")));
  }
}

/// "'a', 'b', 'c' and 4 more".
std::string names_of(const World& world, const std::vector<std::uint32_t>& rows) {
  constexpr std::size_t kShown = 3;
  std::string names;
  for (std::size_t i = 0; i < rows.size() && i < kShown; ++i)
    names += fmt::format("{}'{}'", i == 0 ? "" : ", ", world.movers[rows[i]].name);
  return rows.size() <= kShown ? names : fmt::format("{} and {} more", names, rows.size() - kShown);
}

// Groups problems: the walls of all models are one kind of place.
std::string kind_of(const std::string& problem) {
  constexpr std::string_view kPartly = "partly in a wall";
  return problem.starts_with(kPartly) ? std::string(kPartly) : problem;
}

// Adds one warning for each kind of place.
void warn_of_places(BuildState& b) {
  const PlaceCheck check(b.world);
  std::map<std::string, std::vector<std::uint32_t>> rows_of;
  for (std::uint32_t row = 0; row < b.world.movers.size(); ++row) {
    const Mover& robot = b.world.movers[row];
    const std::string problem = robot.is_tag ? "" : check.problem(robot, robot.X_WM);
    if (!problem.empty()) rows_of[kind_of(problem)].push_back(row);
  }
  for (const auto& [kind, rows] : rows_of) {
    const std::string first = check.start_problem(b.world.movers[rows[0]]);
    warn(b.context, b.locations[rows[0]],
         rows.size() == 1
             ? first
             : fmt::format("{} robots start {}: {}; the first: {}", rows.size(), kind, names_of(b.world, rows), first));
  }
}

void warn_of_overlaps(BuildState& b) {
  const Overlaps found = find_overlaps(b.world);
  if (!found.complete)
    warn(b.context, b.locations[0], "this world has too many robots near each other to check all for overlaps");
  if (found.robots.empty()) return;
  const auto& [first, second] = found.pairs[0];
  warn(b.context, b.locations[second],
       fmt::format(
           "{} robots overlap others at the start: {}; '{}' starts at ({:g}, {:g}), in '{}': expected separate poses",
           found.robots.size(), names_of(b.world, found.robots), b.world.movers[second].name,
           b.world.movers[second].X_WM.x, b.world.movers[second].X_WM.y, b.world.movers[first].name));
}

}  // namespace

/// Adds the light of cameras, if it is not the default.
void read_daylight(BuildState& b, const Entity& root) {
  Daylight day;
  bool given = find(root, "floor_color") != nullptr;
  for_each_key<Daylight>([&](const auto& field) { given = given || find(root, field.key.name) != nullptr; });
  if (!given) return;
  read_keys(b.context, root, day);
  if (text(b.context, root, "floor_color", "") == "random")
    warn(b.context, find(root, "floor_color")->at,
         "only models have random colours; expected a name of X11, e.g. \"gray69\"");
  else
    day.floor = entity_color(b.context, root, "floor_color", day.floor, 0);
  b.world.daylight.push_back(day);
}

/// Adds the reflectances of the ground, if they are not the default.
void read_ground(BuildState& b, const Entity& root) {
  bool given = false;
  for_each_key<GroundReflectance>([&](const auto& field) { given |= find(root, field.key.name) != nullptr; });
  if (given) read_keys(b.context, root, b.world.ground.emplace_back());
}

World build_world(const std::string& file, const std::string& content, const LoadOptions& options) {
  refuse_foreign(file, content);
  const Document document = parse(file, content);
  refuse_player_file(document);
  BuildState b{
      .options = options, .context = {.document = document, .warnings = document.warnings}, .types = known_types()};
  b.types.insert(b.types.end(), document.macros.begin(), document.macros.end());

  read_units(b.context, document.root);
  b.context.obstacles = stage_rule(b.context, document.root, "stage_obstacles", options.stage_obstacles);
  b.context.noise = stage_rule(b.context, document.root, "stage_noise", options.stage_noise);
  b.world.floor_unseen = !flag(b.context, document.root, "floor_return", true);
  b.context.old_shapes = flag(b.context, document.root, "old_shapes", false);
  check_keys(b.context, document.root, KeyScope::world);
  b.world.file = file;
  b.world.name = std::filesystem::path(file).stem().string();
  read_keys(b.context, document.root, b.world);
  b.world.accuracy = accuracy(b.context, options, document.root);
  read_terrain(b, document.root);
  read_daylight(b, document.root);
  read_ground(b, document.root);
  Parent nowhere;
  add_children(b, document.root, nowhere);
  if (!document.ros_map.empty()) add_ros_map(b.world, document.ros_map, options);
  read_earth_field(b, document.root);
  number_movers(b);
  check_stop_lines(b);

  if (!options.leave_outlines) read_unread(b.world);
  read_textures(b.world, b.triangles);
  update_extent_and_hash(b.world);
  warn_of_nothing(b, document.root);
  if (b.world.road_resolution > 0.0 && !b.world.ramps.empty())
    b.context.warnings.push_back(
        {file, location_of(document.root, "road_resolution").line,
         "a raster of lane markings has no heights, but the roads have: lane edge sensors read "
         "the markings of all levels; remove 'road_resolution' for exact markings"});
  if (!b.world.movers.empty()) warn_of_overlaps(b);
  if (!b.world.movers.empty() && b.world.unread.empty()) warn_of_places(b);
  b.world.warnings.insert(b.world.warnings.begin(), b.context.warnings.begin(), b.context.warnings.end());
  return std::move(b.world);
}

}  // namespace sf::world
