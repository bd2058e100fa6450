#version 450
// The arithmetic that decides readings, with each operation in the form used by kernels. gpu/self_check_arithmetic.cpp
// computes the host's results for the same operands in the same order.

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer operands;  // a and b, two words each
layout(binding = 1, rgba32ui) uniform writeonly uimageBuffer results;  // ten texels per row: twenty results

void store(int row, int texel, uvec2 first, uvec2 second) { imageStore(results, 10 * row + texel, uvec4(first, second)); }

uvec2 word_of(float x) { return uvec2(floatBitsToUint(x), 0u); }

void main() {
  const int row = int(gl_GlobalInvocationID.x);
  const uvec4 words = imageLoad(operands, row);
  const double a = packDouble2x32(words.xy);
  const double b = packDouble2x32(words.zw);

  // Differences, products and quotients: rays (lib/intersect.glsl), points (lib/edge_point.glsl), fits (line_fit.h), dipoles.
  precise double sum = a + b;
  precise double difference = a - b;
  precise double product = a * b;
  precise double quotient = a / b;
  const double guarded = b != 0.0LF ? quotient : 0.0LF;
  precise double scaled = 0.9LF * a;
  precise double cross = a * b - b * scaled;
  precise double disturbed = a + b * scaled;
  precise double squares = a * a + b * b;
  precise double norm = sqrt(a * a + b * b);
  store(row, 0, unpackDouble2x32(sum), unpackDouble2x32(difference));
  store(row, 1, unpackDouble2x32(product), unpackDouble2x32(guarded));
  store(row, 2, unpackDouble2x32(cross), unpackDouble2x32(disturbed));
  store(row, 3, unpackDouble2x32(squares), unpackDouble2x32(norm));

  // Sums over a loop.
  precise double total = 0.0LF;
  precise double x = a;
  int turn = 0;
  while (turn < 8) {
    precise double term = x * b;
    total = total + term;
    x = 0.9LF * x;
    ++turn;
  }
  const double clamped = min(max(a, b), 3.0LF);
  store(row, 4, unpackDouble2x32(total), unpackDouble2x32(clamped));

  // Comparisons and NaN.
  const uint compared = (a < b ? 1u : 0u) | (a <= b ? 2u : 0u) | (a == b ? 4u : 0u) | (a > b ? 8u : 0u) | (a >= b ? 16u : 0u) |
                        (a != b ? 32u : 0u);
  const double nan = packDouble2x32(uvec2(0u, 0x7ff80000u));
  store(row, 5, uvec2(compared, 0u), unpackDouble2x32(a > b ? a : nan));

  // Conversions between 64 and 32 bits. No kernel widens a value that it has just narrowed, because compilers may
  // optimize this away.
  const float narrow = float(a);
  const float other = float(b);
  precise float turned = narrow * other - other * (0.9 * narrow);
  store(row, 6, unpackDouble2x32(double(uintBitsToFloat(words.y))), unpackDouble2x32(double(int(words.x))));
  store(row, 7, word_of(narrow), word_of(turned));

  // 32-bit roots and quotients are only initial values for a search or for one step of Newton's method in 64 bits
  // (lib/dipoles.glsl).
  precise double square = 1.0LF + a * a;
  precise float root = sqrt(max(float(square), 1e-37));
  precise float rough32 = 1.0 / root;
  precise double rough = double(rough32);
  precise double one = square * rough * rough;
  precise double inverse = rough * (1.5LF - 0.5LF * one);
  precise float half_over = 0.5 / root;
  precise double s = double(root);
  precise double refined = s + (square - s * s) * double(half_over);
  store(row, 8, unpackDouble2x32(inverse), unpackDouble2x32(refined));

  // Devices that round 32-bit roots and quotients differently compute them in 64 bits (lib/exact32.glsl).
  precise float quotient32 = narrow / other;
  store(row, 9, word_of(root), word_of(other != 0.0 ? quotient32 : 0.0));
}
