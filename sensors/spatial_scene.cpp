#include "sensors/spatial_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/error.h"
#include "scene/solids.h"
#include "world/shapes.h"
#include "world/terrain.h"

namespace sf::sensors {

namespace {

constexpr std::uint64_t kMostFaces = std::uint64_t{1} << 31;

/// Rows in `World::models` that are seen as a mesh.
std::vector<std::uint8_t> models_with_mesh(const world::World& world) {
  std::vector<std::uint8_t> with(world.models.size(), 0);
  for (const world::MeshModel& row : world.mesh_models) with[row.model] = 1;
  return with;
}

std::vector<world::Segment> without(std::span<const world::Segment> segments, const std::vector<std::uint8_t>& models) {
  std::vector<world::Segment> rest;
  std::ranges::copy_if(segments, std::back_inserter(rest), [&](const auto& s) { return models[s.model] == 0; });
  return rest;
}

}  // namespace

void require_mesh_places(const world::World& world) {
  std::uint64_t faces = 0;
  for (const world::MeshModel& row : world.mesh_models)
    faces +=
        world.meshes[row.mesh].corners.size() / 3 * (world.models[row.model].mover == world::kNone ? 1 : world.copies);
  if (faces >= kMostFaces)
    throw base::InputError(
        world.file, 0,
        fmt::format("has {} triangles of meshes in all their places; expected fewer than {}: simplify "
                    "the meshes, or place fewer",
                    faces, kMostFaces));
}

SpatialScene::SpatialScene(const world::World& world, double reach, const SceneExtras& extras)
    : copies_(world),
      floor_(!world.floor_unseen),
      holes_(scene::box_of_holes(world)),
      carried_(world.movers.size() / world.copies),
      X_WM_(world.movers.size()) {
  require_mesh_places(world);
  walls_ = scene::build_tree(scene::mesh_of(without(world.walls, models_with_mesh(world)), !world.floor_unseen));
  roads_ = scene::build_tree(scene::roads_of(world));
  for (const world::Terrain& row : world.terrain) {
    terrain_ = scene::build_height_field(row.columns, row.rows, row.cell, row.heights);
    X_WF_ = base::transform_of(world::corner_of(row));
  }
  if (floor_ && !(world.floor_holes.empty() && world.terrain.empty()))
    holed_floor_ = scene::build_tree(scene::holed_floor(world, reach));
  if (extras.materials) add_materials(world, extras.textures);
  for (std::uint32_t i = 0; i < world.meshes.size(); ++i) {
    if (extras.coarse) levels_.push_back(scene::levels_of(world.meshes[i], materials_of(world, i)));
    meshes_.push_back(tree_of(world, i, world.meshes[i]));
  }
  for (const world::MeshModel& row : world.mesh_models) {
    const std::uint32_t mover = world.models[row.model].mover;
    const bool own = mover != world::kNone && world.movers[mover].model == row.model;
    (mover == world::kNone ? fixed_ : carried_[mover])
        .push_back({row.mesh, base::transform_of(row.X_BF), row.model, own});
  }
  update_movers(world);
}

void SpatialScene::add_materials(const world::World& world, bool textures) {
  for (const world::MeshMaterials& row : world.mesh_materials) {
    const std::size_t first = materials_.size();
    first_material_.push_back(static_cast<std::uint32_t>(first));
    materials_.insert(materials_.end(), row.materials.begin(), row.materials.end());
    const auto textured = std::ranges::find(world.mesh_textures, row.mesh, &world::MeshTextures::mesh);
    if (!textures || textured == world.mesh_textures.end()) continue;
    textures_.resize(first);
    textures_.insert(textures_.end(), textured->materials.begin(), textured->materials.end());
  }
  if (!textures_.empty()) textures_.resize(materials_.size());
}

/// Builds the tree of a mesh, possibly with other vertices than the world's.
scene::SurfaceTree SpatialScene::tree_of(const world::World& world, std::uint32_t row, const world::Mesh& mesh) const {
  const auto textured = std::ranges::find(world.mesh_textures, row, &world::MeshTextures::mesh);
  const bool has_textures = !textures_.empty() && textured != world.mesh_textures.end();
  return scene::build_tree(scene::mesh_of(mesh, materials_of(world, row),
                                          has_textures ? std::span(textured->corners) : std::span<const glm::vec2>{}));
}

std::vector<std::uint32_t> SpatialScene::materials_of(const world::World& world, std::uint32_t mesh) const {
  std::vector<std::uint32_t> of_triangles;
  for (std::size_t i = 0; i < first_material_.size(); ++i) {
    const world::MeshMaterials& row = world.mesh_materials[i];
    if (row.mesh != mesh) continue;
    for (const std::uint32_t material : row.triangles)
      of_triangles.push_back(material == world::kNoMaterial ? material : first_material_[i] + material);
  }
  return of_triangles;
}

/// Finds the mesh of a mover of another size among those of the last update, or builds it.
void SpatialScene::scale_mesh(const world::World& world, std::uint32_t mover,
                              std::map<ScaledMesh, scene::SurfaceTree>& scaled) {
  const std::optional<world::Stretch> stretch = world::stretch_of(world, mover);
  if (!stretch || !stretch->any()) return;
  for (const Part& part : carried_[copies_.row_of(mover)]) {
    if (!part.own) continue;
    const glm::dvec3 &from = stretch->from, &to = stretch->to;
    const ScaledMesh key{part.mesh, {from.x, from.y, from.z, to.x, to.y, to.z}};
    if (const auto known = scaled_.find(key); known != scaled_.end()) scaled.insert(scaled_.extract(known));
    auto found = scaled.find(key);
    if (found == scaled.end()) {
      world::Mesh mesh = world.meshes[part.mesh];
      for (glm::dvec3& p : mesh.vertices) p = (*stretch)(p);
      found = scaled.emplace(key, tree_of(world, part.mesh, mesh)).first;
    }
    resized_[mover] = &found->second;
  }
}

void SpatialScene::update_movers(const world::World& world) {
  bodies_.clear();
  changed_.assign(world.movers.size(), 0), resized_.assign(world.movers.size(), nullptr);
  std::map<ScaledMesh, scene::SurfaceTree> scaled;
  std::vector<std::uint8_t> with_mesh = models_with_mesh(world);
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    const world::Mover& mover = world.movers[m];
    changed_[m] = !world::stretch_of(world, m);
    const std::uint8_t own = std::exchange(with_mesh[mover.model], changed_[m] ? 0 : with_mesh[mover.model]);
    bodies_.push_back(scene::build_tree(scene::mesh_of(without(mover.body, with_mesh))));
    with_mesh[mover.model] = own;
    scale_mesh(world, m, scaled);
  }
  scaled_ = std::move(scaled);
}

