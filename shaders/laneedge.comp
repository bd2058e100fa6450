#version 450
#extension GL_GOOGLE_include_directive : require
// The lane edge sensor's fit for all due sensors, in one dispatch.

#include "shaders/sensors/laneedge.glsl"
#include "shaders/raycast/records.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;       // EdgeRow of each sensor
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer points;     // EdgePoint of each beam
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer grains;     // Grain of each pixel size
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer readings;  // EdgeReading of each sensor
layout(binding = 4, r32ui) uniform readonly uimageBuffer order;         // row that each invocation fits
layout(binding = 5, r32ui) uniform writeonly uimageBuffer mixtures;     // one word per sensor: 1 if several edges had
                                                                        // to be separated

#include "shaders/lib/edge_fit.glsl"

void main() {
  const EdgeRow row = load_EdgeRow(rows, int(imageLoad(order, int(gl_GlobalInvocationID.x)).x));
  bool mixed;
  const EdgeReading reading = fit_edge(row, mixed);
  store_EdgeReading(readings, int(row.reading), reading);
  imageStore(mixtures, int(row.reading), uvec4(mixed ? 1u : 0u));
}
