#version 450
#extension GL_GOOGLE_include_directive : require
// Infrared proximity: the nearest surface in each cone of all due sensors, in one dispatch.

#include "shaders/raycast/records.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer cones;    // ConeRow of each cone
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer ranges;   // LaneRanges of each lane
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer hits;     // LaneHits of each lane
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer echoes;  // ConeEcho of each cone

// Light is scattered back at any angle of incidence.
bool returns_echo(int beam, uint hit, vec2 heading, float min_cosine) { return true; }

#include "shaders/lib/cone.glsl"

void main() { write_echo(int(gl_GlobalInvocationID.x)); }
