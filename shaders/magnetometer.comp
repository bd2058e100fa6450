#version 450
#extension GL_GOOGLE_include_directive : require
// The magnetometer array: the field of all magnets at every element of all due sensors, in one dispatch.

#include "shaders/sensors/magnetic_field/records.glsl"

layout(local_size_x = 32) in;
layout(constant_id = 0) const bool kMagnitudes = false;  // some sensor sums magnitudes
layout(constant_id = 1) const bool kRounds32 = true;   // device property: lib/exact32.glsl
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer items;     // FieldItem
layout(binding = 1, r32ui) uniform readonly uimageBuffer spans;        // MagnetSpan
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer dipoles;   // DipoleRow
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer places;    // FieldPointRow
layout(binding = 4, rgba32ui) uniform writeonly uimageBuffer results;  // FieldSum

#include "shaders/lib/dipoles.glsl"

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const FieldItem item = load_FieldItem(items, lane);
  FieldPointRow at[SF_FIELD_POINTS];
  precise FieldSum sums[SF_FIELD_POINTS];
  for (int i = 0; i < SF_FIELD_POINTS; ++i) {
    at[i] = load_FieldPointRow(places, SF_FIELD_POINTS * int(item.group) + i);
    sums[i] = FieldSum(0.0LF, 0.0LF, 0.0LF, 0.0LF);
  }

  // A single loop over all spans, so that lanes with short spans do not wait for others after each span.
  int at_span = int(item.first);
  MagnetSpan span = load_MagnetSpan(spans, at_span);
  int magnet = int(span.first);
  while (at_span < int(item.end)) {
    for (int k = 0; k < SF_FIELD_UNROLL; ++k) {
      const DipoleRow m = dipole_at(magnet + k, magnet + k < int(span.end));
      for (int i = 0; i < SF_FIELD_POINTS; ++i) add(m, at[i], at[0].cutoff_squared, sums[i]);
    }
    magnet += SF_FIELD_UNROLL;
    const bool done = magnet >= int(span.end);
    at_span += done ? 1 : 0;
    span = load_MagnetSpan(spans, at_span);
    magnet = done ? int(span.first) : magnet;
  }

  for (int i = 0; i < SF_FIELD_POINTS; ++i) {
    store_FieldSum(results, SF_FIELD_POINTS * int(item.sums) + i, sums[i]);
  }
}
