// Tables of the kernels that move a fleet (robots/device/device_fleet.h), and the row of an invocation. Names of functions
// are those of robots::Fleet.

#include "shaders/robots/device/records.glsl"

layout(local_size_x = 64) in;
#include "shaders/lib/loop_turns.glsl"
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

#define SF_MAX_YIELD 4e-3LF  // robots::kMaxYield

int own_row;  // this invocation's mover

/// Sets the invocation's row. Returns false if the invocation has no work.
bool begin_row() {
  const uint lane = begin_turns();
  own_row = int(lane / kSpread);
  return lane % kSpread == 0u && uint(own_row) < load_FleetTick(tick, 0).movers;
}

dvec2 origin_of(FleetPose X_WM) { return dvec2(X_WM.x, X_WM.y); }
