#pragma once
// A height map as a surface: a regular grid of heights, with a pyramid of bounds. Triangles are formed where
// beams reach them: each cell is cut along the diagonal from its corner with the smallest x and y.

#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <span>
#include <vector>

namespace sf::scene {

/// A plane above the surface of a block, or below it with all signs changed. In x and y [cells] from the block's corner
/// with the smallest coordinates: height + (x slope[0] + y slope[1]) HeightField::slope_unit.
struct BoundingPlane {
  float height = 0.0f;  ///< [m]
  std::int16_t slope[2]{};
};

/// Immutable once built; any number of threads may read it. In its frame, point (i, j) is at (i cell.x, j cell.y).
struct HeightField {
  std::int32_t columns = 0, rows = 0;   ///< of points, each at least 2
  glm::dvec2 cell{};                    ///< [m] > 0
  std::vector<float> heights;           ///< [m] row by row
  float steepest = 0.0f;                ///< [m] largest difference along an edge of a cell
  float lowest = 0.0f, highest = 0.0f;  ///< [m]

  /// Of blocks of 2^level x 2^level cells, for levels 1 to `levels`, in one array: the block with cell (i, j) is at row
  /// ((j - bias) >> level) + bias / 2, column i >> level.
  std::vector<BoundingPlane> above, below;
  std::int32_t levels = 1, pitch = 0, bias = 0;
  float slope_unit = 0.0f;  ///< [m per cell]

  bool empty() const { return heights.empty(); }
  /// Row of point (i, j) in `heights`.
  std::size_t at(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
  }
};

/// @param heights finite; at most 2^26
HeightField build_height_field(std::uint32_t columns, std::uint32_t rows, glm::dvec2 cell, std::vector<float> heights);

}  // namespace sf::scene
