#version 450
#extension GL_GOOGLE_include_directive : require
// Infrared proximity: the nearest surface in each cone of all due sensors, in one dispatch.

#include "sensors/cones/records.h"
#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer cones;    // SF_CONE_TEXELS per cone: ConeRow
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer ranges;   // two texels per lane: four doubles [m]
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer hits;     // one texel per lane: models
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer echoes;  // one texel per cone: ConeEcho

// Light is scattered back at any angle of incidence.
bool returns_echo(int beam, uint hit, vec2 heading, float min_cosine) { return true; }

#include "shaders/lib/cone.glsl"
