#pragma once
// The track of one mover, and helpers for figures with tracks.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/pose.h"
#include "viz/axes.h"
#include "world/world.h"

namespace sf::viz {

/// The path of one mover, sorted by time.
struct Track {
  std::string name;
  std::optional<std::uint32_t> color;  ///< 0xAARRGGBB; nullopt: the palette's colour for its row
  std::vector<base::Pose> poses;       ///< [m], [rad] world frame; poses that are not finite leave gaps
  std::vector<std::uint8_t> contacts;  ///< empty, or one per pose: 1 if something stopped the mover
  double duration = 0.0;               ///< [s] from the first to the last pose; 0 if unknown
};

bool is_finite(const base::Pose& X_WM);
/// [m] Returns the length of the whole path.
double path_length(const Track& track);
/// Returns the number of contacts (base/contact_onset.h).
std::size_t contact_count(const Track& track);

/// [m] Returns the extent of the world and all tracks.
world::Extent extent_of(const world::World& world, std::span<const Track> tracks);

void draw_path(Axes& axes, const Track& track, double line_width, std::uint32_t color,
               std::span<const double> dash = {});
/// Draws one cross at the start of each contact, unless it would overlap the track's previous cross.
/// @param reach [px] from its centre to its ends
void draw_contacts(Axes& axes, const Track& track, double reach, double line_width);

}  // namespace sf::viz
