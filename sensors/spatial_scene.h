#pragma once
// Surfaces that spatial sensors see: walls and movers as solids, and meshes in place of models that have one.

#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "base/box.h"
#include "base/report.h"
#include "base/rigid_transform.h"
#include "scene/rasterizer.h"
#include "scene/simplify.h"
#include "sensors/mover_trails.h"
#include "world/copies.h"
#include "world/world.h"

namespace sf::sensors {

/// Optional parts of the scene.
struct SceneExtras {
  bool coarse = false;     ///< coarser meshes, for `list`
  bool materials = false;  ///< faces have their materials,
  bool textures = false;   ///< and also texture coordinates
};

/// Surroundings of a sensor, and when it casts its beams.
struct SensorView {
  std::uint32_t mover = 0;  ///< its carrier
  glm::dvec3 p{};           ///< [m] its place
  double range = 0.0;       ///< [m] of surfaces that it may see from there
  bool own = false;         ///< also those of its carrier
  double angle = 0.0;       ///< [rad] meshes may be coarser by displacements of this size as seen from `p`; 0: exact
  const MoverTrails* trails = nullptr;  ///< of a rolling scan; null: all beams are cast at once
  std::int64_t since = 0;               ///< [ns] time of its first beam
};

/// Surfaces that a sensor may see. Valid until the movers are updated or placed.
struct SceneList {
  /// An instance whose mover moves during a rolling scan.
  struct Moving {
    std::size_t row = 0;  ///< in `instances`
    std::uint32_t mover = 0;
    base::RigidTransform X_MI;
  };
  std::vector<scene::Instance> instances;  ///< where they are at the time of the reading
  std::vector<Moving> moving;
  bool floor = false;  ///< the plane z = 0 is a surface; near holes in it, or terrain, an instance is that instead
};

/// Puts the moving instances of a list where they are at a time [ns]. @param instances those of the list, or a copy
void move_to(std::int64_t time, const MoverTrails& trails, const SceneList& list, std::span<scene::Instance> instances);

/// @throws base::InputError for more triangles than their numbers can tell apart, over all places of all meshes
void require_mesh_places(const world::World& world);

class SpatialScene {
 public:
  /// @throws as require_mesh_places
  /// @param reach [m] longest range of a sensor
  SpatialScene(const world::World& world, double reach, const SceneExtras& extras = {});

  /// Rebuilds the bodies of all movers. Scales the meshes of resized movers, which then have no coarser levels. Removes
  /// the meshes of movers whose shape was replaced.
  void update_movers(const world::World& world);
  /// @param states per mover
  void place(std::span<const base::Report> states);
  const base::RigidTransform& X_WM(std::uint32_t mover) const { return X_WM_[mover]; }
  /// Materials of all meshes, by row as in scene::ScanOutput::materials. Empty unless asked for.
  const std::vector<world::Material>& materials() const { return materials_; }

  /// Their textures; empty: none has one, or they were not asked for.
  const std::vector<world::TextureUse>& textures() const { return textures_; }

  scene::Terrain terrain() const { return {terrain_.empty() ? nullptr : &terrain_, X_WF_}; }
  /// Lists the walls, and all other surfaces of the carrier's world within range.
  void list(const SensorView& view, SceneList& out) const;
  /// [m] Returns how far any body or mesh reaches from the origin of its frame.
  double largest() const;

 private:
  /// A mesh of a model.
  struct Part {
    std::uint32_t mesh = 0;     ///< row in `meshes_`
    base::RigidTransform X_BF;  ///< in the world, or in its mover's frame
    std::uint32_t model = 0;
    bool own = false;  ///< of the mover's own model, whose shape may change
  };
  /// A mesh, and the sizes of its world::Stretch.
  using ScaledMesh = std::pair<std::uint32_t, std::array<double, 6>>;

  void add_materials(const world::World& world, bool textures);
  /// Materials of a mesh's triangles, as rows of `materials_`; empty: it has none, or they were not asked for.
  std::vector<std::uint32_t> materials_of(const world::World& world, std::uint32_t mesh) const;
  scene::SurfaceTree tree_of(const world::World& world, std::uint32_t row, const world::Mesh& mesh) const;
  void scale_mesh(const world::World& world, std::uint32_t mover, std::map<ScaledMesh, scene::SurfaceTree>& scaled);
  void add_mover(std::uint32_t mover, const SensorView& view, SceneList& out) const;
  void add_mesh(std::uint32_t mesh, const base::RigidTransform& X_WI, std::uint32_t owner, const SensorView& view,
                SceneList& out) const;
  void add(const scene::SurfaceTree& tree, const base::RigidTransform& X_WI, std::uint32_t owner,
           const SensorView& view, SceneList& out) const;

  world::CopyIndex copies_;
  bool floor_;
  scene::SurfaceTree walls_;
  scene::SurfaceTree roads_;        ///< above the floor
  scene::SurfaceTree holed_floor_;  ///< around all holes; empty: there are none
  base::Box holes_;
  scene::HeightField terrain_;  ///< empty: none
  base::RigidTransform X_WF_;   ///< its frame
  std::vector<world::Material> materials_;
  std::vector<world::TextureUse> textures_;
  std::vector<std::uint32_t> first_material_;  ///< per row of World::mesh_materials; empty: not asked for
  std::vector<scene::SurfaceTree> meshes_;
  std::vector<std::vector<scene::MeshLevel>> levels_;  ///< per mesh; empty: only exact ones
  std::vector<Part> fixed_;
  std::vector<std::vector<Part>> carried_;  ///< per mover of one world
  std::vector<scene::SurfaceTree> bodies_;  ///< per mover
  std::vector<std::uint8_t> changed_;       ///< per mover: its own model has another shape than in the file
  std::map<ScaledMesh, scene::SurfaceTree> scaled_;
  std::vector<const scene::SurfaceTree*> resized_;  ///< per mover: its own mesh in another size; null: as in the file
  std::vector<base::RigidTransform> X_WM_;          ///< per mover
};

}  // namespace sf::sensors
