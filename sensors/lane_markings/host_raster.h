#pragma once
// The rays of lane edge sensors through the road raster on the host, with the same operations in the same order as
// shaders/lib/raster_walk.glsl and shaders/marking_raster.comp: the bytes are the same.

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
  std::uint32_t tag = 0;  ///< of the surface that was met, or SF_NO_HIT
};

/// Casts one beam: the nearer of the raster's hit and the hit of the cast counts.
/// @param bearing of the beam, in the sensor frame  @param cast of the other surfaces
RasterHit cast_through_raster(const RasterTables& tables, const RasterRow& row, const raycast::BeamDirection& bearing,
                              const RasterHit& cast);

}  // namespace sf::sensors
