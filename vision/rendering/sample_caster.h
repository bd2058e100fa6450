#pragma once
// Casts the samples of pixels into the patches of a scene, at their times, by the rasterizer of the farm's cameras.

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_double3.hpp>
#include <span>
#include <vector>

#include "scene/rasterizer.h"
#include "sensors/pixel_samples.h"
#include "vision/camera.h"
#include "vision/rendering/patch_surfaces.h"
#include "vision/scene.h"

namespace sf::vision {

/// Samples per pixel that are spread over it and its exposure. Pixels take the same places at different times, so that
/// their errors at a moving edge cancel out along it.
struct SampleSet {
  std::uint32_t count = 0;
  sensors::PixelSamples places;  ///< the first, the middle of a pixel, is left out, since it would draw edges to itself
  sensors::Shutter shutter;

  SampleSet(const Camera& camera, std::uint32_t samples);
  /// Returns the place of sample `k` of a pixel [px from its middle].
  glm::dvec2 place(std::uint32_t k, std::uint32_t u, std::uint32_t v) const {
    return places.at(1 + (k + 5 * u + 11 * v) % count, u, v);
  }
};

/// A pixel and its samples.
struct SampledPixel {
  int u = 0, v = 0;
  glm::dvec2 ray, across, along;  ///< normalised: of its middle, and per pixel along rows and columns, within it
  float floor = 0.0f;             ///< light of the floor there
  float sum = 0.0f, least = 0.0f, most = 0.0f;  ///< light of the samples of a set

  /// Returns the unit vector in the sensor's frame (CameraSettings). @param offset [px] from the middle
  glm::dvec3 beam(glm::dvec2 offset) const {
    const glm::dvec2 n = ray + offset.x * across + offset.y * along;
    return glm::dvec3{1.0, -n.x, -n.y} * (1.0 / std::sqrt(1.0 + n.x * n.x + n.y * n.y));
  }
  void add(float light) { sum += light, least = std::min(least, light), most = std::max(most, light); }
};

/// Beams are gathered in tiles. Rows that are next to each other share the mean of their times where that displaces no
/// patch by more than 0.01 px. Not thread-safe.
class SampleCaster final : scene::TileSink {
 public:
  explicit SampleCaster(const Camera& camera);

  /// Begins an image. @param scene must outlive its samples  @param time [s] start of the exposure of the first row
  void begin(const Scene& scene, double time);
  /// Returns how many rows may share their times.
  int rows_at_once() const;
  /// Begins rows that share their times.
  void begin_rows(int first, int last) { first_row_ = first, last_row_ = last; }
  /// Lists the columns of a row in or near which patches may be visible.
  void list_columns(int v, std::vector<int>& out) const { patches_.list_columns(v, out); }
  /// Casts all samples of a set of some pixels of these rows.
  void cast(std::span<SampledPixel> pixels, const SampleSet& set);

 private:
  void flush();
  void take(const scene::BeamTile& tile, const scene::TileSurfaces& surfaces) override;

  const Camera& camera_;
  base::RigidTransform X_WS_;
  // The image.
  PatchSurfaces patches_;
  double start_ = 0.0;               ///< [s] of the exposure of the first row
  double gradient_at_camera_ = 0.0;  ///< change of the light there, relative to that at the world's origin
  glm::dvec3 gradient_S_;            ///< [1/m] in the sensor's frame
  int first_row_ = 0, last_row_ = 0;
  // Beams that are not cast yet.
  std::vector<glm::dvec3> beams_;
  std::vector<SampledPixel*> pixels_;  ///< of these
  double beam_time_ = 0.0;             ///< [s] of all
  // Scratch memory.
  scene::BeamTile tile_;
  std::vector<scene::Instance> instances_;
  scene::Rasterizer rasterizer_;
  std::array<double, scene::kTileBeams> ranges_;
  std::array<std::uint32_t, scene::kTileBeams> hits_;
  std::array<base::QualityFlag, scene::kTileBeams> quality_;
};

}  // namespace sf::vision
