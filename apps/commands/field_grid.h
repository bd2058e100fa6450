#pragma once
// The field of a world's magnets on a plane, for VTK.

#include <optional>

#include "gpu/device.h"
#include "viz/vtk_files.h"
#include "world/world.h"

namespace sf::apps {

/// Returns cells over the world's extent with the arrays `magnitude` [T], `B` [T] and `in_plane` [T], which is B
/// without its z component. Returns nullopt if the world has no magnets.
/// @param height [m] of the plane in the world
std::optional<viz::GridData> field_grid(const world::World& world, gpu::Device& device, double height);

}  // namespace sf::apps
