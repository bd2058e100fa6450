#ifndef SENSORS_MAGNETIC_FIELD_RECORDS_H
#define SENSORS_MAGNETIC_FIELD_RECORDS_H
// Records of sums of magnets' fields, for host and device. cmake/records.awk generates the kernels' accessors.
//
// An item is the work of one lane: a group of up to SF_FIELD_POINTS neighbouring points, and a run of spans of magnets.
// Each magnet is loaded once for all points of the group.

#define SF_FIELD_POINTS 5  // the number of elements of the thesis' array
#define SF_FIELD_UNROLL 2  // magnets per loop iteration

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

/// A magnet for the kernel: two texels.
struct DipoleRow {
  double x, y, z;        ///< [m] world
  float moment;          ///< [A m^2]; 0: no field
  float inverse_radius;  ///< [1/m] within the radius, the field is that at the radius
};

/// A point of a group.
struct FieldPointRow {
  double x, y, z;         ///< [m] world
  double cutoff_squared;  ///< [m^2] magnets farther away along the ground are ignored; read from the group's first
                          ///< point
};

/// Work of one lane.
struct FieldItem {
  std::uint32_t first;  ///< first span
  std::uint32_t end;    ///< end of the spans, exclusive
  std::uint32_t group;  ///< index of the group of SF_FIELD_POINTS points
  std::uint32_t sums;   ///< index of the group of SF_FIELD_POINTS results
};

/// A contiguous range of magnets in their table: two words.
struct MagnetSpan {
  std::uint32_t first;
  std::uint32_t end;  ///< exclusive; > first
};

/// The field of an item's magnets at one of its points, in the world frame: two texels. The device omits the factor mu0
/// / 4 pi.
struct FieldSum {
  double x = 0.0, y = 0.0, z = 0.0;  ///< [T]
  double magnitudes = 0.0;           ///< [T] sum of the magnitudes of the magnets' fields; 0 unless requested
};

}  // namespace sf::sensors

#endif
#endif
