#pragma once
// Roads of a world file: `road( rndf "FILE" )` and `path( ... )`.

#include "world/stage/build_state.h"

namespace sf::world {

/// The paint of a road network, where its sidecar says that it lies, and magnets under its lanes:
///
///   road( rndf "FILE" magnetic_moment 10000 magnet_spacing 0.071 magnet_lanes "1.1 1.2" )
///
/// @throws base::InputError with file and line.
void add_road(BuildState& b, const Entity& entity);

/// One lane made of exact straights and arcs, with its paint and its magnets.
///
///   path( pose [x y z yaw] pieces 3
///     straight[0] [length width] arc[1] [radius turn width] straight[2] [length width]
///     left "solid_white" right "broken_white" paint_width 0.02 dash [length gap]
///     magnetic_moment 10000 magnet_spacing 0.071 magnet_size [width length] magnet_top 0 )
///
/// The pose is that of the middle of the lane at its start; a turn above zero is to the left. Paint lies outside the
/// lane: its inner face is half the width from the middle. An arc is drawn by chords within 1 um of it.
/// Magnets stand upright under the middle, the first at the start, `magnet_top` above the ground.
/// @throws base::InputError with file and line.
void add_path(BuildState& b, const Entity& entity);

}  // namespace sf::world
