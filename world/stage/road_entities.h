#pragma once
// Roads of a world file: `road( rndf "FILE" )` and `path( ... )`.

#include "world/stage/build_state.h"

namespace sf::world {

/// Adds the lane markings of a road network at the place given by its sidecar, and magnets under its lanes:
///
///   road( rndf "FILE" magnetic_moment 10000 magnet_spacing 0.071 magnet_lanes "1.1 1.2" )
///
/// @throws base::InputError with file and line
void add_road(BuildState& b, const Entity& entity);

/// Adds one lane of exact straight lines and arcs, with its lane markings and magnets.
///
///   path( pose [x y z yaw] pieces 3
///     straight[0] [length width] arc[1] [radius turn width] straight[2] [length width]
///     left "solid_white" right "broken_white" paint_width 0.02 dash [length gap]
///     magnetic_moment 10000 magnet_spacing 0.071 magnet_size [width length] magnet_top 0 )
///
/// The pose is the lane's centre line at its start; a positive turn is to the left. The paint is outside the lane: its
/// inner edge is half the width from the centre line. An arc is approximated by chords within 1 um. Magnets are upright
/// under the centre line, the first at the start, with the top `magnet_top` above the ground.
/// @throws base::InputError with file and line
void add_path(BuildState& b, const Entity& entity);

}  // namespace sf::world
