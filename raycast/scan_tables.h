#pragma once
// Tables that a host scan reads: the beams of a sensor, walls by cell, movers by place. Structures of arrays, ready for
// vectors.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "raycast/intersect.h"

namespace sf::raycast {

/// Segments side by side; more than the widest vector holds is never needed.
inline constexpr std::uint32_t kBlock = 16;

/// Segments seen from their right, in the frame of a cell or a mover. Places without one hold a segment that faces
/// nobody.
struct SegmentBlock {
  // Where all of them lie, for any viewer in the cell.
  float nearest = 0.0f;          ///< [m] at least
  float bearing = 0.0f;          ///< [rad] in the world
  float half = 4.0f;             ///< [rad] to either side of it; more than pi: all round
  float ax[kBlock], ay[kBlock];  ///< [m] start
  float ex[kBlock], ey[kBlock];  ///< [m] extent
  std::uint32_t row[kBlock];     ///< of the exact segment, from the cell's or the mover's first
};

/// Appends segments to blocks, one at a time. `rows` counts places used in the last block.
void append(std::vector<SegmentBlock>& blocks, std::uint32_t& used, glm::dvec2 a, glm::dvec2 b, std::uint32_t row);

/// The beams of one scan in the sensor's frame. Arrays are padded with copies of the last beam, so that a vector that
/// begins at any beam can be loaded.
struct ScanPattern {
  std::uint32_t beams = 0;
  float per_radian = 1.0f;                 ///< [1/rad] places of beams a radian
  float middle = 0.0f;                     ///< place of bearing 0
  float slack = 0.0f;                      ///< beam i lies at most so many places from place i
  float edge_cos = 0.0f, edge_sin = 0.0f;  ///< of the leftmost bearing, where `narrow`
  bool narrow = false;                     ///< all bearings are within 90 degrees of the heading
  float half_view = 4.0f;                  ///< [rad] largest bearing to either side, at least
  std::vector<float> place;                ///< of each beam, in units of their usual distance
  std::vector<float> cos32, sin32;
  std::vector<double> cos64, sin64;

  /// @param bearings [rad] of the beams  @param first, last of the pattern without noise
  /// @param directions64 cosine and sine of each beam, one pair of `step`
  void assign(std::span<const double> bearings, std::span<const double> directions64, double first, double last,
              std::size_t step = 1);
};

/// The outlines of movers at one height, block by block; rows are counted from the mover's first.
struct OutlineTable {
  struct Outline {
    std::uint32_t first = 0;    ///< block
    std::uint32_t outward = 0;  ///< [blocks] that a viewer outside may meet
    std::uint32_t all = 0;      ///< [blocks] with those that only a viewer inside may meet
  };
  std::vector<SegmentBlock> blocks;
  std::vector<Outline> of_mover;
};

/// Movers that can be met, by cell of a grid, one row of cells after another; arrays are padded by a block.
struct MoverGrid {
  glm::dvec2 low;      ///< [m] corner
  double cell = 1.0;   ///< [m]
  float error = 0.0f;  ///< [m] of x and y
  int columns = 1, rows = 1;
  std::vector<std::uint32_t> first;  ///< of each cell, and the end
  std::vector<std::uint32_t> mover;
  std::vector<float> x, y;    ///< [m] from `low`
  std::vector<float> radius;  ///< [m]
  double largest_radius = 0.0;

  /// Cell of a coordinate from `low` [m]; what lies beyond the grid counts as at its edge.
  int column_of(double at) const { return static_cast<int>(std::clamp(std::floor(at / cell), 0.0, columns - 1.0)); }
  int row_of(double at) const { return static_cast<int>(std::clamp(std::floor(at / cell), 0.0, rows - 1.0)); }
  /// Where the movers of a cell begin; those of the next column follow.
  std::uint32_t begin_of(int column, int row) const {
    return first[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
};

/// Where a scan looks from, and how far.
struct ScanView {
  glm::dvec2 origin;       ///< [m] world
  glm::dvec2 heading;      ///< unit vector: the pattern's bearing 0
  double yaw = 0.0;        ///< [rad] of the heading
  glm::dvec2 offset;       ///< [m] of the origin from the frame of the walls' blocks
  double range_max = 0.0;  ///< [m]
  double range_min = 0.0;  ///< [m]
  float band = 0.0f;       ///< [m] what 32 bits may be wrong by: SF_BAND times the largest coordinate
  double min_sine = 0.0;   ///< of the angle below which a beam grazes
  bool single = false;     ///< ranges are measured in 32 bits where these are close enough
  /// Unit vectors of the beams in the world, padded as the pattern's arrays are; null: the pattern's, turned by the
  /// heading.
  const double* x = nullptr;
  const double* y = nullptr;
};

/// Unit vector of beam `i` in the world. Not inline: where vectors may be fused, g++ 12 fuses this pair of products,
/// whatever -ffp-contract says.
glm::dvec2 direction_of(const ScanView& view, const ScanPattern& pattern, std::size_t i);

/// Directions are told apart by so many sectors of a turn.
inline constexpr int kSectors = 32;

/// Which blocks of a cell, of 64 at most, lie ahead in each sector: a bit each.
using SectorBlockMasks = std::array<std::uint64_t, kSectors>;

/// Surfaces that there are to meet. Exact segments: walls first, then the movers'.
struct ScanScene {
  /// Walls that face the cell, near to far; then those that face away from all of it, which decide ties at corners.
  std::span<const SegmentBlock> walls;
  std::size_t front_facing = 0;                   ///< [blocks]
  const SectorBlockMasks* block_masks = nullptr;  ///< of `walls`, where they are at most 64 blocks
  std::span<const ExactSegment> exact;            ///< of walls, then of movers
  std::span<const std::uint32_t> models;          ///< of each
  const MoverGrid* movers = nullptr;
  const OutlineTable* outlines = nullptr;
  std::span<const base::Pose> poses;          ///< of movers
  std::span<const glm::dvec2> headings;       ///< of movers: unit vectors
  std::span<const std::uint32_t> first_rows;  ///< of each mover's exact segments, and the end
  std::uint32_t self = 0xFFFFFFFFu;           ///< mover that is not met
};

/// Where a scan's results go: one a beam.
struct ScanOutput {
  double* ranges;         ///< [m]
  std::uint32_t* models;  ///< of what was met, or SF_NO_HIT
  std::uint8_t* grazes;   ///< 1 where it was met at less than the least sine
};

/// Work of scans, counted.
struct ScanCounts {
  std::uint64_t uncertain = 0;        ///< beams that 32 bits could not prove
  std::uint64_t movers_in_range = 0;  ///< discs in reach and in view
  std::uint64_t movers_visible = 0;   ///< of these, not hidden
};

}  // namespace sf::raycast
