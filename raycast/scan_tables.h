#pragma once
// Tables that a host scan reads: beams of a sensor, walls by cell, movers by position. They are structures of arrays,
// for vector instructions.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/report.h"
#include "raycast/intersect.h"
#include "world/copies.h"

namespace sf::raycast {

/// Segments per block: the number of floats in the widest vector.
inline constexpr std::uint32_t kBlock = 16;

/// Segments that are visible from their right, in the frame of a cell or a mover. Unused places contain a segment that
/// faces away from every viewer.
struct alignas(64) SegmentBlock {
  float ax[kBlock], ay[kBlock];  ///< [m] start
  float ex[kBlock], ey[kBlock];  ///< [m] extent
  std::uint32_t row[kBlock];     ///< exact segment, relative to the first one of the cell or the mover
};

/// Bounds of all segments of a block for any viewer in its cell.
struct BlockBounds {
  float nearest;  ///< [m] lower bound
  float bearing;  ///< [rad] in the world
  float half;     ///< [rad] to either side of `bearing`; > pi: all directions
};

inline void prefetch(const void* first, std::size_t bytes) {
  for (std::size_t byte = 0; byte < bytes; byte += 64) __builtin_prefetch(static_cast<const char*>(first) + byte);
}

/// Makes the segments with rows in [first, end) invisible.
void hide_rows(std::span<SegmentBlock> blocks, std::uint32_t first, std::uint32_t end);

/// Appends one segment. @param used number of places in use in the last block
void append(std::vector<SegmentBlock>& blocks, std::uint32_t& used, glm::dvec2 a, glm::dvec2 b, std::uint32_t row);

/// The beams of one scan in the sensor frame. Arrays are padded with copies of the last beam, so a full vector can be
/// loaded at any beam.
struct ScanPattern {
  std::uint32_t beams = 0;
  float per_radian = 1.0f;                 ///< [1/rad] places per radian
  float middle = 0.0f;                     ///< place of bearing 0
  float slack = 0.0f;                      ///< [places] largest distance of beam i from place i
  float edge_cos = 0.0f, edge_sin = 0.0f;  ///< of the leftmost bearing, where `narrow`
  bool narrow = false;                     ///< all bearings are within 90 degrees of the heading
  float half_view = 4.0f;                  ///< [rad] upper bound of the bearing to either side
  std::vector<float> place;                ///< position of each beam, in units of the mean spacing
  std::vector<float> cos32, sin32;
  std::vector<double> cos64, sin64;

  /// @param bearings [rad] of the beams  @param first, last bearings [rad] of the pattern without noise
  /// @param directions64 cosine and sine of each beam: every `step`-th pair
  void assign(std::span<const double> bearings, std::span<const double> directions64, double first, double last,
              std::size_t step = 1);
};

/// Outlines of movers, in blocks: one per shape and slice of heights. Rows are relative to the mover's first segment.
struct OutlineTable {
  struct Outline {
    std::uint32_t first = 0;       ///< index of the first block
    std::uint32_t outward = 0;     ///< [blocks] visible from outside; they contain every edge
    std::uint32_t all = 0;         ///< [blocks] including those visible only from inside
    std::uint32_t first_edge = 0;  ///< in `edges`
    std::uint32_t edges = 0;
    std::uint32_t first_loop = 0;  ///< in `loops`
    std::uint32_t loops = 0;
  };
  /// A closed convex outline, solid inside.
  struct Loop {
    std::uint32_t first, count;  ///< its edges: consecutive rows
  };
  /// Heights between which the outline of a shape is constant.
  struct Slice {
    double z_max;  ///< [m] above the mover's origin, exclusive; the last slice of a shape has no upper end
    Outline outline;
  };
  struct Shape {
    std::uint32_t first, slices;  ///< ascending; the first and the last slice are empty
  };
  std::vector<SegmentBlock> blocks;
  std::vector<std::uint32_t> edges;  ///< rows
  std::vector<Loop> loops;
  std::vector<Slice> slices;
  std::vector<Shape> of_mover;

  /// Returns the slice of `mover` at height `z` [m] above its origin, relative to its first one.
  std::uint32_t slice_of(std::uint32_t mover, double z) const {
    const Shape& shape = of_mover[mover];
    std::uint32_t i = 0;
    while (i + 1 < shape.slices && z >= slices[shape.first + i].z_max) ++i;
    return i;
  }
  const Outline& at(std::uint32_t mover, double z) const {
    return slices[of_mover[mover].first + slice_of(mover, z)].outline;
  }
};

inline constexpr std::uint32_t kNoMover = 0xFFFFFFFFu;
inline constexpr std::uint32_t kCrowd = 8;  ///< [movers] at one place; a larger number rarely fits without overlaps

/// Movers with outlines, sorted by cell of a grid in row-major order. Arrays are padded by a block. If the outlines of
/// several movers in a crowd are bit-identical, the grid contains only the first two: hits on coincident surfaces
/// report the first one in the world's table, or the second one for scans by the first.
struct MoverGrid {
  glm::dvec2 low;             ///< [m] corner
  double cell = 1.0;          ///< [m]
  float error = 0.0f;         ///< [m] error of x and y
  int columns = 1, rows = 1;  ///< per copy of the world; the copies follow each other
  world::CopyIndex copies;
  std::vector<std::uint32_t> first;  ///< first mover of each cell, and the end
  std::vector<std::uint32_t> mover;
  std::vector<std::uint32_t> twin;  ///< an earlier mover with the same outline; kNoMover: none
  std::vector<float> x, y;          ///< [m] from `low`
  std::vector<float> radius;        ///< [m]
  std::vector<float> inner;         ///< [m] distance of the nearest edge from the mover's origin
  double largest_radius = 0.0;

