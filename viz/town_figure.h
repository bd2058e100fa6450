#pragma once
// What a fleet did in a town: its streets, everyone's way, where they are at the end, who follows whom, what lights
// show.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "viz/tracks.h"
#include "world/world.h"

namespace sf::viz {

/// What is to be told beside the tracks, at their end.
struct TownFinalState {
  double time = 0.0;                   ///< [s] lights show what they show then
  std::vector<std::uint32_t> movers;   ///< row in `World::movers` of each track
  std::vector<std::uint32_t> follows;  ///< per track: the track that it follows; world::kNone: nobody
};

/// Draws everyone's way thin and its body at its end; who is in a convoy, and its way, in a colour of its own, each
/// joined to whom it follows; robots of other shapes than most in a third colour.
/// @throws base::InputError naming the path when it cannot be written, or for roads that cannot be read any more.
void draw_town(const world::World& world, std::span<const Track> tracks, const TownFinalState& end,
               const std::string& png_path);

}  // namespace sf::viz
