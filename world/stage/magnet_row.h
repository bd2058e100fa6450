#pragma once
// Rows of magnets under a lane: four properties describe thousands of magnets.

#include <functional>
#include <optional>

#include "world/stage/build_state.h"

namespace sf::world {

/// Upright magnets at equal distances.
struct MagnetRow {
  double moment = 0.0;   ///< [A m^2] not 0
  double spacing = 0.0;  ///< [m] > 0
  double width = 0.0;    ///< [m] > 0, of one magnet
  double length = 0.0;   ///< [m] of one magnet, upright
  double top = 0.0;      ///< [m] upper end above the ground
};

/// Reads `magnetic_moment`, `magnet_spacing`, `magnet_size [width length]` and `magnet_top`; nullopt if the first two
/// are absent.
/// @throws base::InputError with file and line
std::optional<MagnetRow> read_magnet_row(StageContext& context, const Entity& entity);

/// Adds magnets at s = 0, spacing, 2 spacing ... up to `length` [m], at `along(s)`. They belong to the last model.
/// @throws base::InputError, with the place of `entity`, for more than a million magnets
void place_magnets(BuildState& b, const Entity& entity, const MagnetRow& row, double length,
                   const std::function<Pose(double)>& along);

}  // namespace sf::world
