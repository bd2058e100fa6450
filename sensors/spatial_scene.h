#pragma once
// Surfaces that spatial sensors see: walls and movers as solids, and meshes in place of models that have one.

#include <span>
#include <vector>

#include "base/box.h"
#include "base/report.h"
#include "base/rigid_transform.h"
#include "scene/rasterizer.h"
#include "scene/simplify.h"
#include "world/copies.h"
#include "world/world.h"

namespace sf::sensors {

/// What sensors use beyond the surfaces.
struct SceneExtras {
  bool coarse = false;     ///< coarser meshes, for `list`
  bool materials = false;  ///< faces have their materials
};

class SpatialScene {
 public:
  /// @throws base::InputError for more triangles than their numbers can tell apart, over all places of all meshes
  /// @param reach [m] longest range of a sensor
  SpatialScene(const world::World& world, double reach, const SceneExtras& extras = {});

  /// Builds the bodies of all movers again. Meshes stay; one whose mover has another shape or size is not seen.
  void update_movers(const world::World& world);
  /// @param states per mover
  void place(std::span<const base::Report> states);
  const base::RigidTransform& X_WM(std::uint32_t mover) const { return X_WM_[mover]; }
  /// Materials of all meshes, by row as in scene::ScanOutput::materials. Empty unless asked for.
  const std::vector<world::Material>& materials() const { return materials_; }

  scene::Terrain terrain() const { return {terrain_.empty() ? nullptr : &terrain_, X_WF_}; }
  /// Sets `out` to the walls, and to all other surfaces of the world of `mover` within `range` [m] of `p`, except its
  /// own. They are valid until the movers are updated or placed.
  /// @param angle [rad] meshes may be coarser by displacements of this size as seen from `p`; 0: exact
  /// @return whether the plane z = 0 is a surface; near holes in the floor, or terrain, a mesh in
  /// `out` is that instead
  bool list(std::uint32_t mover, glm::dvec3 p, double range, std::vector<scene::Instance>& out,
            double angle = 0.0) const;

 private:
  /// A mesh of a model.
  struct Part {
    std::uint32_t mesh = 0;     ///< row in `meshes_`
    base::RigidTransform X_BF;  ///< in the world, or in its mover's frame
    std::uint32_t model = 0;
    bool own = false;  ///< of the mover's own model, whose shape may change
  };
  void add_meshes(const world::World& world, const SceneExtras& extras);
  /// Surroundings of a sensor.
  struct View {
    glm::dvec3 p;
    double range = 0.0, angle = 0.0;
  };
  void add_mesh(std::uint32_t mesh, const base::RigidTransform& X_WI, std::uint32_t owner, const View& view,
                std::vector<scene::Instance>& out) const;
  void add(const scene::SurfaceTree& tree, const base::RigidTransform& X_WI, std::uint32_t owner, glm::dvec3 p,
           double range, std::vector<scene::Instance>& out) const;

  world::CopyIndex copies_;
  bool floor_;
  scene::SurfaceTree walls_;
  scene::SurfaceTree roads_;        ///< above the floor
  scene::SurfaceTree holed_floor_;  ///< around all holes; empty: there are none
  base::Box holes_;
  scene::HeightField terrain_;  ///< empty: none
  base::RigidTransform X_WF_;   ///< its frame
  std::vector<world::Material> materials_;
  std::vector<scene::SurfaceTree> meshes_;
  std::vector<std::vector<scene::MeshLevel>> levels_;  ///< per mesh; empty: only exact ones
  std::vector<Part> fixed_;
  std::vector<std::vector<Part>> carried_;  ///< per mover of one world
  std::vector<scene::SurfaceTree> bodies_;  ///< per mover
  std::vector<std::uint8_t> changed_;       ///< per mover: its own model has another shape or size than in the file
  std::vector<base::RigidTransform> X_WM_;  ///< per mover
};

}  // namespace sf::sensors