void SpatialScene::place(std::span<const base::Report> states) {
  for (std::size_t m = 0; m < X_WM_.size(); ++m) X_WM_[m] = base::transform_of(states[m].X_WM, states[m].tilt);
}

/// Absent movers, which are nowhere, are beyond every range.
void SpatialScene::add(const scene::SurfaceTree& tree, const base::RigidTransform& X_WI, std::uint32_t owner,
                       const SensorView& view, SceneList& out) const {
  if (tree.empty() || !(glm::distance(X_WI.p, view.p) <= view.range + tree.radius + glm::length(tree.centre))) return;
  out.instances.push_back({&tree, X_WI, false, owner});
}

void SpatialScene::add_mesh(std::uint32_t mesh, const base::RigidTransform& X_WI, std::uint32_t owner,
                            const SensorView& view, SceneList& out) const {
  const scene::SurfaceTree& exact = meshes_[mesh];
  if (view.angle == 0.0 || levels_.empty()) return add(exact, X_WI, owner, view, out);
  const double away = glm::distance(base::transform(X_WI, exact.centre), view.p) - exact.radius;
  add(scene::level_for(levels_[mesh], view.angle * away, exact), X_WI, owner, view, out);
}

void SpatialScene::add_mover(std::uint32_t m, const SensorView& view, SceneList& out) const {
  SensorView near = view;
  const bool moves = view.trails != nullptr && !view.trails->at_rest(m, view.since);
  if (moves) near.range += view.trails->reach(m);
  const auto add_moving = [&](const base::RigidTransform& X_MI, const auto& add_instance) {
    const std::size_t row = out.instances.size();
    add_instance(base::compose(X_WM_[m], X_MI));
    if (moves && out.instances.size() > row) out.moving.push_back({row, m, X_MI});
  };
  add_moving({}, [&](const base::RigidTransform& X_WI) { add(bodies_[m], X_WI, base::kNoHit, near, out); });
  for (const Part& part : carried_[copies_.row_of(m)]) {
    if (part.own && changed_[m] != 0) continue;
    const scene::SurfaceTree* const resized = part.own ? resized_[m] : nullptr;
    add_moving(part.X_BF, [&](const base::RigidTransform& X_WI) {
      resized != nullptr ? add(*resized, X_WI, part.model, near, out)
                         : add_mesh(part.mesh, X_WI, part.model, near, out);
    });
  }
}

double SpatialScene::largest() const {
  double largest = 0.0;
  const auto take = [&](const scene::SurfaceTree& tree) {
    largest = std::max(largest, tree.radius + glm::length(tree.centre));
  };
  for (const auto* trees : {&bodies_, &meshes_})
    for (const scene::SurfaceTree& tree : *trees) take(tree);
  for (const auto& [mesh, tree] : scaled_) take(tree);
  return largest;
}

void SpatialScene::list(const SensorView& view, SceneList& out) const {
  out.moving.clear();
  out.instances.assign({{&walls_, {}, true}, {&roads_, {}, true, base::kFloorHit}});
  const glm::dvec2 foot(view.p);
  const bool near_holes =
      !holed_floor_.empty() && glm::distance(foot, glm::clamp(foot, holes_.min, holes_.max)) <= view.range;
  if (near_holes) out.instances.push_back({&holed_floor_, {}, true, base::kFloorHit});
  for (const Part& part : fixed_) add_mesh(part.mesh, part.X_BF, part.model, view, out);
  const auto [first, end] = copies_.rows_with(view.mover, static_cast<std::uint32_t>(bodies_.size()));
  for (std::uint32_t m = first; m < end; ++m)
    if (m != view.mover || view.own) add_mover(m, view, out);
  out.floor = floor_ && !near_holes;
}

void move_to(std::int64_t time, const MoverTrails& trails, const SceneList& list,
             std::span<scene::Instance> instances) {
  base::RigidTransform X_WM;
  std::uint32_t mover = world::kNone;
  for (const SceneList::Moving& each : list.moving) {
    if (each.mover != mover) mover = each.mover, X_WM = trails.X_WM(mover, time);
    instances[each.row].X_WI = base::compose(X_WM, each.X_MI);
  }
}

}  // namespace sf::sensors
