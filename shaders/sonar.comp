#version 450
#extension GL_GOOGLE_include_directive : require
// Sonar: the nearest surface that returns an echo in each cone, for all firing transducers, in one dispatch.

#include "shaders/raycast/records.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer cones;       // ConeRow of each cone
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer ranges;      // LaneRanges of each lane
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer hits;        // LaneHits of each lane: rows of faces, or models
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer echoes;     // ConeEcho of each cone
layout(binding = 4, rgba32ui) uniform readonly uimageBuffer directions;  // BeamDirection of each beam
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer reflectors;  // ReflectorDirection of each surface
layout(binding = 6, rgba32f) uniform readonly imageBuffer headings;      // one texel per mover, the first for static
                                                                         // surfaces: cosine, sine

vec2 turned(vec2 by, vec2 v) {
  precise float x = by.x * v.x - by.y * v.y;
  precise float y = by.x * v.y + by.y * v.x;
  return vec2(x, y);
}

// At a flat angle of incidence, a smooth surface reflects sound away from the sonar.
bool returns_echo(int beam, uint hit, vec2 heading, float min_cosine) {
  const bool any = min_cosine <= 0.0;
  const BeamDirection bearing = load_BeamDirection(directions, beam);
  const ReflectorDirection face = load_ReflectorDirection(reflectors, any || hit == SF_NO_HIT ? 0 : int(hit));
  const vec2 look = turned(heading, vec2(float(bearing.cos), float(bearing.sin)));
  const vec2 along = turned(imageLoad(headings, int(face.heading)).xy, vec2(face.along_x, face.along_y));
  precise float cosine = look.x * along.y - look.y * along.x;
  return any || abs(cosine) >= min_cosine;
}

#include "shaders/lib/cone.glsl"

void main() { write_echo(int(gl_GlobalInvocationID.x)); }
