#version 450
#extension GL_GOOGLE_include_directive : require
// Fleet::propose and Fleet::yields, dispatched in turn: advances the movers of a round along their paths, then tests the
// same paths again with the new places of movers with a smaller rank.

#include "shaders/lib/fleet_tables.glsl"
#include "shaders/lib/fleet_contacts.glsl"
#include "shaders/lib/fleet_path.glsl"

bool takes_part(Path path, uint round) {
  const FleetShared own = load_FleetShared(shared_states, own_row);
  if (round == 0u || round + 1u == SF_FLEET_ROUNDS) return own.waiting != 0u;
  bool stirs = own.changed != 0u;
  NearWalk walk = near_movers(path);
  int other = 0;
  while (may_turn(4u) && other >= 0 && !stirs && own.waiting != 0u) {
    other = next_near(path, walk);
    stirs = other >= 0 && load_FleetShared(shared_states, other).changed != 0u;
  }
  return own.waiting != 0u && stirs;
}

bool is_exposed(Path path) {
  bool exposed = false;
  NearWalk walk = near_movers(path);
  int other = 0;
  while (may_turn(4u) && other >= 0 && !exposed) {
    other = next_near(path, walk);
    exposed = other >= 0 && load_FleetShared(shared_states, other).waiting != 0u;
  }
  return exposed;
}

bool has_rival(Path path) {
  bool found = false;
  NearWalk walk = near_movers(path);
  int other = 0;
  while (may_turn(4u) && other >= 0 && !found) {
    other = next_near(path, walk);
    found = is_rival(path, other);
  }
  return found;
}

void main() {
  if (!begin_row()) return;
  FleetOwn own = load_FleetOwn(own_states, own_row);
  if (own.phase == SF_FLEET_FAILED) return;
  const bool yielding = (own.phase & 1u) != 0u;
  const uint round = own.phase / 2u;
  const FleetMotion proposed = load_FleetMotion(proposed_motions, own_row);
  if (!yielding) own.phase += 1u;
  // Most movers end here in later rounds.
  const bool may_act = yielding ? own.round == SF_ROUND_IN && proposed.exposed != 0u && has_moved(own_row)
                                : load_FleetShared(shared_states, own_row).waiting != 0u;
  if (may_act) {
    const FleetMotion motion = load_FleetMotion(motions, own_row);
    const Path path = find_near(motion);
    if (yielding ? has_rival(path) : takes_part(path, round)) {
      FleetPose X_WM = path.from;
      FleetMotion result = motion;
      const bool yields = advance_mover(path, round + 1u == SF_FLEET_ROUNDS, yielding, proposed.free != 0u, X_WM, result);
      if (yielding) {
        own.round = yields ? SF_ROUND_YIELDED : SF_ROUND_IN;
      } else {
        own.round = SF_ROUND_IN;
        result.exposed = is_exposed(path) ? 1u : 0u;
        store_FleetPose(proposed_poses, own_row, X_WM);
        store_FleetMotion(proposed_motions, own_row, result);
      }
    }
  }
  if (has_failed) own.phase = SF_FLEET_FAILED;
  store_FleetOwn(own_states, own_row, own);
}
