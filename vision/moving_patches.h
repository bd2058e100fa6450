#pragma once
// The patches of a scene during the exposure of one image, and where in the image each may be seen.

#include <cstdint>
#include <vector>

#include "vision/camera.h"
#include "vision/scene.h"

namespace sf::vision {

/// Patches are numbered from the highest down. Between two calls of `place` any number of threads may read.
class MovingPatches {
 public:
  /// @param scene lives as long as the patches are read
  /// @param middle [s] of the image's exposure
  void place(const Camera& camera, const Scene& scene, double middle);

  /// Patches that may be seen in the pixel or near it, the highest first.
  const std::vector<std::uint32_t>& near(int u, int v) const {
    return tiles_[static_cast<std::size_t>(v / kTile) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(u / kTile)];
  }
  double height(std::uint32_t i) const { return patches_[i].patch->X_WP.z; }  ///< [m]
  /// Albedo at point `p` [m] of the patch's plane, `dt` [s] after the middle of the exposure; negative outside it.
  double albedo_at(std::uint32_t i, glm::dvec2 p, double dt) const;

 private:
  static constexpr int kTile = 16;  // [px]

  struct MovingPatch {
    const Patch* patch = nullptr;
    glm::dvec2 at;  ///< [m] in the middle of the exposure
    double cosine = 1.0, sine = 0.0;
    glm::dvec2 half;    ///< [m] including a tag's border
    double cell = 1.0;  ///< [m] of a tag
  };
  static void box_of(const Camera& camera, const MovingPatch& m, glm::dvec2& low, glm::dvec2& high);
  void list(const Camera& camera);

  std::vector<MovingPatch> patches_;               ///< the highest first
  std::vector<std::vector<std::uint32_t>> tiles_;  ///< patches near each, the highest first
  int columns_ = 0, rows_ = 0;                     ///< of tiles
};

}  // namespace sf::vision
