#pragma once
// Outlines of a grid of cells: exact boundary segments, as few as there are straight runs.

#include <cstdint>
#include <vector>

#include "base/pose.h"

namespace sf::world {

/// Cells from the lower left, row by row upwards.
struct Bitmap {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> solid;  ///< 1 solid, 0 free; outside of the grid everything is free
};

/// A corner of cells: (0, 0) lower left .. (width, height) upper right.
struct Corner {
  std::uint32_t i = 0;
  std::uint32_t j = 0;
};

/// A straight piece of boundary with the solid on the left of a -> b. `a` and `b` differ in exactly one coordinate.
struct BoundaryRun {
  Corner a;
  Corner b;
};

/// Every boundary between solid and free, each maximal straight run once. Runs end where the boundary turns, so also
/// where two solid cells meet only in a corner: four runs end in that very corner and nothing slips between them. The
/// order is fixed: horizontal runs from the bottom, then vertical runs from the left.
/// @param most runs; where there are more it ends early, with more than that.
std::vector<BoundaryRun> trace_boundary(const Bitmap& grid, std::size_t most = SIZE_MAX);

/// Where a corner lies in the frame of a model that shows the grid on `size_x` x `size_y`, centred. Equal corners give
/// the very same doubles.
glm::dvec2 corner_position(const Bitmap& grid, Corner corner, double size_x, double size_y);

}  // namespace sf::world
