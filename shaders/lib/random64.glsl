// base/random.h in kernels: Philox 4x32-10 and normal numbers. Needs elementary64.glsl.

uvec4 philox(uvec4 counter, uvec2 key) {
  for (int round = 0; round < 10; ++round) {
    uint high_0, low_0, high_1, low_1;
    umulExtended(0xD2511F53u, counter.x, high_0, low_0);
    umulExtended(0xCD9E8D57u, counter.z, high_1, low_1);
    counter = uvec4(high_1 ^ counter.y ^ key.x, low_1, high_0 ^ counter.w ^ key.y, low_0);
    key += uvec2(0x9E3779B9u, 0xBB67AE85u);
  }
  return counter;
}

/// Returns a uniform number in (0, 1).
double open_unit(uint high, uint low) {
  precise double bits = double(high) * 2097152.0LF + double(low >> 11);
  precise double u = (bits + 0.5LF) * 1.1102230246251565e-16LF;  // 2^-53
  return u;
}

/// Returns the first normal number of base::random_normal.
double random_normal(uvec4 counter, uvec2 key, double sigma) {
  const uvec4 words = philox(counter, key);
  const double u = open_unit(words.x, words.y), v = open_unit(words.z, words.w);
  precise double radius = sigma * sqrt(-2.0LF * log64(u));
  precise double angle = 2.0LF * SF_PI * v;
  precise double x = radius * sin_cos64(angle).y;
  return x;
}
