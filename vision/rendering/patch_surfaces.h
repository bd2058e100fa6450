#pragma once
// The patches of a scene as surfaces of the rasterizer, and where each may be visible in an image.

#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <vector>

#include "scene/rasterizer.h"
#include "vision/camera.h"
#include "vision/scene.h"

namespace sf::vision {

/// Patches are in their places; of those at equal heights that may overlap in the image, each is 50 um above the ones
/// before it, which it hides. Reading is thread-safe between two calls of `place`.
class PatchSurfaces {
 public:
  /// @param scene must outlive the use of the surfaces
  /// @param middle [s] of the image's exposure
  void place(const Camera& camera, const Scene& scene, double middle);

  /// Lists the columns of row `v` in or near which patches may be visible, in ascending order.
  void list_columns(int v, std::vector<int>& out) const;
  /// Lists the patches that may be visible between two rows, where they are at time `t` [s].
  void list(int first, int last, double t, std::vector<scene::Instance>& out) const;
  /// [px/s] Returns about how fast the fastest part of a patch moves in the image.
  double speed(const Camera& camera) const;
  /// @param material of a hit
  double albedo(std::uint32_t material) const { return albedos_[material]; }

 private:
  struct Surface {
    const Patch* patch = nullptr;
    scene::SurfaceTree tree;
    double lift = 0.0;               ///< [m]
    std::vector<glm::dvec2> hull;    ///< [px] convex, of its images during the exposure, nearly
    double top = 0.0, bottom = 0.0;  ///< [px] rows around it
  };
  scene::Mesh mesh_of(const Patch& patch);
  double lift_of(std::size_t row) const;

  int width_ = 0;  ///< [px] of the image
  std::vector<Surface> surfaces_;
  std::vector<double> albedos_;  ///< per material
};

}  // namespace sf::vision
