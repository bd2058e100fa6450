#pragma once
// The tracks of all movers.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "viz/picture_file.h"
#include "viz/tracks.h"
#include "world/world.h"

namespace sf::viz {

inline constexpr std::size_t kLabelledTracks = 10;  ///< a larger number has labels only on request

/// Tracks to name at their ends, as far as there is room.
struct TrackLabels {
  bool all = false;                ///< of up to 150 tracks
  std::vector<std::string> names;  ///< these are drawn on top of the others, which are grey
};

/// Draws the walls, each track in a distinct colour with its start, its end and its contacts (one mark per contact),
/// later tracks on top. Up to seven tracks are named in the legend, up to ten at their ends; with more tracks only
/// those of `labels`.
/// @param what meaning of one track, for the subtitle: robots of one run, or trials of one robot
/// @return the number of `labels` without room.
/// @throws base::InputError naming the path if it cannot be written.
std::size_t draw_trajectories(const world::World& world, std::span<const Track> tracks, const std::string& path,
                              std::string_view what = "robot", const Page& page = {}, const TrackLabels& labels = {});

}  // namespace sf::viz
