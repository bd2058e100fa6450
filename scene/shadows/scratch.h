#pragma once
// Memory of a ShadowCaster.

#include <cstdint>
#include <glm/ext/vector_float2.hpp>
#include <glm/ext/vector_float3.hpp>
#include <glm/mat3x3.hpp>
#include <vector>

#include "scene/field_shadow.h"
#include "scene/shadows.h"

namespace sf::scene {

/// A mesh of the scene.
struct ShadowMesh {
  const SurfaceTree* tree = nullptr;
  bool turned = false;
  glm::dmat3 R_WI{1.0};
  glm::dvec3 p{};       ///< [m] its frame's origin, from the sensor in the world's axes
  glm::dvec3 centre{};  ///< [m] its middle, in the same way
  glm::vec3 light{};    ///< direction in its frame, no coordinate is 0
};

/// Up to sixteen faces: p is behind face i if edge_k . p + offset_k >= 0 for all k and height - normal . p > 0.
struct ShadowFaces {
  alignas(64) float edge[4][3][kWidth], offset[4][kWidth], normal[3][kWidth], height[kWidth];
  alignas(64) float across[4][2][kWidth];  ///< the edges along Scratch::across, which with the light span the world
  std::uint32_t used = 0;                  ///< bit mask
};

/// Box of points, with room for rounding.
struct PointBox {
  glm::vec3 middle, half;
  glm::vec2 across_middle, across_half;  ///< along Scratch::across
};

struct ShadowCaster::Scratch {
  glm::vec3 light{};      ///< in the world
  glm::vec3 across[2]{};  ///< unit vectors across the light, at right angles
  float least = kLeastShadow;
  std::vector<ShadowMesh> meshes;
  std::vector<std::int32_t> stack;
  std::vector<ShadowFaces> faces;  ///< that may hide points of a group
  ShadowFaces last;                ///< that hid points, in a ring
  std::uint32_t hid = 0;           ///< how many did
  FieldShadow field;
};

}  // namespace sf::scene
