#version 450
// Counts to n in one loop, and in two loops of n / 2, to detect a driver's limit on loops.

layout(local_size_x = 64) in;
layout(binding = 0, r32ui) uniform readonly uimageBuffer counts;
layout(binding = 1, rgba32ui) uniform writeonly uimageBuffer sums;  // one loop, two loops

void main() {
  const int row = int(gl_GlobalInvocationID.x);
  const uint n = imageLoad(counts, row).x;
  uint one = 0u;
  for (uint i = 0u; i < n; ++i) one += imageLoad(counts, row).x == n ? 1u : 2u;
  uint two = 0u;
  for (uint i = 0u; i < n / 2u; ++i) two += imageLoad(counts, row).x == n ? 1u : 2u;
  for (uint i = n / 2u; i < n; ++i) two += imageLoad(counts, row).x == n ? 1u : 2u;
  imageStore(sums, row, uvec4(one, two, 0u, 0u));
}
