#include "world/append_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <string_view>

#include "base/error.h"
#include "base/files.h"
#include "base/suggest.h"
#include "world/beam_table.h"
#include "world/ground.h"
#include "world/meshes/textures.h"
#include "world/ros_map.h"
#include "world/serialization.h"
#include "world/shapes.h"
#include "world/stage/build_world.h"
#include "world/stage/document.h"

namespace sf::world {

namespace {

/// Appends the models of `original`, renamed and moved with it.
/// @param from may be `world`
/// @return new rows by old row
std::vector<std::uint32_t> append_models(World& world, const World& from, std::uint32_t original,
                                         const std::string& name, const Pose& X_WM) {
  const Mover& mover = from.movers[original];
  const std::string before = from.models[mover.model].name;
  const auto row = static_cast<std::uint32_t>(world.movers.size());
  std::vector<std::uint32_t> rows(from.models.size(), kNone);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (from.models[i].mover != original) continue;
    rows[i] = static_cast<std::uint32_t>(world.models.size());
    Model model = from.models[i];
    const bool is_nested = model.name == before || model.name.starts_with(before + ".");
    model.name = name + (is_nested ? model.name.substr(before.size()) : "." + model.name);
    model.X_WM = moved_with(mover.X_WM, X_WM, model.X_WM);
    const std::uint32_t parent = model.parent == kNone ? kNone : rows[model.parent];
    if (parent != kNone || &from != &world) model.parent = parent;
    model.mover = row;
    world.models.push_back(std::move(model));
  }
  return rows;
}

std::uint32_t next_id(const World& world) {
  std::set<std::uint32_t> taken;
  for (const Mover& mover : world.movers)
    if (!mover.is_tag) taken.insert(mover.id);
  std::uint32_t id = 1;
  while (taken.contains(id)) ++id;
  return id;
}

/// Returns all properties of a mover that readings depend on, except its place, its name and its rows.
base::Bytes kind_of(const World& world, std::uint32_t row) {
  Mover mover = world.movers[row];
  mover.name.clear();
  mover.id = 0, mover.X_WM = {}, mover.model = 0;
  for (Segment& side : mover.body) side.model = 0;
  for (Magnet& magnet : mover.magnets) magnet.model = 0;
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  RowWriter{out, RowFields::physics}.put(mover);
  return bytes;
}

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
  const std::size_t more = names.size() > kShown ? names.size() - kShown : 0;
  const std::vector<std::string_view> shown(names.begin(), names.end() - static_cast<std::ptrdiff_t>(more));
  const std::string expected =
      fmt::format("expected one of: {}{}", fmt::join(shown, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
  throw base::InputError(file, 0,
                         name.empty() ? "requires the name of a robot, as in FILE:NAME; " + expected
                                      : fmt::format("has no robot '{}'{}", name, base::suggest(name, names, expected)));
}

void require_free(const World& world, const std::string& name) {
  if (std::ranges::find(world.models, name, &Model::name) != world.models.end())
    throw base::InputError(
        fmt::format("the name '{}' is taken; expected one that no model of {} has", name, world.file));
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

/// Returns the row of a mesh of another world, which is appended with its materials unless it is there, without its
/// textures (read_textures).
std::uint32_t mesh_row(World& world, const World& from, std::uint32_t mesh_of_other) {
  const Mesh& mesh = from.meshes[mesh_of_other];
  const auto same = [&](const Mesh& other) {
    return other.file == mesh.file && other.vertices == mesh.vertices && other.corners == mesh.corners;
  };
  const auto found = std::ranges::find_if(world.meshes, same);
  const auto row = static_cast<std::uint32_t>(found - world.meshes.begin());
  if (row < world.meshes.size()) return row;
  world.meshes.push_back(mesh);
  for (MeshMaterials materials : from.mesh_materials)
    if (materials.mesh == mesh_of_other) materials.mesh = row, world.mesh_materials.push_back(std::move(materials));
  return row;
}

/// Appends a copy with all models that it carries. Does not update extent and hash.
void append_copy(World& world, const World& from, std::uint32_t original, const std::string& name, const Pose& X_WM,
                 std::uint32_t id) {
  if (world.movers.size() >= kMostMovers)
    throw base::InputError(
        fmt::format("'{}' cannot join: a run has at most {} robots, including those that left", name, kMostMovers));
  const std::vector<std::uint32_t> rows = append_models(world, from, original, name, X_WM);
  Mover copy = from.movers[original];
  copy.name = name;
  copy.X_WM = X_WM;
  copy.id = id;
  copy.model = rows[copy.model];
  for (Segment& side : copy.body) side.model = rows[side.model];
  for (Magnet& magnet : copy.magnets) magnet.model = rows[magnet.model];
  const std::vector<Fiducial> fiducials = rows_on(from.fiducials, from, original, rows);
  for (MeshModel row : rows_on(from.mesh_models, from, original, rows)) {
    if (&from != &world) row.mesh = mesh_row(world, from, row.mesh);
    world.mesh_models.push_back(row);
  }
  for (const Sensor& sensor : copy.sensors)
    for (const Setting& setting : sensor.settings)
      if (const BeamTable* const table = find_beam_table(from, setting); table != nullptr && &from != &world)
        if (find_beam_table(world, setting) == nullptr) world.beam_tables.push_back(*table);
  const std::vector<Reflectance> reflectances = rows_on(from.reflectances, from, original, rows);
  world.reflectances.insert(world.reflectances.end(), reflectances.begin(), reflectances.end());
  world.movers.push_back(std::move(copy));
  world.fiducials.insert(world.fiducials.end(), fiducials.begin(), fiducials.end());
  restore_copy(world, static_cast<std::uint32_t>(world.movers.size() - 1), from, original);
}

Pose moved_with(const Pose& X_before, const Pose& X_after, const Pose& X_WM) {
  return compose(X_after, compose(inverse(X_before), X_WM));
}

bool is_robot_name(const std::string& name) {
  const auto is_plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  return !name.empty() && name.size() <= kMostNameLength && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
         name.back() != '_' && name.find("__") == std::string::npos && std::all_of(name.begin(), name.end(), is_plain);
}

std::uint32_t robot_like(const World& world, const std::string& like) {
  std::vector<std::string_view> names;
  std::uint32_t of_type = kNone;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    const Mover& mover = world.movers[row];
    if (mover.is_tag) continue;
    if (mover.name == like) return row;
    names.emplace_back(mover.name);
    if (of_type == kNone && world.models[mover.model].type == like) of_type = row;
  }
  if (of_type != kNone) return of_type;
  throw base::InputError(world.file, 0,
                         fmt::format("has no robot or type of robots '{}'{}", like,
                                     base::suggest(like, names, "expected the name of a robot of this world")));
}

void check_name(const World& world, const std::string& name) {
  if (!is_robot_name(name)) throw base::InputError(fmt::format("no robot can join as '{}'; {}", name, kNameRule));
  require_free(world, name);
}

std::uint32_t append_robot(World& world, std::uint32_t original, const std::string& name, const Pose& X_WM) {
  return append_robot(world, world, original, name, X_WM);
}

std::uint32_t append_robot(World& world, const World& from, std::uint32_t original, const std::string& name,
                           const Pose& X_WM) {
  SF_CHECK(original < from.movers.size(), "a copy of a robot that does not exist");
  const double clearance = clearance_of(from, from.movers[original]);
  const Pose X_join{X_WM.x, X_WM.y, height_on_road(world, {X_WM.x, X_WM.y}, clearance), X_WM.yaw};
  append_copy(world, from, original, name, X_join, next_id(world));
  update_extent_and_hash(world);
  return static_cast<std::uint32_t>(world.movers.size() - 1);
}

void append_copies(World& world, const World& from, std::uint32_t original, std::span<const std::uint32_t> ids) {
  const std::string name = from.movers[original].name;
  const Pose X_WM = from.movers[original].X_WM;
  const bool is_tag = from.movers[original].is_tag;
  for (const std::uint32_t id : ids) {
    const std::string own = fmt::format("{}_{}", name, id);
    is_tag ? require_free(world, own) : check_name(world, own);
    append_copy(world, from, original, own, X_WM, id);
  }
}

std::uint32_t append_robots(World& world, std::uint32_t original, std::span<const std::uint32_t> ids) {
  const auto first = static_cast<std::uint32_t>(world.movers.size());
  append_copies(world, world, original, ids);
  update_extent_and_hash(world);
  return first;
}

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
  const std::uint32_t row = append_robot(world, robots.world, original, free_model_name(world, name), {});
  std::map<std::string, Triangles> files;
  if (read_textures(world, files)) update_extent_and_hash(world);
  return row;
}

bool is_same_kind(const World& world, std::uint32_t a, std::uint32_t b) {
  const auto type = [&](std::uint32_t row) {
    const std::uint32_t model = world.movers[row].model;
    return model < world.models.size() ? world.models[model].type : std::string();
  };
  const DynamicsChoice &p = world.movers[a].dynamics, &q = world.movers[b].dynamics;
  return type(a) == type(b) && p.name == q.name && p.settings == q.settings && kind_of(world, a) == kind_of(world, b);
}

}  // namespace sf::world
