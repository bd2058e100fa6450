#version 450
#extension GL_GOOGLE_include_directive : require
// The lane edge sensor's fit: every sensor that is due, in one dispatch.

#include "sensors/laneedge.h"
#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;       // SF_EDGE_TEXELS a sensor: EdgeRow
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer points;     // a texel a beam: x, y [m], its grain in x
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer grains;     // a texel a pixel size [m]
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer readings;  // SF_READING_TEXELS a sensor: EdgeReading
layout(binding = 4, r32ui) uniform readonly uimageBuffer order;         // which row each invocation fits
layout(binding = 5, r32ui) uniform writeonly uimageBuffer mixtures;     // a word a sensor: 1 where edges had to be told apart

#include "shaders/lib/edge_fit.glsl"
