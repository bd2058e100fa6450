#pragma once
// Sums of magnetic fields in plain C++: the kernel's arithmetic on tables laid out for vectorization.

#include <span>
#include <vector>

#include "sensors/magnetic_field/magnet_grid.h"
#include "world/world.h"

namespace sf::bench {

/// Magnets in the order of their grid's cells, one array per quantity, padded with magnets of zero moment.
struct MagnetColumns {
  sensors::MagnetGrid grid;
  double cutoff = 0.0;                 ///< [m] 0: none
  std::vector<double> x, y, z;         ///< [m]
  std::vector<double> moment;          ///< [A m^2]
  std::vector<double> inverse_radius;  ///< [1/m]
};

MagnetColumns make_columns(const world::World& world);

struct FieldVector {
  double x, y, z;  ///< [T]
};

/// Sums the fields of the magnets in `spans` at one point.
using SumField = FieldVector (*)(const MagnetColumns& magnets, std::span<const sensors::MagnetSpan> spans, double x,
                                 double y, double z);

/// One source compiled twice: for any x86-64 processor, and for the build machine with all its vector instructions,
/// fused and at full width.
FieldVector sum_portable(const MagnetColumns& magnets, std::span<const sensors::MagnetSpan> spans, double x, double y,
                         double z);
FieldVector sum_native(const MagnetColumns& magnets, std::span<const sensors::MagnetSpan> spans, double x, double y,
                       double z);

}  // namespace sf::bench
