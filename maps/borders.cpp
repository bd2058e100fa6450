#include "maps/borders.h"

#include <optional>

namespace sf::maps {

namespace {

using Lines = std::vector<MapBorders::Line>;

/// Appends the borders of the cells that are `inside` along one axis. @param axis 0: lines along x; 1: along y
/// @return false if there are more than `most`
template <class Inside>
bool add_borders(const GridGeometry& g, int axis, const Inside& inside, std::size_t most, Lines& lines) {
  const std::int64_t across = axis == 0 ? rows(g) : columns(g), along = axis == 0 ? columns(g) : rows(g);
  const auto cell = [&](std::int64_t line, std::int64_t k) { return axis == 0 ? CellAt{k, line} : CellAt{line, k}; };
  const auto corner = [&](std::int64_t line, std::int64_t k) {
    const CellAt at = cell(line, k);
    return glm::dvec2{g.left + g.cell * static_cast<double>(at.column), g.top - g.cell * static_cast<double>(at.row)};
  };
  for (std::int64_t line = 0; line <= across; ++line) {
    std::optional<std::int64_t> begin;
    for (std::int64_t k = 0; k <= along; ++k) {
      const bool border = k < along && inside(cell(line - 1, k)) != inside(cell(line, k));
      if (border && !begin) begin = k;
      if (border || !begin) continue;
      if (lines.size() == most) return false;
      lines.push_back({corner(line, *begin), corner(line, k)});
      begin.reset();
    }
  }
  return true;
}

/// Returns nullopt if there are more than `most` lines of a kind.
std::optional<MapBorders> borders_within(const OccupancyGrid& grid, std::size_t most) {
  const GridGeometry& g = grid.geometry;
  const auto occupied = [&](CellAt at) { return contains(g, at) && grid.at(at) == Cell::occupied; };
  const auto explored = [&](CellAt at) { return contains(g, at) && grid.at(at) != Cell::unexplored; };
  MapBorders borders;
  for (const int axis : {0, 1})
    if (!add_borders(g, axis, occupied, most, borders.occupied) ||
        !add_borders(g, axis, explored, most, borders.explored))
      return std::nullopt;
  return borders;
}

/// Returns the map in cells of twice the side.
OccupancyGrid halved(const OccupancyGrid& grid) {
  GridGeometry geometry = grid.geometry;
  geometry.cell *= 2.0;
  geometry.word_columns = (geometry.word_columns + 1) / 2;
  geometry.word_rows = (geometry.word_rows + 1) / 2;
  OccupancyGrid coarse(geometry);
  for (CellAt at; at.row < rows(grid.geometry); ++at.row)
    for (at.column = 0; at.column < columns(grid.geometry); ++at.column) {
      const CellAt to{at.column / 2, at.row / 2};
      const Cell cell = grid.at(at), before = coarse.at(to);
      if (cell == Cell::occupied || before == Cell::unexplored) coarse.set(to, cell);
    }
  return coarse;
}

}  // namespace

MapBorders borders_of(const OccupancyGrid& grid, std::size_t most) {
  if (auto borders = borders_within(grid, most)) return *borders;
  return borders_of(halved(grid), most);
}

}  // namespace sf::maps
