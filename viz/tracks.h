#pragma once
// Where one mover went, and what figures make of it.

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

/// The path of one mover, in order of time.
struct Track {
  std::string name;
  std::optional<std::uint32_t> color;  ///< 0xAARRGGBB; else one from the palette, by row
  std::vector<base::Pose> poses;       ///< [m], [rad] world frame; the path is broken where a pose is not finite
  std::vector<std::uint8_t> contacts;  ///< empty, or one per pose: 1 where something stopped it
  double duration = 0.0;               ///< [s] from the first to the last pose; 0 where unknown
};

bool is_finite(const base::Pose& X_WM);
/// [m] of the whole path.
double path_length(const Track& track);
/// Contacts that began (base/contact_onset.h).
std::size_t contact_count(const Track& track);

/// Of the world and of all tracks. [m]
world::Extent extent_of(const world::World& world, std::span<const Track> tracks);

void draw_path(Axes& axes, const Track& track, double line_width, std::uint32_t color);
/// One cross where each contact began, but none on top of the track's last one.
/// @param reach [px] from its middle to its ends
void draw_contacts(Axes& axes, const Track& track, double reach, double line_width);

}  // namespace sf::viz
