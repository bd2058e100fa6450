#version 450
// 64-bit operations whose results the host knows to the bit (gpu/self_check.cpp).

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer operands;  // a, b as two words each
layout(binding = 1, rgba32ui) uniform writeonly uimageBuffer results;  // three texels a row: six results

void main() {
  const int row = int(gl_GlobalInvocationID.x);
  const uvec4 words = imageLoad(operands, row);
  const double a = packDouble2x32(words.xy);
  const double b = packDouble2x32(words.zw);

  precise double sum = a + b;
  precise double difference = a - b;
  precise double product = a * b;
  precise double quotient = a / b;
  precise double scaled = a * 0.9LF;
  precise double other = b * scaled;
  precise double unfused = product - other;
  precise double rounded = double(float(a));

  imageStore(results, 3 * row, uvec4(unpackDouble2x32(sum), unpackDouble2x32(difference)));
  imageStore(results, 3 * row + 1, uvec4(unpackDouble2x32(product), unpackDouble2x32(quotient)));
  imageStore(results, 3 * row + 2, uvec4(unpackDouble2x32(unfused), unpackDouble2x32(rounded)));
}
