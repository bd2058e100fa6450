#pragma once
// Casts the rays of lane edge sensors through the road raster on the host. It performs the same operations in the same
// order as shaders/lib/raster_walk.glsl and shaders/marking_raster.comp, so results are bit-identical.

#include <cstdint>
#include <span>

#include "raycast/records.h"
#include "sensors/laneedge.h"

namespace sf::sensors {

/// The tables of a MarkingRaster.
struct RasterTables {
  std::span<const std::uint32_t> directory, blocks;
};

/// A hit of one beam.
struct RasterHit {
  double range = 0.0;     ///< [m]
  std::uint32_t tag = 0;  ///< of the surface that was hit, or SF_NO_HIT
};

/// Casts one beam and returns the nearer of the raster's hit and the cast's hit.
/// @param bearing of the beam, in the sensor frame  @param cast hit of the other surfaces
RasterHit cast_through_raster(const RasterTables& tables, const RasterRow& row, const raycast::BeamDirection& bearing,
                              const RasterHit& cast);

}  // namespace sf::sensors
