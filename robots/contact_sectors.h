#pragma once
// Contact sectors: the sectors (base::kContactSectors) of a body in which a surface is within kContactDistance of the
// outline or inside it.

#include <cstdint>

#include "robots/footprint.h"
#include "world/world.h"

namespace sf::robots {

/// [m] Surfaces closer than this are in contact.
inline constexpr double kContactDistance = 1e-3;
inline constexpr std::uint32_t kAllSectors = 0xFFFFFFFFu;

/// Returns the bits of the sectors in which the wall is within kContactDistance of the outline or inside it, by the
/// bearings of the wall's points from the mover's origin. 0 when the height ranges do not overlap.
/// @param X_WM pose of the mover
std::uint32_t contact_sectors(const Footprint& outline, const base::Pose& X_WM, const world::Segment& wall);

/// Returns the same for another mover's outline. All bits when the mover is inside the other's solid and not near any
/// of its edges.
/// @param wanted sectors to test; with fewer than all, the mover is assumed to be outside the other's solid
std::uint32_t contact_sectors(const Footprint& outline, const base::Pose& X_WM, const Footprint& other,
                              const base::Pose& X_WO, std::uint32_t wanted = kAllSectors);

/// Returns the bits of the sectors that the other mover may touch, except those in `known`. Conservative: the result
/// may contain more sectors, and has all bits when the mover may be inside the other's solid. Takes a fraction of the
/// time of `contact_sectors`.
std::uint32_t sectors_to_test(const Footprint& outline, const base::Pose& X_WM, const Footprint& other,
                              const base::Pose& X_WO, std::uint32_t known);

}  // namespace sf::robots
