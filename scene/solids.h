#pragma once
// Surfaces of a 2.5-D world: its outlines, from their lower to their upper heights, as prisms.

#include <cstdint>
#include <span>

#include "base/box.h"
#include "scene/mesh.h"
#include "world/world.h"

namespace sf::scene {

/// Returns the sides of all segments that lasers see, and for those of closed outlines of a solid
/// (Segment::solid_left) its top and bottom. Segments without a height (z_min >= z_max) have no surface.
/// @param segments in the order of the outlines, forward or backward, each outline closed by its last segment; those of
/// a picture (world/bitmap.h) in any order
/// @param on_floor leaves out horizontal faces at z = 0, which coincide with the floor
Mesh mesh_of(std::span<const world::Segment> segments, bool on_floor = false);

/// Returns the roads above the floor, as bodies stand on them (world/ground.h). Without owners.
Mesh roads_of(const world::World& world);

/// Returns the box around all holes of the floor and the rectangle of the terrain; without these, `base::empty_box()`.
base::Box box_of_holes(const world::World& world);

/// Returns the floor without its holes and without that rectangle, as far as 2 `reach` [m] beyond their box. Without
/// owners.
Mesh holed_floor(const world::World& world, double reach);

/// Returns the surface of a file's mesh, without owners and triangles whose area is 0, as scaling may leave some.
/// @param materials per triangle, as Mesh::materials
/// @param coordinates as world::MeshTextures::corners, or empty
Mesh mesh_of(const world::Mesh& triangles, std::vector<std::uint32_t> materials = {},
             std::span<const glm::vec2> coordinates = {});

}  // namespace sf::scene
