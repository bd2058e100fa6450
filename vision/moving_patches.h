#pragma once
// The patches of a scene during the exposure of one image, and where each may be visible in it.

#include <cstdint>
#include <vector>

#include "vision/camera.h"
#include "vision/scene.h"

namespace sf::vision {

/// Patches are numbered from the highest down. Reading is thread-safe between two calls of `place`.
class MovingPatches {
 public:
  /// @param scene must outlive the use of the patches
  /// @param middle [s] of the image's exposure
  void place(const Camera& camera, const Scene& scene, double middle);

  /// Returns the patches that may be visible in or near the pixel, the highest first.
  const std::vector<std::uint32_t>& near(int u, int v) const {
    return tiles_[static_cast<std::size_t>(v / kTile) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(u / kTile)];
  }
  double height(std::uint32_t i) const { return patches_[i].patch->X_WP.z; }  ///< [m]
  /// Returns the albedo at point `p` [m] of the patch's plane, `dt` [s] after the middle of the exposure; negative
  /// outside of the patch.
  double albedo_at(std::uint32_t i, glm::dvec2 p, double dt) const;

 private:
  static constexpr int kTile = 16;  // [px]

  struct MovingPatch {
    const Patch* patch = nullptr;
    glm::dvec2 at;  ///< [m] in the middle of the exposure
    double cosine = 1.0, sine = 0.0;
    glm::dvec2 half;    ///< [m] including the border of a tag
    double cell = 1.0;  ///< [m] of a tag
  };
  static void box_of(const Camera& camera, const MovingPatch& m, glm::dvec2& low, glm::dvec2& high);
  void list(const Camera& camera);

  std::vector<MovingPatch> patches_;               ///< highest first
  std::vector<std::vector<std::uint32_t>> tiles_;  ///< patches near each tile, highest first
  int columns_ = 0, rows_ = 0;                     ///< of tiles
};

}  // namespace sf::vision
