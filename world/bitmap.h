#pragma once
// Outlines of a grid of cells: exact boundary segments, one per straight run.

#include <cstdint>
#include <vector>

#include "base/pose.h"

namespace sf::world {

/// Cells row by row, from the bottom left upwards.
struct Bitmap {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> solid;  ///< 1 solid, 0 free; everything outside the grid is free
};

/// A corner of cells, from (0, 0) at the lower left to (width, height) at the upper right.
struct Corner {
  std::uint32_t i = 0;
  std::uint32_t j = 0;
};

/// A straight piece of boundary with the solid on the left of a -> b. `a` and `b` differ in exactly one coordinate.
struct BoundaryRun {
  Corner a;
  Corner b;
};

/// Returns all boundaries between solid and free cells, as maximal straight runs. A run ends at each corner of the
/// boundary. If two solid cells touch only at a corner, four runs end there, so no beam passes between the cells. The
/// order is fixed: horizontal runs from the bottom, then vertical runs from the left.
/// @param most largest number of runs; beyond it, tracing stops early and the result is larger than `most`
std::vector<BoundaryRun> trace_boundary(const Bitmap& grid, std::size_t most = SIZE_MAX);

/// A rectangle of cells, at least one.
struct PicturePart {
  Corner low;   ///< lower left
  Corner high;  ///< upper right
};

/// Returns the position of a corner in the frame of a model that shows `part` on `size_x` x `size_y`, centred. Equal
/// corners give bitwise equal positions.
glm::dvec2 corner_position(const PicturePart& part, Corner corner, double size_x, double size_y);

}  // namespace sf::world
