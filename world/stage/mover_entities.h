#pragma once
// Which models move, and by which number packets know them.

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

/// What a model's own name links it to. Tags count from 1, robots from 0; more than nine digits are no number.
std::optional<PacketId> packet_id_of(std::string_view name);

/// The controller of ours that `ctrl` names (Stage's `wander`); empty where it names none, with a warning.
std::string controller_of(BuildState& b, const Entity& entity);

/// `tag_pose`: where the tag is mounted on a model that follows its packets. On any other it is ignored, with a
/// warning.
/// @throws base::InputError as any pose, and for one 100 m from the origin.
Pose tag_pose_of(StageContext& context, const Entity& entity, bool is_tag);

/// Adds a mover for `model`, which becomes the next row of the models, and returns its row.
/// @throws base::InputError for bounds, a drive, a command law or lengths that no robot can have.
std::uint32_t add_mover(BuildState& b, const Entity& entity, const Model& model, std::optional<PacketId> packet_id);

/// Gives every mover its number: from names first; every other robot gets the smallest one left, from 0, in file order.
/// @throws base::InputError when two robots, or two tags, have the same number.
void number_movers(BuildState& b);

}  // namespace sf::world
