#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/suggest.h"
#include "world/append_robot.h"
#include "world/free_space.h"
#include "world/world.h"

namespace sf::world {

namespace {

std::string stem(const std::string& name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  return last == std::string::npos ? name : name.substr(0, last + 1);
}

std::uint32_t renamed(const std::vector<std::uint32_t>& rows, std::uint32_t row) {
  return row == kNone ? kNone : rows[row];
}

// Removes robots: `models` keeps static models, tags and the robots in `robots`. Maps old rows of models and movers to
// new ones.
struct Kept {
  std::vector<Model> models;
  std::vector<std::uint32_t> model_rows;  // kNone: removed
  std::vector<std::uint32_t> mover_rows;
  std::set<std::string> names;
};

Kept keep(const World& world, std::span<const std::uint32_t> robots, std::size_t copies) {
  Kept kept{.models = {},
            .model_rows = std::vector<std::uint32_t>(world.models.size(), kNone),
            .mover_rows = std::vector<std::uint32_t>(world.movers.size(), kNone),
            .names = {}};
  std::uint32_t next = 0;
  for (const std::uint32_t row : robots) kept.mover_rows[row] = next++;
  next += static_cast<std::uint32_t>(copies);
  for (std::size_t row = 0; row < world.movers.size(); ++row) {
    if (world.movers[row].is_tag) kept.mover_rows[row] = next++;
  }
  for (std::size_t row = 0; row < world.models.size(); ++row) {
    const Model& model = world.models[row];
    if (model.mover != kNone && kept.mover_rows[model.mover] == kNone) continue;
    kept.model_rows[row] = static_cast<std::uint32_t>(kept.models.size());
    kept.models.push_back(model);
    kept.names.insert(model.name);
  }
  for (Model& model : kept.models) {
    model.parent = renamed(kept.model_rows, model.parent);
    model.mover = renamed(kept.mover_rows, model.mover);
  }
  return kept;
}

template <class Row>
void retarget(std::vector<Row>& table, const std::vector<std::uint32_t>& rows) {
  for (Row& row : table) row.model = rows[row.model];
}

/// Models, and tables of what they carry.
struct Carried {
  std::vector<Model> models;
  std::vector<Fiducial> fiducials;
  std::vector<MeshModel> meshes;
  std::vector<Reflectance> reflectances;

  void add(const World& world, std::uint32_t mover, std::span<const std::uint32_t> rows) {
    std::ranges::copy(rows_on(world.fiducials, world, mover, rows), std::back_inserter(fiducials));
    std::ranges::copy(rows_on(world.mesh_models, world, mover, rows), std::back_inserter(meshes));
    std::ranges::copy(rows_on(world.reflectances, world, mover, rows), std::back_inserter(reflectances));
  }
};

// Returns a copy of the robot in row `original` of the world's movers, with id `id`, for row `mover`. Appends its
// models and their tables to `carried`.
Mover copy_of(const World& world, std::uint32_t original, std::uint32_t id, std::uint32_t mover, const Pose& X_WM,
              const Kept& kept, Carried& carried) {
  Mover copy = world.movers[original];
  const std::string before = world.models[copy.model].name;
  std::string after = stem(before) + std::to_string(id);
  while (kept.names.contains(after)) after += "_";

  std::vector<std::uint32_t> rows = kept.model_rows;
  for (std::size_t row = 0; row < world.models.size(); ++row) {
    if (world.models[row].mover != original) continue;
    rows[row] = static_cast<std::uint32_t>(carried.models.size());
    Model model = world.models[row];
    model.name = model.name.starts_with(before) ? after + model.name.substr(before.size()) : after + "." + model.name;
    model.X_WM = moved_with(copy.X_WM, X_WM, model.X_WM);
    model.parent = renamed(rows, model.parent);
    model.mover = mover;
    carried.models.push_back(std::move(model));
  }
  carried.add(world, original, rows);
  copy.name = after;
  copy.id = id;
  copy.X_WM = X_WM;
  copy.model = rows[copy.model];
  retarget(copy.body, rows);
  retarget(copy.magnets, rows);
  return copy;
}

Mover kept_one(const Mover& mover, const Kept& kept) {
  Mover same = mover;
  same.model = kept.model_rows[same.model];
  retarget(same.body, kept.model_rows);
  retarget(same.magnets, kept.model_rows);
  return same;
}

}  // namespace

std::uint32_t robot_to_copy(const World& world, const std::string& name) {
  std::vector<std::string_view> names;
  std::uint32_t found = kNone;
  bool senses = false;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    const Mover& mover = world.movers[row];
    if (mover.is_tag) continue;
    if (!name.empty() && mover.name == name) return row;
    names.emplace_back(mover.name);
    const bool has = !mover.sensors.empty();
    if (found != kNone && (senses || !has)) continue;
    found = row;
    senses = has;
  }
  if (found == kNone) throw base::InputError(world.file, 0, "has no robot to copy: add one, such as a position model");
  if (name.empty()) return found;
  throw base::InputError(world.file, 0, fmt::format("has no robot '{}' to copy{}", name, base::suggest(name, names)));
}

void clone_robots(World& world, std::uint32_t count, std::uint64_t seed) { clone_robots(world, count, seed, ""); }

void clone_robots(World& world, std::uint32_t count, std::uint64_t seed, const std::string& of) {
  const std::uint32_t original = robot_to_copy(world, of);
  if (count == 0) throw base::InputError(world.file, 0, "0 robots requested; expected at least 1");
  copy_robots(world, original, free_poses(world, world.movers[original], count, seed), {});
}

void copy_robots(World& world, std::uint32_t original, std::span<const Pose> poses,
                 std::span<const std::uint32_t> robots) {
  SF_CHECK(original < world.movers.size(), "a copy of a robot that does not exist");
  const Kept kept = keep(world, robots, poses.size());
  Carried carried{kept.models, {}, {}, {}};
  std::vector<Mover> movers;
  carried.add(world, kNone, kept.model_rows);
  const bool any = !world.fiducials.empty() || !world.mesh_models.empty() || !world.reflectances.empty();
  for (std::uint32_t row = 0; row < (any ? world.movers.size() : 0); ++row) carried.add(world, row, kept.model_rows);
  std::set<std::uint32_t> taken;
  for (const std::uint32_t row : robots) {
    movers.push_back(kept_one(world.movers[row], kept));
    taken.insert(world.movers[row].id);
  }
  std::uint32_t id = 0;
  for (const Pose& pose : poses) {
    do ++id;
    while (taken.contains(id));
    movers.push_back(copy_of(world, original, id, static_cast<std::uint32_t>(movers.size()), pose, kept, carried));
  }
  for (const Mover& tag : world.movers)
    if (tag.is_tag) movers.push_back(kept_one(tag, kept));
  retarget(world.walls, kept.model_rows);
  retarget(world.magnets, kept.model_rows);
  retarget(world.lights, kept.model_rows);
  retarget(world.emitters, kept.model_rows);
  retarget(world.lamps, kept.model_rows);
  retarget(world.heat_sources, kept.model_rows);
  world.fiducials = std::move(carried.fiducials);
  world.mesh_models = std::move(carried.meshes);
  world.reflectances = std::move(carried.reflectances);
  retarget(world.floor_holes, kept.model_rows);
  world.models = std::move(carried.models);
  world.movers = std::move(movers);
  world.changed_shapes.clear();
  update_extent_and_hash(world);
}

}  // namespace sf::world
