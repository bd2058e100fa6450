#pragma once
// Scenes and patterns of the lidar benchmark.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/rigid_transform.h"
#include "scene/beam_pattern.h"
#include "scene/height_field.h"
#include "scene/mesh.h"
#include "world/world.h"

namespace sf::bench {

struct LidarScene {
  scene::Mesh mesh;
  scene::HeightField field;                 ///< of the same surface; empty: none
  world::World forest;                      ///< instead of a mesh: models with one mesh; without models: none
  std::vector<base::RigidTransform> poses;  ///< of the sensor
};

/// @param name `cityN` (N x N houses of 6 m on squares of 10 m), `room` (furniture of 42 000 triangles in 20 m x 15 m;
/// `room32`: with coordinates in 32 bits, as in many files, so that only axis-aligned ones are exactly in a plane;
/// `yard`: without a ceiling), `terrain` (524 000 triangles in 256 m x 256 m), `forest` or `statues` (1 000 trees of 20
/// 000 triangles, or balls of 78 000, in 160 m x 160 m)
LidarScene lidar_scene(const std::string& name, int poses);

/// @param name `lidarRxC` (R rings of C columns over 45 degrees, up to 16 rings 30 degrees) or `cameraWxH` (90 degrees)
/// @param row out: length of a ring; 0: an image
std::vector<glm::dvec3> lidar_beams(const std::string& name, std::uint32_t& row);
/// Their pattern, or that of some columns of rings. @param row 0: an image
scene::BeamPattern lidar_pattern(std::span<const glm::dvec3> beams, std::uint32_t row);

}  // namespace sf::bench
