#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/suggest.h"
#include "world/append_robot.h"
#include "world/free_space.h"
#include "world/serialization.h"
#include "world/world.h"

namespace sf::world {

namespace {

Pose inverse(const Pose& X) {
  const glm::dvec2 p = base::rotate(-X.yaw, {-X.x, -X.y});
  return {p.x, p.y, -X.z, -X.yaw};
}

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

// Returns a copy of the robot in row `original` of the world's movers, with id `id`, for row `mover`. Appends its
// models to `models`.
Mover copy_of(const World& world, std::uint32_t original, std::uint32_t id, std::uint32_t mover, const Pose& X_WM,
              const Kept& kept, std::vector<Model>& models) {
  Mover copy = world.movers[original];
  const Pose X_old = inverse(copy.X_WM);
  const std::string before = world.models[copy.model].name;
  std::string after = stem(before) + std::to_string(id);
  while (kept.names.contains(after)) after += "_";

  std::vector<std::uint32_t> rows = kept.model_rows;
  for (std::size_t row = 0; row < world.models.size(); ++row) {
    if (world.models[row].mover != original) continue;
    rows[row] = static_cast<std::uint32_t>(models.size());
    Model model = world.models[row];
    model.name = model.name.starts_with(before) ? after + model.name.substr(before.size()) : after + "." + model.name;
    model.X_WM = compose(X_WM, compose(X_old, model.X_WM));
    model.parent = renamed(rows, model.parent);
    model.mover = mover;
    models.push_back(std::move(model));
  }
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
    model.X_WM = compose(X_WM, compose(inverse(mover.X_WM), model.X_WM));
    const std::uint32_t parent = renamed(rows, model.parent);
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
  if (count == 0) throw base::InputError(world.file, 0, "asked for 0 robots: ask for at least 1");
  copy_robots(world, original, free_poses(world, world.movers[original], count, seed), {});
}

void copy_robots(World& world, std::uint32_t original, std::span<const Pose> poses,
                 std::span<const std::uint32_t> robots) {
  SF_CHECK(original < world.movers.size(), "a copy of a robot that does not exist");
  const Kept kept = keep(world, robots, poses.size());
  std::vector<Model> models = kept.models;
  std::vector<Mover> movers;
  std::set<std::uint32_t> taken;
  for (const std::uint32_t row : robots) {
    movers.push_back(kept_one(world.movers[row], kept));
    taken.insert(world.movers[row].id);
  }
  std::uint32_t id = 0;
  for (const Pose& pose : poses) {
    do ++id;
    while (taken.contains(id));
    movers.push_back(copy_of(world, original, id, static_cast<std::uint32_t>(movers.size()), pose, kept, models));
  }
  for (const Mover& tag : world.movers)
    if (tag.is_tag) movers.push_back(kept_one(tag, kept));
  retarget(world.walls, kept.model_rows);
  retarget(world.magnets, kept.model_rows);
  retarget(world.lights, kept.model_rows);
  retarget(world.emitters, kept.model_rows);
  retarget(world.floor_holes, kept.model_rows);
  world.models = std::move(models);
  world.movers = std::move(movers);
  update_extent_and_hash(world);
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
  throw base::InputError(
      world.file, 0,
      fmt::format("has no robot or type of robots '{}'{}; expected the name of a robot of this world", like,
                  base::suggest(like, names)));
}

void check_name(const World& world, const std::string& name) {
  if (!is_robot_name(name)) throw base::InputError(fmt::format("no robot can join as '{}'; {}", name, kNameRule));
  for (const Model& model : world.models)
    if (model.name == name)
      throw base::InputError(
          fmt::format("the name '{}' is taken; expected one that no model of {} has", name, world.file));
}

std::uint32_t append_robot(World& world, std::uint32_t original, const std::string& name, const Pose& X_WM) {
  return append_robot(world, world, original, name, X_WM);
}

std::uint32_t append_robot(World& world, const World& from, std::uint32_t original, const std::string& name,
                           const Pose& X_WM) {
  SF_CHECK(original < from.movers.size(), "a copy of a robot that does not exist");
  if (world.movers.size() >= kMostMovers)
    throw base::InputError(
        fmt::format("'{}' cannot join: a run has at most {} robots, counting those that left", name, kMostMovers));
  const auto row = static_cast<std::uint32_t>(world.movers.size());
  const Pose X_join{X_WM.x, X_WM.y, from.movers[original].X_WM.z, X_WM.yaw};
  const std::vector<std::uint32_t> rows = append_models(world, from, original, name, X_join);
  Mover copy = from.movers[original];
  copy.name = name;
  copy.X_WM = X_join;
  copy.id = next_id(world);
  copy.model = rows[copy.model];
  retarget(copy.body, rows);
  retarget(copy.magnets, rows);
  world.movers.push_back(std::move(copy));
  update_extent_and_hash(world);
  return row;
}

bool is_same_kind(const World& world, std::uint32_t a, std::uint32_t b) {
  const auto type = [&](std::uint32_t row) {
    const std::uint32_t model = world.movers[row].model;
    return model < world.models.size() ? world.models[model].type : std::string();
  };
  return type(a) == type(b) && kind_of(world, a) == kind_of(world, b);
}

}  // namespace sf::world
