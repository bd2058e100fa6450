#include "world/append_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "base/suggest.h"
#include "world/append_robot.h"

namespace sf::world {

namespace {

template <class Row>
std::uint32_t row_with_name(const std::vector<Row>& rows, const std::string& name) {
  const auto found = std::ranges::find(rows, name, &Row::name);
  return found == rows.end() ? kNone : static_cast<std::uint32_t>(found - rows.begin());
}

JoiningTemplate template_of(const World& world, std::uint32_t mover) {
  const bool is_tag = world.movers[mover].is_tag;
  return {is_tag ? JoiningKind::object : JoiningKind::robot, is_tag ? world.movers[mover].model : mover};
}

[[noreturn]] void refuse_template(const World& world, const std::string& name) {
  std::vector<std::string_view> names;
  for (const Mover& mover : world.movers) names.emplace_back(mover.name);
  for (const Light& light : world.lights) names.emplace_back(light.name);
  throw base::InputError(world.file, 0,
                         fmt::format("has no robot, object or light '{}'{}", name,
                                     base::suggest(name, names, "expected the name of a model of this world")));
}

/// Marks the models within `root`, which parents precede.
std::vector<bool> parts_of(const World& world, std::uint32_t root) {
  std::vector<bool> inside(world.models.size(), false);
  for (std::uint32_t row = root; row < inside.size(); ++row) {
    const std::uint32_t parent = world.models[row].parent;
    inside[row] = row == root || (parent != kNone && inside[parent]);
  }
  return inside;
}

void require_movable(const World& world, std::uint32_t root) {
  const std::vector<bool> inside = parts_of(world, root);
  const auto has = [&](const auto& rows) {
    return std::ranges::any_of(rows, [&](const auto& row) { return inside[row.model]; });
  };
  const std::string& name = world.models[root].name;
  if (world.models[root].mover != kNone)
    throw base::InputError(world.file, 0,
                           fmt::format("'{}' is a part of '{}', which joins as a whole", name,
                                       world.movers[world.models[root].mover].name));
  if (has(world.emitters) || has(world.lamps) || has(world.heat_sources) || has(world.floor_holes) || has(world.lights))
    throw base::InputError(
        world.file, 0,
        fmt::format("'{}' cannot join: infrared emitters, lamps, heat sources, floor holes and lights within "
                    "models do not move",
                    name));
  if (!has(world.walls))
    throw base::InputError(world.file, 0, fmt::format("'{}' cannot join: it has no outline", name));
}

/// Returns a world whose only mover is the static model in row `root`, as a tag, with all of its parts.
World as_mover(const World& world, std::uint32_t root) {
  const std::vector<bool> inside = parts_of(world, root);
  World part;
  part.models = world.models;
  for (std::uint32_t row = 0; row < inside.size(); ++row) part.models[row].mover = inside[row] ? 0 : kNone;
  Mover mover;
  mover.name = world.models[root].name;
  mover.model = root;
  mover.is_tag = true;
  mover.X_WM = world.models[root].X_WM;
  const Pose X_MW = inverse(mover.X_WM);
  for (Segment side : world.walls) {
    if (!inside[side.model]) continue;
    side.a = transform(X_MW, side.a), side.b = transform(X_MW, side.b);
    side.z_min += X_MW.z, side.z_max += X_MW.z;
    mover.body.push_back(side);
  }
  for (Magnet magnet : world.magnets) {
    if (!inside[magnet.model]) continue;
    magnet.p = transform(X_MW, magnet.p);
    magnet.z += X_MW.z;
    mover.magnets.push_back(magnet);
  }
  for (Fiducial fiducial : world.fiducials) {
    if (!inside[fiducial.model]) continue;
    fiducial.X_BF = compose(X_MW, fiducial.X_BF);
    part.fiducials.push_back(fiducial);
  }
  part.meshes = world.meshes;
  part.mesh_materials = world.mesh_materials;
  for (MeshModel row : world.mesh_models) {
    if (!inside[row.model]) continue;
    row.X_BF = compose(X_MW, row.X_BF);
    part.mesh_models.push_back(row);
  }
  std::ranges::copy_if(world.reflectances, std::back_inserter(part.reflectances),
                       [&](const Reflectance& row) { return inside[row.model]; });
  part.movers.push_back(std::move(mover));
  return part;
}

/// Row of the tag whose model it is; kNone: the model is static.
std::uint32_t tag_of(const World& world, std::uint32_t model) { return world.models[model].mover; }

std::uint32_t root_of(const World& world, const JoiningTemplate& of) {
  return of.kind == JoiningKind::light ? world.lights[of.row].model : of.row;
}

}  // namespace

JoiningTemplate joining_template(const World& world, const std::string& name) {
  if (const auto row = row_with_name(world.movers, name); row != kNone) return template_of(world, row);
  if (const auto row = row_with_name(world.lights, name); row != kNone) return {JoiningKind::light, row};
  if (const auto row = row_with_name(world.models, name); row != kNone) {
    require_movable(world, row);
    return {JoiningKind::object, row};
  }
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (world.models[world.movers[row].model].type == name) return template_of(world, row);
  refuse_template(world, name);
}

std::size_t outline_size(const World& world, const JoiningTemplate& of) {
  if (of.kind == JoiningKind::robot) return world.movers[of.row].body.size();
  const std::uint32_t root = root_of(world, of);
  if (const auto tag = tag_of(world, root); tag != kNone) return world.movers[tag].body.size();
  const std::vector<bool> inside = parts_of(world, root);
  return static_cast<std::size_t>(
      std::ranges::count_if(world.walls, [&](const Segment& wall) { return inside[wall.model]; }));
}

std::uint32_t append_joining(World& world, const JoiningTemplate& of, std::span<const std::uint32_t> ids) {
  if (of.kind == JoiningKind::robot) return append_robots(world, of.row, ids);
  const std::uint32_t root = root_of(world, of);
  const auto first = static_cast<std::uint32_t>(world.movers.size());
  if (const auto tag = tag_of(world, root); tag != kNone) {
    append_copies(world, world, tag, ids);
  } else {
    append_copies(world, as_mover(world, root), 0, ids);
  }
  for (std::uint32_t row = first; of.kind == JoiningKind::light && row < world.movers.size(); ++row) {
    Light light = world.lights[of.row];
    light.name = world.movers[row].name;
    light.model = world.movers[row].model;
    light.points.clear();
    world.lights.push_back(std::move(light));
  }
  update_extent_and_hash(world);
  return first;
}

}  // namespace sf::world
