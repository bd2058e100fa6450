#include "maps/merge.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sf::maps {

namespace {

/// Returns the offset of the corner of `other` from that of `geometry` [cells].
CellAt corner_in(const GridGeometry& geometry, const GridGeometry& other) {
  return {static_cast<std::int64_t>(std::llround((other.left - geometry.left) / geometry.cell)),
          static_cast<std::int64_t>(std::llround((geometry.top - other.top) / geometry.cell))};
}

std::int64_t words_below(std::int64_t cells) { return cells >= 0 ? cells / 4 : -((3 - cells) / 4); }

/// A box of words, relative to the first map's corner.
struct WordBox {
  std::int64_t left = 0, top = 0, right = 0, bottom = 0;
};

WordBox box_of(std::span<const OccupancyGrid* const> grids) {
  WordBox box;
  for (const OccupancyGrid* grid : grids) {
    const CellAt corner = corner_in(grids[0]->geometry, grid->geometry);
    box.left = std::min(box.left, words_below(corner.column));
    box.top = std::min(box.top, words_below(corner.row));
    box.right = std::max(box.right, -words_below(-(corner.column + columns(grid->geometry))));
    box.bottom = std::max(box.bottom, -words_below(-(corner.row + rows(grid->geometry))));
  }
  return box;
}

Cell both(Cell old, Cell more, MergePolicy precedence) {
  if (more == Cell::unexplored) return old;
  return precedence == MergePolicy::occupied && old == Cell::occupied ? old : more;
}

}  // namespace

std::string merge_problem(std::span<const OccupancyGrid* const> grids) {
  for (const OccupancyGrid* grid : grids)
    if (grid->geometry.cell != grids[0]->geometry.cell)
      return "maps with cells of " + std::to_string(grids[0]->geometry.cell) + " m and of " +
             std::to_string(grid->geometry.cell) + " m cannot be merged; give them the same `cell`";
  const WordBox box = box_of(grids);
  const std::int64_t across = box.right - box.left;
  const std::int64_t down = box.bottom - box.top;
  if (across <= kMaxWordColumns && down <= kMaxWordColumns && across * down <= kMaxWords) return "";
  return "maps so far apart cannot be merged: a map of " + std::to_string(4 * across) + " x " +
         std::to_string(4 * down) + " cells would be required; merge neighbouring maps";
}

OccupancyGrid merge(std::span<const OccupancyGrid* const> grids, MergePolicy precedence) {
  SF_CHECK(!grids.empty() && merge_problem(grids).empty(), "maps that cannot be merged");
  const WordBox box = box_of(grids);
  const GridGeometry& first = grids[0]->geometry;
  const double word = 4.0 * first.cell;
  OccupancyGrid merged(
      {first.left + word * static_cast<double>(box.left), first.top - word * static_cast<double>(box.top), first.cell,
       static_cast<std::uint32_t>(box.right - box.left), static_cast<std::uint32_t>(box.bottom - box.top)});
  for (const OccupancyGrid* grid : grids) {
    const CellAt corner = corner_in(first, grid->geometry);
    const CellAt shift{corner.column - 4 * box.left, corner.row - 4 * box.top};
    for (std::int64_t row = 0; row < rows(grid->geometry); ++row)
      for (std::int64_t column = 0; column < columns(grid->geometry); ++column) {
        const CellAt to{column + shift.column, row + shift.row};
        merged.set(to, both(merged.at(to), grid->at({column, row}), precedence));
      }
  }
  return merged;
}

}  // namespace sf::maps
