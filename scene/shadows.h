#pragma once
// Hard shadows of a distant light, such as the sun: which of many points a surface hides from it.
//
// Along the direction s to the light, a convex face with corners a_k, in order around its normal n . s > 0, covers the
// points p with (s x (a_{k+1} - a_k)) . (p - a_k) >= 0 for all k, and hides the light from those with n . (a_0 - p) >
// 0. Points are grouped: each group's box is swept along s through the trees, and the faces found are tested against
// its vectors of 16 points, those that hid others first. All decisions are in 32 bits, relative to the sensor, without
// fused operations, so that they are the same on every processor; rounding moves shadows by less than 1e-6 of the
// distance. Height fields: field_shadow.h.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <memory>
#include <span>

#include "scene/rasterizer.h"

namespace sf::scene {

/// Points of one tile.
struct LightPoints {
  alignas(64) float x[kTileBeams], y[kTileBeams], z[kTileBeams];  ///< [m] in the world's axes, from the sensor
  std::uint32_t count = 0;

  void add(glm::vec3 p) { x[count] = p.x, y[count] = p.y, z[count] = p.z, ++count; }
};

inline constexpr float kLeastShadow = 1e-4f;  ///< [m] for points that are exact to rounding

/// Casts shadows in its own scratch memory: one object per thread. Not thread-safe.
class ShadowCaster {
 public:
  ShadowCaster();
  ~ShadowCaster();
  ShadowCaster(ShadowCaster&&) noexcept;

  /// Starts an image. @param p_W [m] the sensor's position  @param to_light unit vector in the world
  /// @param scene its floor hides nothing  @param least [m] surfaces within this distance, plus 4e-7 of the distance
  /// from the sensor, do not hide the light
  void begin(glm::dvec3 p_W, glm::dvec3 to_light, const SceneView& scene, float least = kLeastShadow);
  /// @param points the unused rest of the last vector is overwritten
  /// @param dark out: per vector of 16 points, a bit mask of those in a shadow
  void cast(LightPoints& points, std::span<std::uint32_t> dark);

  struct Scratch;

 private:
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace sf::scene
