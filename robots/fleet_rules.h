#pragma once
// Rules of a fleet's motion that Fleet and its kernels (robots/device/device_fleet.h) share.

#include <cstdint>
#include <vector>

#include "base/pose.h"
#include "world/world.h"

namespace sf::robots {

inline constexpr double kMaxYield = 4e-3;  ///< [m] largest push-off of a turning body per substep

/// Returns the position of each row in the order of robots before tags, each in order of ids.
std::vector<std::uint32_t> ranks_of(const world::World& world);

/// Returns how many halvings of a refused substep leave a small enough gap to the obstacle (0.4 mm).
/// @param step [m] > 0, Footprint::step
int halvings_to_gap(double step);

/// Returns the direction, in the mover's frame, of the right border of contact sector k. That of sector
/// base::kContactSectors is that of sector 0.
glm::dvec2 contact_border(std::uint32_t k);

}  // namespace sf::robots
