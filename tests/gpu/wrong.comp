#version 450
// A wrong self-check kernel: writes only the sum, computed in 32 bits.

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer operands;
layout(binding = 1, rgba32ui) uniform writeonly uimageBuffer results;

void main() {
  const int row = int(gl_GlobalInvocationID.x);
  const uvec4 words = imageLoad(operands, row);
  const float sum = float(packDouble2x32(words.xy)) + float(packDouble2x32(words.zw));
  imageStore(results, 9 * row, uvec4(unpackDouble2x32(double(sum)), 0u, 0u));
}
