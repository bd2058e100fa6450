#version 450
#extension GL_GOOGLE_include_directive : require
// Adds the present movers to the grid, which fleet_start has emptied.

#include "shaders/lib/fleet_tables.glsl"
#include "shaders/lib/fleet_motion.glsl"

void main() {
  if (!begin_row() || imageLoad(absent, own_row).x != 0u) return;
  const ivec2 cell = cell_at(origin_of(load_FleetPose(poses, own_row)));
  const uint copy = copy_of(own_row);
  const uint next = imageAtomicExchange(buckets, bucket_of(cell, copy), uint(own_row) + 1u);
  store_FleetPlace(places, own_row, FleetPlace(cell.x, cell.y, copy, next));
}
