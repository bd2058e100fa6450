#pragma once
// The static surfaces of a world and the meshes of its models, for the live view in three dimensions:
// `sensorfarm_msgs/msg/Solids`. Bodies of movers without a mesh are prisms of the outlines in /scene.json.

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "world/world.h"

namespace sf::bridges {

inline constexpr std::string_view kSolidsTopic = "/view_3d/solids";
inline constexpr std::size_t kMostViewWalls = 100'000;      ///< the first of the world are sent
inline constexpr std::size_t kMostViewTriangles = 400'000;  ///< of meshes, each counted once

inline constexpr std::size_t kMostViewHeights = 100'000;  ///< points of terrain; larger maps are sent in larger steps

/// Distinguishes walls as the figures do (viz/wall_layer.cpp): "solid"; "passable" for robots; "unseen" by lasers;
/// "overhead" of all movers.
/// @param headroom [m] of headroom_of
const char* wall_kind(const world::Segment& wall, double headroom);
/// Returns the height [m] above all movers, as if all were on the floor; infinite if there are none.
double headroom_of(const world::World& world);

/// Returns a flag per model: it is sent as a mesh. Meshes that exceed kMostViewTriangles, in the order of the file, are
/// not; their models are prisms.
std::vector<std::uint8_t> models_in_view_as_mesh(const world::World& world);

/// Returns the message. Reads parts of `world` that do not change during a run only.
/// @param headroom [m] of headroom_of at the start
base::Bytes solids_message(const world::World& world, double headroom);

}  // namespace sf::bridges
