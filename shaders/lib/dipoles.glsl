// Computes the field of a magnet, and with kMagnitudes also its magnitude. The kernel declares the table dipoles.
//
// A point dipole has the moment m along +z. With r from dipole to point and u = r / |r|, and without the factor mu0 / 4
// pi, which the host applies:
//   B = m / |r|^3 (3 u_z u - e_z),  |B| = m / |r|^3 sqrt(1 + 3 u_z^2)   (the thesis' equation 1, without its
//   differences)
// Differences of positions use 64 bits. 1 / |r| is a 32-bit root followed by one step of Newton's method in 64 bits,
// which doubles its 23 bits; a 64-bit root and division cost four times as much. Every operation is `precise` and in a
// fixed order, so host and device results are equal bit by bit.

// At the exact centre of a magnet, use the field straight above it.
#define SF_ABOVE 1e-18LF
// [m^2] smallest square with a finite 32-bit inverse root.
#define SF_LEAST 1e-37

#include "shaders/lib/exact32.glsl"

DipoleRow dipole_at(int row, bool counts) {
  DipoleRow m = load_DipoleRow(dipoles, row);
  m.moment = counts ? m.moment : 0.0;
  return m;
}

void add(DipoleRow m, FieldPointRow p, double cutoff_squared, inout FieldSum sum) {
  precise double dx = p.x - m.x;
  precise double dy = p.y - m.y;
  precise double dz = (p.z - m.z) + SF_ABOVE;
  precise double along = dx * dx + dy * dy;
  precise double squared = along + dz * dz;

  precise float root = root32(max(float(squared), SF_LEAST));
  precise float rough32 = quotient32(1.0, root);
  precise double rough = double(rough32);
  precise double one = squared * rough * rough;
  precise double inverse = rough * (1.5LF - 0.5LF * one);
  precise double bounded = inverse < double(m.inverse_radius) ? inverse : double(m.inverse_radius);
  precise double scale = double(m.moment) * bounded * (bounded * bounded);
  scale = along <= cutoff_squared ? scale : 0.0LF;

  precise double uz = dz * inverse;
  precise double c = 3.0LF * uz * scale * inverse;
  precise double bx = c * dx;
  precise double by = c * dy;
  precise double bz = c * dz - scale;
  sum.x += bx;
  sum.y += by;
  sum.z += bz;
  if (kMagnitudes) {
    precise double q = 1.0LF + 3.0LF * uz * uz;
    precise float rough_q = root32(float(q));
    precise float half_over = quotient32(0.5, rough_q);
    precise double s = double(rough_q);
    precise double shape = s + (q - s * s) * double(half_over);
    precise double magnitude = abs(scale) * shape;
    sum.magnitudes += magnitude;
  }
}
