#include "viz/map_cells.h"

#include <fmt/format.h>

#include "viz/theme.h"

namespace sf::viz {

std::vector<std::uint32_t> pixels_of(const maps::OccupancyGrid& grid) {
  std::vector<std::uint32_t> pixels;
  for (std::int64_t row = 0; row < maps::rows(grid.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(grid.geometry); ++column)
      pixels.push_back(theme::kMapStates[static_cast<std::size_t>(grid.at({column, row}))]);
  return pixels;
}

std::vector<LegendItem> state_legend(const maps::CellCounts& cells) {
  const auto item = [&](std::uint32_t state, const char* name, std::uint64_t part) {
    const double percent = 100.0 * static_cast<double>(part) / static_cast<double>(cells.all());
    return LegendItem{LegendMark::block, theme::kMapStates[state], fmt::format("{} {:.1f} %", name, percent),
                      theme::kFrame};
  };
  return {item(SF_CELL_FREE, "free", cells.free), item(SF_CELL_OCCUPIED, "occupied", cells.occupied),
          item(SF_CELL_UNEXPLORED, "unexplored", cells.unexplored)};
}

}  // namespace sf::viz
