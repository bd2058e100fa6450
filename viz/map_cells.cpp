#include "viz/map_cells.h"

#include <fmt/format.h>

#include "viz/theme.h"

namespace sf::viz {

const std::array<std::uint32_t, 4>& map_states(MapColors colors) {
  return colors == MapColors::ros ? theme::kRosMapStates : theme::kThesisMapStates;
}

std::vector<std::uint32_t> pixels_of(const maps::OccupancyGrid& grid, MapColors colors) {
  std::vector<std::uint32_t> pixels;
  for (std::int64_t row = 0; row < maps::rows(grid.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(grid.geometry); ++column)
      pixels.push_back(map_states(colors)[static_cast<std::size_t>(grid.at({column, row}))]);
  return pixels;
}

std::vector<LegendItem> state_legend(const maps::CellCounts& cells, MapColors colors) {
  std::vector<LegendItem> items;
  const auto add = [&](std::uint32_t state, const char* name, std::uint64_t part) {
    if (part == 0) return;
    const double percent = 100.0 * static_cast<double>(part) / static_cast<double>(cells.all());
    items.push_back(
        {LegendMark::block, map_states(colors)[state], fmt::format("{} {:.1f} %", name, percent), theme::kFrame});
  };
  add(SF_CELL_FREE, "free", cells.free);
  add(SF_CELL_OCCUPIED, "occupied", cells.occupied);
  add(SF_CELL_UNEXPLORED, "unknown", cells.unexplored);
  return items;
}

}  // namespace sf::viz
