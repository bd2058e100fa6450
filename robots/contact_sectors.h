#pragma once
// Contact sectors: the sectors (base::kContactSectors) of a body that have a surface within kContactDistance of the
// body's outline, or inside it.

#include <cstdint>

#include "robots/footprint.h"
#include "world/world.h"

namespace sf::robots {

/// [m] surfaces closer than this touch.
inline constexpr double kContactDistance = 1e-3;
inline constexpr std::uint32_t kAllSectors = 0xFFFFFFFFu;

/// Bits of the sectors in which the wall is within kContactDistance of the outline, or inside it, by the bearings of
/// the wall's points from the mover's origin. 0 when their heights do not overlap.
/// @param X_WM of the mover
std::uint32_t contact_sectors(const Footprint& outline, const base::Pose& X_WM, const world::Segment& wall);

/// Likewise for another mover's outline. All bits when the mover is inside the other's solid and near none of its
/// edges.
/// @param wanted sectors to test; not all: the mover is not inside the other's solid
std::uint32_t contact_sectors(const Footprint& outline, const base::Pose& X_WM, const Footprint& other,
                              const base::Pose& X_WO, std::uint32_t wanted = kAllSectors);

/// Bits of the sectors that another mover may touch, and perhaps more, without `known` ones; all bits where the mover
/// may be inside the other's solid. Takes a fraction of the time of `contact_sectors`.
std::uint32_t sectors_to_test(const Footprint& outline, const base::Pose& X_WM, const Footprint& other,
                              const base::Pose& X_WO, std::uint32_t known);

}  // namespace sf::robots
