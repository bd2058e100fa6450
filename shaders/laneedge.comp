#version 450
#extension GL_GOOGLE_include_directive : require
// The lane edge sensor's fit for all due sensors, in one dispatch.

#include "sensors/laneedge.h"
#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;       // SF_EDGE_TEXELS per sensor: EdgeRow
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer points;     // one texel per beam: x, y [m], pixel size in the last bits of x
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer grains;     // one texel per pixel size [m]
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer readings;  // SF_READING_TEXELS per sensor: EdgeReading
layout(binding = 4, r32ui) uniform readonly uimageBuffer order;         // row that each invocation fits
layout(binding = 5, r32ui) uniform writeonly uimageBuffer mixtures;     // one word per sensor: 1 where several edges had to be separated

#include "shaders/lib/edge_fit.glsl"
