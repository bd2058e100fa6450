#pragma once
// Surfaces of a 2.5-D world: its outlines, from their lower to their upper heights, as prisms.

#include <cstdint>
#include <span>

#include "scene/mesh.h"
#include "world/world.h"

namespace sf::scene {

/// Returns the sides of all segments that lasers see, and for those of closed outlines of a solid
/// (Segment::solid_left) its top and bottom. Segments without a height (z_min >= z_max) have no surface.
/// @param segments in the order of the outlines, forward or backward, each outline closed by its last segment
/// @param on_floor leaves out horizontal faces at z = 0, which coincide with the floor
Mesh mesh_of(std::span<const world::Segment> segments, bool on_floor = false);

/// Returns the roads above the floor and, in a world with holes in the floor, the floor without them, as far as `reach`
/// [m] beyond the world's extent. Without owners. Bends of roads have the gaps and overlaps of World::ramps.
Mesh ground_of(const world::World& world, double reach);

/// Returns the triangles of a file's mesh, without owners.
Mesh mesh_of(const world::Mesh& triangles);

}  // namespace sf::scene
