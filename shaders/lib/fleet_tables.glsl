// Tables of the kernels that move a fleet (robots/device/device_fleet.h), and the row of an invocation. Names of functions
// are those of robots::Fleet.

#include "shaders/robots/device/records.glsl"

layout(local_size_x = 64) in;
// Invocations per mover; the others do nothing. On devices that end loops early, a mover has a subgroup of its own.
layout(constant_id = 0) const uint kSpread = 1u;
// Turns of all loops per mover and kernel, after which its tick fails; 0: any number.
layout(constant_id = 1) const uint kMostTurns = 0u;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer tick;        // FleetTick
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer commands;    // FleetCommand per row
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer drives;      // FleetDrive per row
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer bodies;      // FleetBody per row
layout(binding = 4, rgba32ui) uniform readonly uimageBuffer footprints;  // FleetFootprint
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer edges;       // FleetEdge
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer walls;       // FleetWall, leaf by leaf
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer nodes;       // FleetNode, depth first
layout(binding = 8, rgba32ui) uniform readonly uimageBuffer borders;     // FleetBorder
layout(binding = 9, r32ui) uniform readonly uimageBuffer absent;         // 1: absent, per row
layout(binding = 10, rgba32ui) uniform uimageBuffer poses;               // FleetPose per row, at the start of the round
layout(binding = 11, rgba32ui) uniform uimageBuffer proposed_poses;
layout(binding = 12, rgba32ui) uniform uimageBuffer motions;  // FleetMotion per row
layout(binding = 13, rgba32ui) uniform uimageBuffer proposed_motions;
layout(binding = 14, rgba32ui) uniform uimageBuffer shared_states;  // FleetShared per row
layout(binding = 15, rgba32ui) uniform uimageBuffer own_states;     // FleetOwn per row
layout(binding = 16, r32ui) uniform uimageBuffer struck;            // 1: it touches a mover with a refused step
layout(binding = 17, r32ui) uniform uimageBuffer buckets;           // 1 + the row of the first mover; 0: none
layout(binding = 18, rgba32ui) uniform uimageBuffer places;         // FleetPlace per row

#define SF_MAX_YIELD 4e-3LF  // Fleet::kMaxYield

int own_row;       // this invocation's mover
uint turns_left;   // of loops
bool has_failed;   // loops had too many turns

/// Sets the invocation's row. Returns false if the invocation has no work.
bool begin_row() {
  const uint lane = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  own_row = int(lane / kSpread);
  turns_left = kMostTurns;
  has_failed = false;
  return lane % kSpread == 0u && uint(own_row) < load_FleetTick(tick, 0).movers;
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

dvec2 origin_of(FleetPose X_WM) { return dvec2(X_WM.x, X_WM.y); }
