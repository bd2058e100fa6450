#version 450
#extension GL_GOOGLE_include_directive : require
// Sonar: the nearest surface that returns an echo in each cone, for all firing transducers, in one dispatch.

#include "sensors/cones/records.h"
#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer cones;       // SF_CONE_TEXELS per cone: ConeRow
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer ranges;      // two texels per lane: four doubles [m]
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer hits;        // one texel per lane: rows of reflectors, or models
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer echoes;     // one texel per cone: ConeEcho
layout(binding = 4, rgba32ui) uniform readonly uimageBuffer directions;  // one texel per beam: cosine and sine of its bearing
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer reflectors;       // one texel per surface: ReflectorDirection
layout(binding = 6, rgba32f) uniform readonly imageBuffer headings;      // one texel per mover, the first for static surfaces: cosine, sine

vec2 turned(vec2 by, vec2 v) {
  precise float x = by.x * v.x - by.y * v.y;
  precise float y = by.x * v.y + by.y * v.x;
  return vec2(x, y);
}

// At a flat angle of incidence a smooth surface reflects sound away from the sonar.
bool returns_echo(int beam, uint hit, vec2 heading, float min_cosine) {
  const bool any = min_cosine <= 0.0;
  const uvec4 bearing = imageLoad(directions, beam);
  const uvec4 face = imageLoad(reflectors, any || hit == SF_NO_HIT ? 0 : int(hit));
  const vec2 look = turned(heading, vec2(float(packDouble2x32(bearing.xy)), float(packDouble2x32(bearing.zw))));
  const vec2 along = turned(imageLoad(headings, int(face.z)).xy, uintBitsToFloat(face.xy));
  precise float cosine = look.x * along.y - look.y * along.x;
  return any || abs(cosine) >= min_cosine;
}

#include "shaders/lib/cone.glsl"
