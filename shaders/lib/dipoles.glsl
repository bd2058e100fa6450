// Fields of magnets at the points of an item: the whole kernel. With SF_MAGNITUDES also the sum of their magnitudes.
//
// A point dipole of moment m along +z, with r from dipole to point and u = r / |r|, without the factor mu0 / 4 pi,
// which the host applies:
//   B = m / |r|^3 (3 u_z u - e_z),  |B| = m / |r|^3 sqrt(1 + 3 u_z^2)   (the thesis' equation 1, without its differences)
// Differences of positions have 64 bits. 1 / |r| is a 32-bit root and one step of Newton's method in 64 bits, which
// doubles its 23 bits: a 64-bit root and division cost four times as much. Every operation is `precise` and in a fixed
// order: host and device results are equal bit by bit.

#include "sensors/magnetic_field/records.h"

layout(local_size_x = 32) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer items;     // FieldItem
layout(binding = 1, r32ui) uniform readonly uimageBuffer spans;        // MagnetSpan
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer dipoles;   // DipoleRow
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer places;    // FieldPointRow
layout(binding = 4, rgba32ui) uniform writeonly uimageBuffer results;  // FieldSum

// At the exact centre of a magnet, the field is that straight above it.
#define SF_ABOVE 1e-18LF
// [m^2] least square with a finite 32-bit inverse root.
#define SF_LEAST 1e-37

struct Place {
  double x, y, z;
};

struct Sum {
  double x, y, z, magnitudes;
};

struct Dipole {
  double x, y, z, moment, inverse_radius;
};

Dipole dipole_at(int row, bool counts) {
  const uvec4 p = imageLoad(dipoles, 2 * row);
  const uvec4 q = imageLoad(dipoles, 2 * row + 1);
  const float moment = counts ? uintBitsToFloat(q.z) : 0.0;
  return Dipole(packDouble2x32(p.xy), packDouble2x32(p.zw), packDouble2x32(q.xy), double(moment),
                double(uintBitsToFloat(q.w)));
}

void add(Dipole m, Place p, double cutoff_squared, inout Sum sum) {
  precise double dx = p.x - m.x;
  precise double dy = p.y - m.y;
  precise double dz = (p.z - m.z) + SF_ABOVE;
  precise double along = dx * dx + dy * dy;
  precise double squared = along + dz * dz;

  precise float root = sqrt(max(float(squared), SF_LEAST));
  precise float rough32 = 1.0 / root;
  precise double rough = double(rough32);
  precise double one = squared * rough * rough;
  precise double inverse = rough * (1.5LF - 0.5LF * one);
  precise double bounded = inverse < m.inverse_radius ? inverse : m.inverse_radius;
  precise double scale = m.moment * bounded * (bounded * bounded);
  scale = along <= cutoff_squared ? scale : 0.0LF;

  precise double uz = dz * inverse;
  precise double c = 3.0LF * uz * scale * inverse;
  precise double bx = c * dx;
  precise double by = c * dy;
  precise double bz = c * dz - scale;
  sum.x += bx;
  sum.y += by;
  sum.z += bz;
#ifdef SF_MAGNITUDES
  precise double q = 1.0LF + 3.0LF * uz * uz;
  precise float rough_q = sqrt(float(q));
  precise float half_over = 0.5 / rough_q;
  precise double s = double(rough_q);
  precise double shape = s + (q - s * s) * double(half_over);
  precise double magnitude = abs(scale) * shape;
  sum.magnitudes += magnitude;
#endif
}

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const uvec4 item = imageLoad(items, lane);
  const int first = SF_FIELD_POINTS * int(item.z);
  const double cutoff_squared = packDouble2x32(imageLoad(places, 2 * first + 1).zw);
  Place at[SF_FIELD_POINTS];
  precise Sum sums[SF_FIELD_POINTS];
  for (int i = 0; i < SF_FIELD_POINTS; ++i) {
    const uvec4 p = imageLoad(places, 2 * (first + i));
    const uvec4 q = imageLoad(places, 2 * (first + i) + 1);
    at[i] = Place(packDouble2x32(p.xy), packDouble2x32(p.zw), packDouble2x32(q.xy));
    sums[i] = Sum(0.0LF, 0.0LF, 0.0LF, 0.0LF);
  }

  // One loop over all spans, so that lanes with short spans do not wait for others at each of them.
  int span = int(item.x);
  const int end = int(item.y);
  int magnet = int(imageLoad(spans, 2 * span).x);
  int last = int(imageLoad(spans, 2 * span + 1).x);
  while (span < end) {
    for (int k = 0; k < SF_FIELD_UNROLL; ++k) {
      const Dipole m = dipole_at(magnet + k, magnet + k < last);
      for (int i = 0; i < SF_FIELD_POINTS; ++i) add(m, at[i], cutoff_squared, sums[i]);
    }
    magnet += SF_FIELD_UNROLL;
    const bool done = magnet >= last;
    span += done ? 1 : 0;
    magnet = done ? int(imageLoad(spans, 2 * span).x) : magnet;
    last = done ? int(imageLoad(spans, 2 * span + 1).x) : last;
  }

  for (int i = 0; i < SF_FIELD_POINTS; ++i) {
    const int out_row = 2 * (SF_FIELD_POINTS * int(item.w) + i);
    imageStore(results, out_row, uvec4(unpackDouble2x32(sums[i].x), unpackDouble2x32(sums[i].y)));
    imageStore(results, out_row + 1, uvec4(unpackDouble2x32(sums[i].z), unpackDouble2x32(sums[i].magnitudes)));
  }
}
