#include "viz/occupancy_figure.h"

#include <fmt/format.h>

#include "viz/axes.h"
#include "viz/map_cells.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

constexpr double kGridLinesFrom = 5.0;  // [px] smallest side of cells with a border

world::Extent extent_of(const maps::GridGeometry& geometry) {
  return {geometry.left, geometry.top - geometry.cell * static_cast<double>(maps::rows(geometry)),
          geometry.left + geometry.cell * static_cast<double>(maps::columns(geometry)), geometry.top};
}

void draw_cell_borders(Axes& axes, const maps::GridGeometry& geometry) {
  if (geometry.cell * axes.scale() < kGridLinesFrom) return;
  const world::Extent e = extent_of(geometry);
  std::vector<Line> lines;
  for (std::int64_t i = 0; i <= maps::columns(geometry); ++i) {
    const double x = e.x_min + static_cast<double>(i) * geometry.cell;
    lines.push_back({axes.pixel({x, e.y_min}), axes.pixel({x, e.y_max})});
  }
  for (std::int64_t j = 0; j <= maps::rows(geometry); ++j) {
    const double y = e.y_min + static_cast<double>(j) * geometry.cell;
    lines.push_back({axes.pixel({e.x_min, y}), axes.pixel({e.x_max, y})});
  }
  axes.canvas().lines(lines, theme::kHairline, theme::kCellBorder);
}

FigureOptions options_of(const world::World& world, const maps::OccupancyGrid& grid, const Page& page) {
  const maps::CellCounts cells = maps::count(grid);
  const double explored = 100.0 * static_cast<double>(cells.free + cells.occupied) / static_cast<double>(cells.all());
  FigureOptions options;
  options.title = "Occupancy";
  options.subtitle =
      fmt::format("{}{}{:.1f} % explored, {} x {} cells of {:g} m", world.name, world.name.empty() ? "" : ": ",
                  explored, maps::columns(grid.geometry), maps::rows(grid.geometry), grid.geometry.cell);
  options.extent = extent_of(grid.geometry);
  options.margin = 0.0;
  options.background = map_states(page.map_colors)[SF_CELL_UNEXPLORED];
  options.legend = state_legend(cells, page.map_colors);
  options.page = page;
  return options;
}

}  // namespace

void draw_occupancy(const world::World& world, const maps::OccupancyGrid& grid, const std::string& path,
                    const Page& page) {
  Axes axes(options_of(world, grid, page));
  const world::Extent e = extent_of(grid.geometry);
  const std::vector<std::uint32_t> pixels = pixels_of(grid, page.map_colors);
  axes.canvas().image(
      axes.pixel({e.x_min, e.y_max}), axes.pixel({e.x_max, e.y_min}),
      {static_cast<int>(maps::columns(grid.geometry)), static_cast<int>(maps::rows(grid.geometry)), pixels});
  if (page.map_colors == MapColors::thesis) draw_cell_borders(axes, grid.geometry);  // ROS: free cells are white
  axes.save(path);
}

}  // namespace sf::viz
