// Counts the turns of all loops of an invocation. Mesa before 25.0 ends the loops of a software device silently after
// 65 535 turns of all lanes of a subgroup. Include it after local_size_x, which gl_WorkGroupSize is 1 without.

// Invocations per row of work; the others do nothing. On software devices, a row has a subgroup of its own.
layout(constant_id = 0) const uint kSpread = 1u;
// Turns after which the work fails; 0: any number.
layout(constant_id = 1) const uint kMostTurns = 0u;

uint turns_left;
bool has_failed;  // loops had too many turns

/// Returns the invocation.
uint begin_turns() {
  turns_left = kMostTurns;
  has_failed = false;
  return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

/// Counts a turn of a loop, or its end. Returns false when the device would soon end loops by itself.
/// @param cost 1 plus the loops inside it: devices that compute all lanes of a subgroup in step (lavapipe) run each of them
/// once even if no lane needs it
bool may_turn(uint cost) {
  if (kMostTurns == 0u) return true;
  has_failed = has_failed || turns_left < cost;
  turns_left -= has_failed ? 0u : cost;
  return !has_failed;
}
