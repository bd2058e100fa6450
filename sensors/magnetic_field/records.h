#ifndef SENSORS_MAGNETIC_FIELD_RECORDS_H
#define SENSORS_MAGNETIC_FIELD_RECORDS_H
// What host and device agree on about summing the fields of magnets. Read by both compilers.
//
// An item is one lane's work: up to SF_FIELD_PLACES places that lie together, and a run of spans of magnets. Each
// magnet that is loaded serves all of its places.

#define SF_FIELD_POINTS 5  // as many as the thesis' array has elements
#define SF_FIELD_UNROLL 2  // magnets per turn of the loop

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

/// A magnet as the kernel sees it: two texels.
struct DipoleRow {
  double x, y, z;        ///< [m] world
  float moment;          ///< [A m^2]; 0: nothing
  float inverse_radius;  ///< [1/m] nearer than the radius the field is what it is there
};
static_assert(sizeof(DipoleRow) == 32);

/// Where the field is wanted: two texels.
struct FieldPointRow {
  double x, y, z;         ///< [m] world
  double cutoff_squared;  ///< [m^2] magnets farther away along the ground are left out; of an item's first place
};
static_assert(sizeof(FieldPointRow) == 32);

/// What a lane sums: one texel.
struct FieldItem {
  std::uint32_t first;  ///< span
  std::uint32_t end;    ///< span behind the last one
  std::uint32_t group;  ///< of SF_FIELD_PLACES places
  std::uint32_t out;    ///< of SF_FIELD_PLACES results
};
static_assert(sizeof(FieldItem) == 16);

/// Magnets that lie together in their table: two words.
struct MagnetSpan {
  std::uint32_t first;
  std::uint32_t end;  ///< behind the last one; > first
};
static_assert(sizeof(MagnetSpan) == 8);

/// The field of an item's magnets at one of its places, world frame: two texels. The device leaves out the factor
/// mu0 / 4 pi.
struct FieldSum {
  double x = 0.0, y = 0.0, z = 0.0;  ///< [T]
  double magnitudes = 0.0;           ///< [T] sum of the magnets' own magnitudes; 0 unless asked for
};
static_assert(sizeof(FieldSum) == 32);

}  // namespace sf::sensors

#endif
#endif
