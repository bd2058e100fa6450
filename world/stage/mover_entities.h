#pragma once
// Movers among the models, and their ids in packets.

#include <cstdint>
#include <optional>
#include <string_view>

#include "world/stage/build_state.h"

namespace sf::world {

/// `roomba<N>`, `pioneer<N>`, `khepera<N>` follow the V2V packets of robot N; `tag<N>` follows tag N.
struct PacketId {
  std::uint32_t number = 0;
  bool is_tag = false;
};

/// Returns the packet id in a model's own name. Tags count from 1, robots from 0. More than nine digits give no id.
std::optional<PacketId> packet_id_of(std::string_view name);

/// Reads `tag_pose`: the pose of the tag on a model that follows TAG packets. Other models ignore it, with a warning.
/// @throws base::InputError as for any pose, and for a pose 100 m from the origin
Pose tag_pose_of(StageContext& context, const Entity& entity, bool is_tag);

/// Adds a mover for `model`, which becomes the next row of the models, and returns its row.
/// @param size [m] of the model  @param is_tag it is an object, not a robot
/// @throws base::InputError for bounds, a drive, an actuator model or lengths out of range
std::uint32_t add_mover(BuildState& b, const Entity& entity, const Model& model, const glm::dvec3& size,
                        std::optional<PacketId> packet_id, bool is_tag);

/// Assigns the ids of movers: first the ids in names; then each other robot gets the smallest free id from 0, and each
/// other object the smallest free id of a tag from 1, in file order.
/// @throws base::InputError if two robots, or two tags, have the same id
void number_movers(BuildState& b);

/// Returns whether the model has a key of random starts.
bool is_random(const Entity& entity);

}  // namespace sf::world
