#version 450
#extension GL_GOOGLE_include_directive : require
// Elementary functions of kernels, for robots/device/elementary_test.cpp.

#include "shaders/lib/elementary64.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer angles;   // a double per row, in the first two words
layout(binding = 1, rgba32ui) uniform writeonly uimageBuffer results;  // five texels per row: ten results

void store(int row, int texel, double first, double second) {
  imageStore(results, 5 * row + texel, uvec4(unpackDouble2x32(first), unpackDouble2x32(second)));
}

void main() {
  const int row = int(gl_GlobalInvocationID.x);
  const double x = packDouble2x32(imageLoad(angles, row).xy);
  const dvec2 s = sin_cos64(x);
  store(row, 0, s.x, s.y);
  store(row, 1, sinc64(x), wrap_angle64(x));
  store(row, 2, nearest64(x), ceil64(abs(x)));
  store(row, 3, log64(most(abs(x), 1e-300LF)), with_sign(1.0LF, x));
  store(row, 4, arc_tangent64(x, 0.7LF), arc_tangent64(-0.3LF, x));
}
