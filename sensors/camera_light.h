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
#include "sensors/texture_pyramids.h"
#include "world/world.h"

namespace sf::sensors {

/// Any number of threads may read it at once.
class CameraLight {
 public:
  /// @param materials by row of scene::ScanOutput::materials  @param textures of these, or empty
  CameraLight(const world::World& world, const std::vector<world::Material>& materials,
              const std::vector<world::TextureUse>& textures = {});
  /// Reads the colours of models again.
  void update(const world::World& world);

  bool has_sun() const { return to_sun_.z > 0.0 && sun_ > 0.0f; }
  glm::dvec3 to_sun() const { return to_sun_; }  ///< unit vector in the world
  /// [m] how far the shadow of a body of a height may reach, four times as far as on a plane.
  double shadow_reach(double height) const;

  /// The beams of a tile, in its order.
  struct Lanes {
    float light[3][scene::kTileBeams];  ///< red, green and blue; before, the colours of surfaces
    float ambient[scene::kTileBeams];   ///< light of sky and ground on a white surface
    float sun[scene::kTileBeams];       ///< that of the sun; negative on the other side
    float x[scene::kTileBeams], y[scene::kTileBeams], z[scene::kTileBeams];  ///< [m] from the sensor, in the world's
                                                                             ///< axes
  };
  /// Scratch memory of a thread.
  struct Scratch {
    scene::ShadowCaster shadows;
    std::vector<scene::Instance> moved;  ///< surfaces that cast shadows, at the time of a tile
    scene::LightPoints points;           ///< of vectors with light from the sun
    std::array<std::uint32_t, scene::kTileVectors> dark;
    Lanes lanes;
  };
  /// Projection of one camera.
  struct View {
    double depth_max = 0.0;  ///< [m] along the x axis: surfaces from there on are not seen
    float pixel = 0.0f;      ///< [sr] of a beam's part of the image; in a flat image, of one along the x axis
    bool flat = true;        ///< a pinhole's, else a fisheye's
  };
  /// Computes `Scratch::lanes.light` of a tile, after its scan and `Scratch::shadows.begin`.
  void shade(const base::RigidTransform& X_WS, const scene::BeamTile& tile, const View& view,
             const scene::TileSurfaces& surfaces, Scratch& scratch) const;

 private:
  struct Frame;
  glm::vec3 sky_at(float up, float sun) const;
  bool is_textured(std::uint32_t material) const {
    return material < textures_.size() && textures_[material].texture != world::kNoTexture;
  }
  glm::vec3 texture_at(const Frame& frame, std::uint32_t i) const;
  const glm::vec3& ground_at(const Frame& frame, double range, std::uint32_t i) const;
  const glm::vec3* color_of(std::uint32_t hit, std::uint32_t material) const;
  void light_surfaces(const Frame& frame, Lanes& lanes) const;
  void color_vector(const Frame& frame, std::uint32_t first, Lanes& lanes) const;
  static std::uint32_t add_points(std::uint32_t first, Scratch& s);
  static void add_light(const Frame& frame, std::span<const std::uint32_t> shine, Lanes& lanes);

  glm::dvec3 to_sun_{};
  float sun_ = 0.0f, sky_ = 0.0f, ground_ = 0.0f;
  glm::vec3 floor_;
  std::vector<glm::vec3> models_;            ///< by row
  std::vector<glm::vec3> materials_;         ///< by row
  std::vector<world::TextureUse> textures_;  ///< of these, or empty
  TexturePyramids pictures_;
  RoadPaint paint_;
};

}  // namespace sf::sensors
