#pragma once
// Light and colours that cameras see: diffuse surfaces in the light of the sun, with hard shadows, and of the sky.
// All values are linear in the light: 1 is a white surface in full light (255 in an image, before a camera's gain).
//
// A surface with albedo c and normal n has c (sun max(0, n . s) v + sky (1 + n_z) / 2 + ground (1 - n_z) / 2): s points
// to the sun, v is 0 in its shadow, the sky is uniform, and `ground` is the light that level ground returns.

#include <array>
#include <cstdint>
#include <glm/ext/matrix_float3x3.hpp>
#include <glm/ext/vector_double3.hpp>
#include <glm/ext/vector_float3.hpp>
#include <span>
#include <vector>

#include "scene/shadows.h"
#include "sensors/road_paint.h"
#include "world/world.h"

namespace sf::sensors {

/// Any number of threads may read it at once.
class CameraLight {
 public:
  /// @param materials by row of scene::ScanOutput::materials
  CameraLight(const world::World& world, const std::vector<world::Material>& materials);
  /// Reads the colours of models again.
  void update(const world::World& world);

  bool has_sun() const { return to_sun_.z > 0.0 && sun_ > 0.0f; }
  glm::dvec3 to_sun() const { return to_sun_; }  ///< unit vector in the world
  /// [m] how far the shadow of a body of a height may reach, four times as far as on a plane.
  double shadow_reach(double height) const;

  /// Scratch memory of a thread.
  struct Scratch {
    scene::ShadowCaster shadows;
    std::vector<scene::Instance> moved;  ///< surfaces that cast shadows, at the time of a tile
    scene::LightPoints points;
    std::array<std::uint32_t, scene::kTileVectors> dark;
    std::array<std::uint32_t, scene::kTileBeams> beam;
    std::array<glm::vec3, scene::kTileBeams> direct;  ///< light from the sun, if it is not hidden
  };
  /// Computes the light of the beams of a tile, after its scan and `Scratch::shadows.begin`.
  /// @param depth_max [m] along the x axis: surfaces from there on are not seen  @param scan with normals
  void shade(const base::RigidTransform& X_WS, const scene::BeamTile& tile, double depth_max,
             const scene::ScanOutput& scan, std::span<glm::vec3> out, Scratch& scratch) const;

 private:
  glm::vec3 sky_at(float up, float sun) const;
  struct Lanes;
  glm::vec3 ground_at(const base::RigidTransform& X_WS, double range, const scene::BeamTile& tile,
                      std::uint32_t i) const;
  void find_lanes(const glm::mat3& R_WS, const scene::BeamTile& tile, std::uint32_t first,
                  const scene::ScanOutput& scan, Lanes& lanes) const;

  glm::dvec3 to_sun_{};
  float sun_ = 0.0f, sky_ = 0.0f, ground_ = 0.0f;
  glm::vec3 floor_;
  std::vector<glm::vec3> models_;     ///< by row
  std::vector<glm::vec3> materials_;  ///< by row
  RoadPaint paint_;
};

}  // namespace sf::sensors
