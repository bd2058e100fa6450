#pragma once
// Beams of a sensor, grouped for the rasterizer. A pattern is built once per sensor type and shared by its sensors.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <span>
#include <vector>

#include "scene/surface_tree.h"

namespace sf::scene {

inline constexpr std::uint32_t kTileVectors = 32;  ///< a multiple of 16
inline constexpr std::uint32_t kTileBeams = kTileVectors * kWidth;

/// Boxes of directions, each a parallelogram in the plane that touches the unit sphere at its axis, which contains the
/// beams' intersections with this plane. Directions inside are c + a U + b V, |a| and |b| <= 1; beams are those scaled
/// by at most 1. Side k: the half space plane[k] . d >= 0. In structure-of-arrays layout, coordinate by coordinate.
template <std::uint32_t count>
struct DirectionBoxes {
  alignas(64) float box[9][count];     ///< c, U, V
  alignas(64) float plane[12][count];  ///< unit normals of the four sides
  alignas(64) float axis[3][count];    ///< unit vectors
};

/// Beams that are cast together, in vectors of 16. Vectors that are not full repeat their last beam.
struct alignas(64) BeamTile {
  alignas(64) float x[kTileBeams], y[kTileBeams], z[kTileBeams];      ///< unit vectors in the sensor's frame
  alignas(64) double dx[kTileBeams], dy[kTileBeams], dz[kTileBeams];  ///< the same in double
  alignas(64) std::uint32_t place[kTileBeams];                        ///< index of the beam in the scan
  DirectionBoxes<kTileVectors> vectors;                               ///< boxes of the vectors
  DirectionBoxes<1> tile;                                             ///< box of all
  float longest = 1.0f;    ///< largest norm of a direction in any of the boxes
  std::uint32_t run = 1;   ///< 16, 4 or 1: groups of so many beams of each vector follow each other in the scan
  std::uint32_t used = 0;  ///< vectors, in [1, kTileVectors]; the others repeat the last one and are not cast
  double time = 0.0;       ///< [s] of all of its beams, relative to the reading
};

using BeamPattern = std::vector<BeamTile>;

/// @param directions unit vectors to rounding, in the sensor's frame, in the order of the scan; 1 to 2^24
/// @param row the beams of a vector should be neighbours in the scan if `row` of them follow each other at one
///            elevation (a lidar's ring); 0: vectors should be square
/// @param times [s] of the beams relative to the reading, those of a tile are equal; empty: all 0
BeamPattern make_pattern(std::span<const glm::dvec3> directions, std::uint32_t row, std::span<const double> times = {});

/// Pattern of an image: tiles of 32 x 16 pixels, vectors of 4 x 4.
/// @param directions as make_pattern's, row by row  @param width [px]
BeamPattern make_image_pattern(std::span<const glm::dvec3> directions, std::uint32_t width);

/// Least cosine of the angle between the first and any other beam of fill_tile.
inline constexpr double kLeastTileCosine = 0.9;
/// Fills a tile with beams, in their order: sixteen after each other are a vector, and their places are their numbers.
/// Boxes of unused vectors have no meaning. For beams that are cast once: much faster than make_pattern.
/// @param directions unit vectors of 1 to kTileBeams neighbours  @param time [s] of all
void fill_tile(std::span<const glm::dvec3> directions, double time, BeamTile& tile);

}  // namespace sf::scene
