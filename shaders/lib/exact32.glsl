// 32-bit roots and quotients rounded as IEEE 754 requires. Vulkan allows errors of a few ulps. If the self-check found
// such errors (gpu::Device::rounds32), they are computed in 64 bits and rounded to the same results.
// The kernel declares the specialization constant kRounds32.

// Returns x, rounded to 32 bits. Mesa 25.0 simplifies double(float(x)) to x. Adding the number of workgroups along z
// minus one, which is always 0, prevents this.
float kept(float x) { return uintBitsToFloat(floatBitsToUint(x) + (gl_NumWorkGroups.z - 1u)); }

float root32(float x) {
  precise float root = kRounds32 ? sqrt(x) : kept(float(sqrt(double(kept(x)))));
  return root;
}

float quotient32(float a, float b) {
  precise float quotient = kRounds32 ? a / b : kept(float(double(kept(a)) / double(kept(b))));
  return quotient;
}
