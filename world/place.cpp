#include <algorithm>
#include <set>
#include <string>

#include "base/error.h"
#include "world/free_space.h"
#include "world/world.h"

namespace sf::world {

namespace {

Pose inverse(const Pose& X) {
  const Vec2 p = base::rotate(-X.yaw, {-X.x, -X.y});
  return {p.x, p.y, -X.z, -X.yaw};
}

std::string stem(const std::string& name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  return last == std::string::npos ? name : name.substr(0, last + 1);
}

std::uint32_t renamed(const std::vector<std::uint32_t>& rows, std::uint32_t row) {
  return row == kNone ? kNone : rows[row];
}

// Takes the other robots away: `models` keeps what stands still and the tags; gives new rows of old models and movers.
struct Kept {
  std::vector<Model> models;
  std::vector<std::uint32_t> model_rows;  // kNone: gone
  std::vector<std::uint32_t> mover_rows;
  std::set<std::string> names;
};

Kept keep_others(const World& world, std::uint32_t count) {
  Kept kept{.models = {},
            .model_rows = std::vector<std::uint32_t>(world.models.size(), kNone),
            .mover_rows = std::vector<std::uint32_t>(world.movers.size(), kNone),
            .names = {}};
  std::uint32_t next = count;
  for (std::size_t row = 0; row < world.movers.size(); ++row) {
    if (world.movers[row].is_tag) kept.mover_rows[row] = next++;
  }
  for (std::size_t row = 0; row < world.models.size(); ++row) {
    const Model& model = world.models[row];
    if (model.mover != kNone && !world.movers[model.mover].is_tag) continue;
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

// Copy k of the robot in row `original` of the world's movers, its models appended to `models`.
Mover copy_of(const World& world, std::uint32_t original, std::uint32_t k, const Pose& X_WM, const Kept& kept,
              std::vector<Model>& models) {
  Mover copy = world.movers[original];
  const Pose X_old = inverse(copy.X_WM);
  const std::string before = world.models[copy.model].name;
  std::string after = stem(before) + std::to_string(k + 1);
  while (kept.names.contains(after)) after += "_";

  std::vector<std::uint32_t> rows = kept.model_rows;
  for (std::size_t row = 0; row < world.models.size(); ++row) {
    if (world.models[row].mover != original) continue;
    rows[row] = static_cast<std::uint32_t>(models.size());
    Model model = world.models[row];
    model.name = model.name.starts_with(before) ? after + model.name.substr(before.size()) : after + "." + model.name;
    model.X_WM = compose(X_WM, compose(X_old, model.X_WM));
    model.parent = renamed(rows, model.parent);
    model.mover = k;
    models.push_back(std::move(model));
  }
  copy.name = after;
  copy.id = k + 1;
  copy.X_WM = X_WM;
  copy.model = rows[copy.model];
  retarget(copy.body, rows);
  retarget(copy.magnets, rows);
  return copy;
}

}  // namespace

void clone_robots(World& world, std::uint32_t count, std::uint64_t seed) {
  const auto first = std::find_if(world.movers.begin(), world.movers.end(), [](const Mover& m) { return !m.is_tag; });
  if (first == world.movers.end())
    throw base::InputError(world.file, 0, "has no robot to copy: add one, such as a position model");
  if (count == 0) throw base::InputError(world.file, 0, "asked for 0 robots: ask for at least 1");
  const std::vector<Pose> poses = free_poses(world, *first, count, seed);

  const auto original = static_cast<std::uint32_t>(first - world.movers.begin());
  const Kept kept = keep_others(world, count);
  std::vector<Model> models = kept.models;
  std::vector<Mover> movers;
  for (std::uint32_t k = 0; k < count; ++k) movers.push_back(copy_of(world, original, k, poses[k], kept, models));
  for (Mover& tag : world.movers) {
    if (!tag.is_tag) continue;
    tag.model = kept.model_rows[tag.model];
    retarget(tag.body, kept.model_rows);
    retarget(tag.magnets, kept.model_rows);
    movers.push_back(std::move(tag));
  }
  retarget(world.walls, kept.model_rows);
  retarget(world.magnets, kept.model_rows);
  retarget(world.lights, kept.model_rows);
  retarget(world.emitters, kept.model_rows);
  retarget(world.drops, kept.model_rows);
  world.models = std::move(models);
  world.movers = std::move(movers);
  finish(world);
}

}  // namespace sf::world
