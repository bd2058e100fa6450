#include <fmt/format.h>

#include <array>

#include "viz/axes.h"
#include "viz/scan_hit_grid.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

constexpr double kGridLinesFrom = 5.0;  // [px] smallest side of a cell with a drawn border

std::vector<std::uint32_t> pixels_of(const ScanHitGrid& grid) {
  std::vector<std::uint32_t> pixels;
  pixels.reserve(static_cast<std::size_t>(grid.columns()) * static_cast<std::size_t>(grid.rows()));
  for (int row = grid.rows() - 1; row >= 0; --row)
    for (int column = 0; column < grid.columns(); ++column)
      pixels.push_back(theme::kCellStates[static_cast<std::size_t>(grid.state(column, row))]);
  return pixels;
}

void draw_cell_borders(Axes& axes, const ScanHitGrid& grid) {
  if (grid.cell() * axes.scale() < kGridLinesFrom) return;
  const world::Extent e = grid.extent();
  std::vector<Line> lines;
  for (int i = 0; i <= grid.columns(); ++i)
    lines.push_back(
        {axes.pixel({e.x_min + i * grid.cell(), e.y_min}), axes.pixel({e.x_min + i * grid.cell(), e.y_max})});
  for (int j = 0; j <= grid.rows(); ++j)
    lines.push_back(
        {axes.pixel({e.x_min, e.y_min + j * grid.cell()}), axes.pixel({e.x_max, e.y_min + j * grid.cell()})});
  axes.canvas().lines(lines, theme::kHairline, theme::kCellBorder);
}

FigureOptions plan_of(const world::World& world, const ScanHitGrid& grid) {
  const AreaShares part = shares(grid);
  const auto item = [&](CellState state, const char* name, double share) {
    return LegendItem{LegendMark::block, theme::kCellStates[static_cast<std::size_t>(state)],
                      fmt::format("{} {:.1f} %", name, 100.0 * share), theme::kFrame};
  };
  FigureOptions options;
  options.title = "Occupancy";
  options.subtitle =
      fmt::format("{}{}{:.1f} % explored, {} x {} cells of {:g} m", world.name, world.name.empty() ? "" : ": ",
                  100.0 * (1.0 - part.unexplored), grid.columns(), grid.rows(), grid.cell());
  options.extent = grid.extent();
  options.margin = 0.0;
  options.background = theme::kCellStates[0];
  options.legend = {item(CellState::free, "free", part.free), item(CellState::occupied, "occupied", part.occupied),
                    item(CellState::unexplored, "unexplored", part.unexplored)};
  return options;
}

}  // namespace

void draw_occupancy(const world::World& world, const ScanHitGrid& grid, const std::string& png_path) {
  Axes axes(plan_of(world, grid));
  const world::Extent e = grid.extent();
  const std::vector<std::uint32_t> pixels = pixels_of(grid);
  axes.canvas().image(axes.pixel({e.x_min, e.y_max}), axes.pixel({e.x_max, e.y_min}),
                      {grid.columns(), grid.rows(), pixels});
  draw_cell_borders(axes, grid);
  axes.save(png_path);
}

}  // namespace sf::viz