  /// Returns whether the mover at `at` is invisible to a sensor of mover `self` or hidden by its twin.
  bool skips(std::uint32_t at, std::uint32_t self) const {
    return mover[at] == self || (twin[at] != kNoMover && twin[at] != self);
  }

  /// Returns the cell of a coordinate relative to `low` [m], clamped to the grid of the copy.
  int column_of(double at) const { return static_cast<int>(std::clamp(std::floor(at / cell), 0.0, columns - 1.0)); }
  int row_of(double at, std::uint32_t copy) const {
    return static_cast<int>(copy) * rows + static_cast<int>(std::clamp(std::floor(at / cell), 0.0, rows - 1.0));
  }
  /// Returns the index of the first mover of a cell. The movers of the next column follow.
  std::uint32_t begin_of(int column, int row) const {
    return first[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
};

/// Pose and range of a scan.
struct ScanView {
  glm::dvec2 origin;       ///< [m] world
  glm::dvec2 heading;      ///< unit vector: bearing 0 of the pattern
  double yaw = 0.0;        ///< [rad] of the heading
  double range_max = 0.0;  ///< [m]
  double range_min = 0.0;  ///< [m]
  float band = 0.0f;       ///< [m] error of 32-bit coordinates: SF_COORDINATE_ERROR times the largest coordinate
  double min_sine = 0.0;   ///< sine of the angle below which a beam grazes
  bool single = false;     ///< computes ranges in 32 bits where these are accurate enough
  /// Unit vectors of the beams in the world frame, padded like the pattern's arrays. Null: the pattern's vectors are
  /// rotated by the heading.
  const double* x = nullptr;
  const double* y = nullptr;
};

/// Returns the unit vector of beam `i` in the world frame. Not inline, because g++ 12 fuses this pair of products in
/// functions that may use fused instructions, regardless of -ffp-contract.
glm::dvec2 direction_of(const ScanView& view, const ScanPattern& pattern, std::size_t i);

/// Surfaces around a cell.
struct CellBlocks {
  /// Front-facing blocks, near to far, then back-facing ones, which are needed only for ties at corners.
  std::span<const SegmentBlock> blocks;
  std::uint32_t front_facing = 0;       ///< [blocks]
  const BlockBounds* bounds = nullptr;  ///< of `blocks`, padded by kBlock
  glm::dvec2 offset;                    ///< [m] the viewer relative to the cell's centre
};

class BearingIndex;

/// All surfaces of a scan. Exact segments: walls first, then movers.
struct ScanScene {
  CellBlocks walls;
  CellBlocks crowd;                              ///< of movers that contain the viewer (raycast/crowds.h)
  const BearingIndex* crowd_index = nullptr;     ///< replaces the blocks of `crowd`; includes the viewer's own edges
  std::span<const std::uint64_t> crowd_members;  ///< one bit per mover with edges in `crowd`; empty: no crowd
  double crowd_horizon = HUGE_VAL;               ///< [m] every beam meets an edge of the crowd within this distance
  std::span<const ExactSegment> exact;           ///< walls, then movers
  std::span<const std::uint32_t> models;         ///< `Segment::model` of each
  const MoverGrid* movers = nullptr;
  const OutlineTable* outlines = nullptr;
  double z = 0.0;                             ///< [m] world height of the beams
  std::span<const base::Report> states;       ///< of movers
  std::span<const glm::dvec2> headings;       ///< of movers: unit vectors
  std::span<const std::uint32_t> first_rows;  ///< first exact segment of each mover, and the end
  std::uint32_t self = kNoMover;              ///< the mover that carries the sensor, which is invisible
  std::uint32_t own_first = 0, own_end = 0;   ///< rows of its exact segments

  /// Returns the outline of a mover at the height of the beams.
  const OutlineTable::Outline& outline_of(std::uint32_t mover) const {
    return outlines->at(mover, z - states[mover].X_WM.z);
  }
  bool in_crowd(std::uint32_t mover) const {
    return !crowd_members.empty() && (crowd_members[mover / 64] >> mover % 64 & 1) != 0;
  }
};

/// Result arrays of a scan: one element per beam.
struct ScanOutput {
  double* ranges;         ///< [m]
  std::uint32_t* models;  ///< `Segment::model` of the hit, or SF_NO_HIT
  std::uint8_t* grazes;   ///< 1 if the sine at the surface is below `ScanView::min_sine`
};

/// Counters of scans.
struct ScanCounts {
  std::uint64_t uncertain = 0;        ///< beams that 32 bits could not certify
  std::uint64_t movers_in_range = 0;  ///< movers whose discs are in range and in view
  std::uint64_t movers_visible = 0;   ///< of these, not hidden
  std::uint64_t blocks = 0;           ///< blocks of segments projected
  std::uint64_t decisions = 0;        ///< pairs of a beam and a segment intersected in 64 bits
};

}  // namespace sf::raycast
