#version 450
#extension GL_GOOGLE_include_directive : require
// Fleet::update_contacts, dispatched twice: first for movers whose step was refused or that had contacts before, then
// for the movers that refused a step.

#include "shaders/lib/fleet_tables.glsl"
#include "shaders/lib/fleet_contacts.glsl"

void main() {
  if (!begin_row()) return;
  FleetOwn own = load_FleetOwn(own_states, own_row);
  if (own.phase == SF_FLEET_FAILED) return;
  const bool is_first = own.phase == 2u * SF_FLEET_ROUNDS;
  const bool refused = load_FleetMotion(motions, own_row).refused != 0u;
  const bool is_struck = !is_first && imageLoad(struck, own_row).x != 0u && own.contact == 0u;
  if (is_first ? own.contact != 0u : is_struck)
    own.mask = body_contact(load_FleetPose(poses, own_row), is_first && refused).sectors;
  if (!is_first) {
    imageStore(struck, own_row, uvec4(0u));
    own.contact = imageLoad(absent, own_row).x == 0u && (refused || own.mask != 0u) ? 1u : 0u;
  }
  own.phase = has_failed ? SF_FLEET_FAILED : own.phase + 1u;
  store_FleetOwn(own_states, own_row, own);
}
