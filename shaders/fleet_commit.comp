#version 450
#extension GL_GOOGLE_include_directive : require
// Fleet::commit: accepts the proposed path of a mover, unless it yields. After the last round, ends its tick.

#include "shaders/lib/fleet_tables.glsl"
#include "shaders/lib/fleet_motion.glsl"

void main() {
  if (!begin_row()) return;
  FleetOwn own = load_FleetOwn(own_states, own_row);
  if (own.phase == SF_FLEET_FAILED) return;
  FleetMotion motion = load_FleetMotion(motions, own_row);
  FleetShared state = load_FleetShared(shared_states, own_row);
  state.changed = 0u;
  if (own.round == SF_ROUND_YIELDED) {
    state.changed = 1u;
    store_FleetPose(proposed_poses, own_row, load_FleetPose(poses, own_row));
    store_FleetMotion(proposed_motions, own_row, motion);
  } else if (own.round == SF_ROUND_IN) {
    state.changed = has_moved(own_row) ? 1u : 0u;
    motion = load_FleetMotion(proposed_motions, own_row);
    store_FleetPose(poses, own_row, load_FleetPose(proposed_poses, own_row));
    store_FleetMotion(motions, own_row, motion);
  }
  state.waiting = motion.remaining > 0.0LF ? 1u : 0u;
  store_FleetShared(shared_states, own_row, state);

  own.round = SF_ROUND_OUT;
  own.phase = (own.phase / 2u + 1u) * 2u;
  if (own.phase == 2u * SF_FLEET_ROUNDS) {
    const bool refused = motion.refused != 0u || motion.remaining > 0.0LF;
    const dvec3 v = motion.remaining > 0.0LF ? dvec3(0.0LF) : velocity_of(motion);
    store_FleetMotion(motions, own_row, FleetMotion(v.x, v.y, v.z, 0.0LF, refused ? 1u : 0u, 0u, 0u, 0u));
    own.contact = imageLoad(absent, own_row).x == 0u && (refused || own.mask != 0u) ? 1u : 0u;
  }
  store_FleetOwn(own_states, own_row, own);
}
