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

CameraLight::CameraLight(const world::World& world, const std::vector<world::Material>& materials) : paint_(world) {
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

/// @param up, sun cosines of the angles between the direction and these
glm::vec3 CameraLight::sky_at(float up, float sun) const {
  if (sun > kSunCosine && has_sun()) return glm::vec3(1.0f);
  return glm::mix(kHorizon, kZenith, std::sqrt(glm::clamp(up, 0.0f, 1.0f))) * (sky_ / kUsualSky);
}

/// Returns the colour of the floor, or of paint on it, where a beam meets it.
glm::vec3 CameraLight::ground_at(const base::RigidTransform& X_WS, double range, const scene::BeamTile& tile,
                                 std::uint32_t i) const {
  if (paint_.empty()) return floor_;
  const glm::vec3* const paint =
      paint_.color_at(base::transform(X_WS, range * glm::dvec3(tile.dx[i], tile.dy[i], tile.dz[i])));
  return paint != nullptr ? *paint : floor_;
}

/// Geometry of a vector of beams, in loops that compilers turn into vector instructions.
struct CameraLight::Lanes {
  float x[kWidth], y[kWidth], z[kWidth];  ///< [m] in the world's axes, from the sensor
  float ambient[kWidth];                  ///< light of sky and ground on a white surface
  float sun[kWidth];                      ///< light of the sun, if it is not hidden; negative on the other side
};

void CameraLight::find_lanes(const glm::mat3& R_WS, const scene::BeamTile& tile, std::uint32_t first,
                             const scene::ScanOutput& scan, Lanes& lanes) const {
  const glm::mat3 R_SW = glm::transpose(R_WS);
  const glm::vec3 up_S = 0.5f * R_SW[2], sun_S = sun_ * (R_SW * glm::vec3(to_sun_));
  float n[3][kWidth], range[kWidth];
  for (std::uint32_t k = 0; k < kWidth; ++k) {
    const std::uint32_t beam = tile.place[first + k];
    const glm::vec3& normal = scan.normals[beam];
    n[0][k] = normal.x, n[1][k] = normal.y, n[2][k] = normal.z;
    range[k] = static_cast<float>(scan.ranges[beam]);
  }
  for (std::uint32_t k = 0; k < kWidth; ++k) {
    const float up = n[0][k] * up_S.x + n[1][k] * up_S.y + n[2][k] * up_S.z;
    lanes.ambient[k] = sky_ * (0.5f + up) + ground_ * (0.5f - up);
    lanes.sun[k] = n[0][k] * sun_S.x + n[1][k] * sun_S.y + n[2][k] * sun_S.z;
    const float x = range[k] * tile.x[first + k], y = range[k] * tile.y[first + k], z = range[k] * tile.z[first + k];
    lanes.x[k] = R_WS[0].x * x + R_WS[1].x * y + R_WS[2].x * z;
    lanes.y[k] = R_WS[0].y * x + R_WS[1].y * y + R_WS[2].y * z;
    lanes.z[k] = R_WS[0].z * x + R_WS[1].z * y + R_WS[2].z * z;
  }
}

void CameraLight::shade(const base::RigidTransform& X_WS, const scene::BeamTile& tile, double depth_max,
                        const scene::ScanOutput& scan, std::span<glm::vec3> out, Scratch& s) const {
  const glm::mat3 R_WS(X_WS.R), R_SW = glm::transpose(R_WS);
  const glm::vec3 up_S = R_SW[2], sun_S = R_SW * glm::vec3(to_sun_);
  const bool sunny = has_sun();
  s.points.count = 0;
  Lanes lanes;
  for (std::uint32_t i = 0; i < tile.used * kWidth; ++i) {
    const std::uint32_t beam = tile.place[i], hit = scan.hits[beam], k = i % kWidth;
    if (k == 0) find_lanes(R_WS, tile, i, scan, lanes);
    if (k > 0 && beam == tile.place[i - 1]) continue;  // a vector that is not full
    if (hit == base::kNoHit || !(scan.ranges[beam] * tile.dx[i] < depth_max)) {
      const glm::vec3 d(tile.x[i], tile.y[i], tile.z[i]);
      out[beam] = sky_at(glm::dot(d, up_S), glm::dot(d, sun_S));
      continue;
    }
    const std::uint32_t material = scan.materials.empty() ? world::kNoMaterial : scan.materials[beam];
    const glm::vec3 albedo = material < materials_.size() ? materials_[material]
                             : hit < models_.size()       ? models_[hit]
                                                          : ground_at(X_WS, scan.ranges[beam], tile, i);
    out[beam] = albedo * lanes.ambient[k];
    if (!(sunny && lanes.sun[k] > 0.0f)) continue;
    s.beam[s.points.count] = beam, s.direct[s.points.count] = albedo * lanes.sun[k];
    s.points.add({lanes.x[k], lanes.y[k], lanes.z[k]});
  }
  s.shadows.cast(s.points, s.dark);
  for (std::uint32_t k = 0; k < s.points.count; ++k)
    if ((s.dark[k / kWidth] >> k % kWidth & 1) == 0) out[s.beam[k]] += s.direct[k];
}

}  // namespace sf::sensors
