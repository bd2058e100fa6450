#include "sensors/camera_light.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "base/elementary.h"
#include "base/srgb.h"

namespace sf::sensors {

namespace {

using scene::kWidth;

constexpr float kGroundAlbedo = 0.25f;
constexpr float kSunCosine = 0.9999889f;  // of the radius of the sun's disc, 0.27 degrees
constexpr glm::vec3 kHorizon{0.75f, 0.85f, 0.95f}, kZenith{0.2f, 0.4f, 0.8f};  // of a sky of kUsualSky
constexpr float kUsualSky = 0.3f;

}  // namespace

CameraLight::CameraLight(const world::World& world, const std::vector<world::Material>& materials,
                         const std::vector<world::TextureUse>& textures)
    : textures_(textures), paint_(world) {
  if (!textures.empty()) pictures_ = TexturePyramids(world.textures);
  for (const world::Material& each : materials) materials_.emplace_back(each.color);
  const world::Daylight day = world::daylight_of(world);
  const auto [sin, cos] = base::sin_cos(day.elevation);
  const auto [y, x] = base::sin_cos(day.azimuth);
  to_sun_ = {cos * x, cos * y, sin};
  sun_ = static_cast<float>(day.sun), sky_ = static_cast<float>(day.sky);
  ground_ = kGroundAlbedo * (sky_ + sun_ * std::max(0.0f, static_cast<float>(sin)));
  floor_ = base::linear_color(day.floor);
  update(world);
}

void CameraLight::update(const world::World& world) {
  models_.clear();
  for (const world::Model& model : world.models) models_.push_back(base::linear_color(model.color));
}

double CameraLight::shadow_reach(double height) const {
  return has_sun() ? 4.0 * height * base::hypot(to_sun_.x, to_sun_.y) / to_sun_.z : 0.0;
}

/// A tile with its pose.
struct CameraLight::Frame {
  const base::RigidTransform& X_WS;
  const scene::BeamTile& tile;
  const scene::TileSurfaces& surfaces;
  std::uint32_t beams;
  const View& view;
  glm::mat3 R_WS;
  glm::vec3 up, sun;  ///< unit vectors in the sensor's frame
};

/// @param up, sun cosines of the angles between the direction and these
glm::vec3 CameraLight::sky_at(float up, float sun) const {
  if (sun > kSunCosine && has_sun()) return glm::vec3(1.0f);
  return glm::mix(kHorizon, kZenith, std::sqrt(glm::clamp(up, 0.0f, 1.0f))) * (sky_ / kUsualSky);
}

/// Returns the colour of a textured surface, filtered over the pixel's footprint on it.
glm::vec3 CameraLight::texture_at(const Frame& f, std::uint32_t i) const {
  const float forward = f.tile.x[i], pixel = f.view.flat ? f.view.pixel * (forward * forward * forward) : f.view.pixel;
  const std::uint32_t material = f.surfaces.materials[i];
  return materials_[material] *
         pictures_.color_at(textures_[material], {f.surfaces.u[i], f.surfaces.v[i]}, pixel * f.surfaces.spread[i]);
}

/// Returns the colour of the floor, or of paint on it, where a beam meets it.
const glm::vec3& CameraLight::ground_at(const Frame& f, double range, std::uint32_t i) const {
  const glm::vec3* const paint =
      paint_.color_at(base::transform(f.X_WS, range * glm::dvec3(f.tile.dx[i], f.tile.dy[i], f.tile.dz[i])));
  return paint != nullptr ? *paint : floor_;
}

/// Returns the colour of a surface; null: it depends on the place.
const glm::vec3* CameraLight::color_of(std::uint32_t hit, std::uint32_t material) const {
  if (is_textured(material)) return nullptr;
  if (material < materials_.size()) return &materials_[material];
  if (hit < models_.size()) return &models_[hit];
  return paint_.empty() ? &floor_ : nullptr;
}

/// Finds the colours of a vector's beams, also those of the sky, which has all of its light.
void CameraLight::color_vector(const Frame& f, std::uint32_t first, Lanes& lanes) const {
  const std::uint32_t *const hits = f.surfaces.hits + first, *const materials = f.surfaces.materials + first;
  const double* const ranges = f.surfaces.ranges + first;
  const glm::vec3* color = nullptr;
  if ((f.surfaces.uniform >> first / kWidth & 1) != 0 && hits[0] != base::kNoHit &&
      *std::max_element(ranges, ranges + kWidth) < f.view.depth_max * (1.0 - 1e-9))
    color = color_of(hits[0], materials[0]);
  if (color != nullptr) {
    for (int c = 0; c < 3; ++c) std::fill_n(lanes.light[c] + first, kWidth, (*color)[c]);
    return;
  }
  for (std::uint32_t k = 0, i = first; k < kWidth; ++k, ++i) {
    glm::vec3 found;
    if (hits[k] == base::kNoHit || !(ranges[k] * f.tile.dx[i] < f.view.depth_max)) {
      const glm::vec3 d(f.tile.x[i], f.tile.y[i], f.tile.z[i]);
      found = sky_at(glm::dot(d, f.up), glm::dot(d, f.sun));
      lanes.ambient[i] = 1.0f, lanes.sun[i] = 0.0f;
    } else {
      color = color_of(hits[k], materials[k]);
      found = color != nullptr ? *color : is_textured(materials[k]) ? texture_at(f, i) : ground_at(f, ranges[k], i);
    }
    for (int c = 0; c < 3; ++c) lanes.light[c][i] = found[c];
  }
}

/// Finds the light that all surfaces of a tile would have without shadows, in a loop that compilers turn into vector
/// instructions, as those below.
void CameraLight::light_surfaces(const Frame& f, Lanes& lanes) const {
  const glm::mat3& R = f.R_WS;
  const glm::vec3 up = 0.5f * f.up, sun = sun_ * f.sun;
  const scene::TileSurfaces& to = f.surfaces;
  for (std::uint32_t i = 0; i < f.beams; ++i) {
    const float upward = to.x[i] * up.x + to.y[i] * up.y + to.z[i] * up.z;
    lanes.ambient[i] = sky_ * (0.5f + upward) + ground_ * (0.5f - upward);
    lanes.sun[i] = to.x[i] * sun.x + to.y[i] * sun.y + to.z[i] * sun.z;
    const auto range = static_cast<float>(to.ranges[i]);
    const float x = range * f.tile.x[i], y = range * f.tile.y[i], z = range * f.tile.z[i];
    lanes.x[i] = R[0].x * x + R[1].x * y + R[2].x * z;
    lanes.y[i] = R[0].y * x + R[1].y * y + R[2].y * z;
    lanes.z[i] = R[0].z * x + R[1].z * y + R[2].z * z;
  }
}

/// Adds a vector to the points if the sun may shine on any of its beams. In the points, the others repeat the first of
/// these. @return bit mask of these
std::uint32_t CameraLight::add_points(std::uint32_t first, Scratch& s) {
  std::uint32_t lit = 0;
  for (std::uint32_t k = 0; k < kWidth; ++k) lit |= s.lanes.sun[first + k] > 0.0f ? 1u << k : 0u;
  if (lit == 0) return 0;
  const float* const from[3] = {s.lanes.x + first, s.lanes.y + first, s.lanes.z + first};
  float* const to[3] = {s.points.x + s.points.count, s.points.y + s.points.count, s.points.z + s.points.count};
  for (int axis = 0; axis < 3; ++axis) {
    std::copy_n(from[axis], kWidth, to[axis]);
    for (std::uint32_t rest = ~lit & 0xFFFFu; rest != 0; rest &= rest - 1)
      to[axis][__builtin_ctz(rest)] = from[axis][__builtin_ctz(lit)];
  }
  s.points.count += kWidth;
  return lit;
}

/// @param shine per vector: bit mask of beams in the light of the sun
void CameraLight::add_light(const Frame& f, std::span<const std::uint32_t> shine, Lanes& lanes) {
  for (std::uint32_t v = 0, i = 0; i < f.beams; ++v)
    for (std::uint32_t k = 0; k < kWidth; ++k, ++i)
      if ((shine[v] >> k & 1) == 0) lanes.sun[i] = 0.0f;
  for (auto& light : lanes.light)
    for (std::uint32_t i = 0; i < f.beams; ++i) light[i] = light[i] * lanes.ambient[i] + light[i] * lanes.sun[i];
}

void CameraLight::shade(const base::RigidTransform& X_WS, const scene::BeamTile& tile, const View& view,
                        const scene::TileSurfaces& surfaces, Scratch& s) const {
  const glm::mat3 R_WS(X_WS.R), R_SW = glm::transpose(R_WS);
  const Frame frame{X_WS, tile, surfaces, kWidth * tile.used, view, R_WS, R_SW[2], R_SW * glm::vec3(to_sun_)};
  light_surfaces(frame, s.lanes);
  std::array<std::uint32_t, scene::kTileVectors> lit{};
  s.points.count = 0;
  for (std::uint32_t v = 0; v < tile.used; ++v) {
    color_vector(frame, kWidth * v, s.lanes);
    if (has_sun()) lit[v] = add_points(kWidth * v, s);
  }
  s.shadows.cast(s.points, s.dark);
  for (std::uint32_t v = 0, row = 0; v < tile.used; ++v)
    if (lit[v] != 0) lit[v] &= ~s.dark[row++];
  add_light(frame, lit, s.lanes);
}

}  // namespace sf::sensors
