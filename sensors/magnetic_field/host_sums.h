#pragma once
// Sums of magnets' fields on the host, with the same operations in the same order as shaders/lib/dipoles.glsl, so
// results are bit-identical.

#include <cstdint>
#include <span>

#include "sensors/magnetic_field/records.h"

namespace sf::sensors {

/// Sums the fields of the magnets in `spans` at the points of one group.
/// @param points SF_FIELD_POINTS rows; only the first `count` are used
/// @param out SF_FIELD_POINTS sums without the factor mu0 / 4 pi; sums after the first `count` are undefined
void sum_fields(std::span<const MagnetSpan> spans, std::span<const DipoleRow> dipoles,
                std::span<const FieldPointRow> points, std::uint32_t count, bool magnitudes, std::span<FieldSum> out);

}  // namespace sf::sensors
