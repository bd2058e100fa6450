#pragma once
// Every beam against every face in `long double`, by another method than the rasterizer: for tests and `verify`.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>

#include "scene/rasterizer.h"

namespace sf::scene {

struct ReferenceHit {
  long double range = 0.0L;                     ///< [m] range_max where nothing is nearer
  std::uint32_t owner = base::kNoHit;           ///< as ScanOutput::hits
  long double cosine = 0.0L;                    ///< of the angle of incidence
  glm::vec3 normal{};                           ///< as ScanOutput::normals
  std::uint32_t material = world::kNoMaterial;  ///< as ScanOutput::materials
  glm::dvec2 coordinates{};                     ///< of the texture, as TileSurfaces::u and v
  glm::vec3 spread{};                           ///< as TileSurfaces::spread
};

/// @param direction in the sensor's frame; need not be a unit vector to rounding, ranges are along it
ReferenceHit reference_scan(const RigidTransform& X_WS, glm::dvec3 direction, double range_max, const SceneView& scene);

}  // namespace sf::scene
