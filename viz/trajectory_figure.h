#pragma once
// Where everyone went.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/pose.h"
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

/// Draws the walls, each track in its own colour with its start, its end and the places where it was stopped (once per
/// contact), later tracks over earlier ones. Up to seven tracks are named in the legend, more are told by a colour bar.
/// @throws base::InputError naming the path when it cannot be written.
void draw_trajectories(const world::World& world, std::span<const Track> tracks, const std::string& png_path);

}  // namespace sf::viz
