#pragma once
// Texture coordinates on faces, and along the beams that meet them.

#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_float3.hpp>
#include <glm/geometric.hpp>

#include "scene/decision.h"
#include "scene/mesh.h"

namespace sf::scene {

/// Affine function of a place p in the plane of a face: c + (du . (p - point), dv . (p - point)).
struct TextureMap {
  glm::dvec3 point{};
  glm::dvec2 c{};
  glm::dvec3 du{}, dv{};  ///< [1/m] 0 where the face is too small for a quotient

  glm::dvec2 at(const glm::dvec3& p) const;
};

/// @param corners the first three of a face
TextureMap texture_map(const std::array<glm::dvec3, 3>& corners, const FaceCoordinates& coordinates);

/// The function of a face in the sensor's frame, whose origin is its `point`. @param face of a mesh with coordinates
TextureMap seen_texture(const SceneMesh& mesh, std::uint32_t face);

/// Returns products of the gradients gu, gv of the texture coordinates with respect to the direction of a beam that
/// meets a face: (gu . gu, gu . gv, gv . gv) [1/rad^2]. They grow beyond all bounds as the beam meets it edge-on.
/// @param map of seen_texture  @param normal unit vector of the face  @param d unit vector  @param range [m]
inline glm::vec3 texture_spread(const TextureMap& map, const glm::dvec3& normal, const glm::dvec3& d, double range) {
  // A direction d + e, with e across d, meets the plane at the place range (d + e - d (n . e) / (n . d)).
  const glm::dvec3 tilt = normal * (range / glm::dot(normal, d));
  const glm::dvec3 gu = range * map.du - glm::dot(map.du, d) * tilt, gv = range * map.dv - glm::dot(map.dv, d) * tilt;
  return glm::vec3(glm::dvec3(glm::dot(gu, gu), glm::dot(gu, gv), glm::dot(gv, gv)));
}

}  // namespace sf::scene
