// 32-bit roots and quotients as IEEE 754 rounds them. Vulkan allows devices errors of a few last places; where the
// self-check found such (gpu::Device::rounds32), they are computed in 64 bits, whose results round to the same.
// The kernel declares the specialization constant kRounds32.

// x, as 32 bits. Mesa 25.0 takes double(float(x)) for x; the number of workgroups along z, always one, keeps it from
// seeing both conversions.
float kept(float x) { return uintBitsToFloat(floatBitsToUint(x) + (gl_NumWorkGroups.z - 1u)); }

float root32(float x) {
  precise float root = kRounds32 ? sqrt(x) : kept(float(sqrt(double(kept(x)))));
  return root;
}

float quotient32(float a, float b) {
  precise float quotient = kRounds32 ? a / b : kept(float(double(kept(a)) / double(kept(b))));
  return quotient;
}
