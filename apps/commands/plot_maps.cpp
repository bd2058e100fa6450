#include "apps/commands/plot_maps.h"

#include <fmt/format.h>

#include <algorithm>

#include "maps/merge.h"
#include "sensors/occupancy.h"
#include "viz/map_figure.h"

namespace sf::apps {

namespace {

/// The last map of one sensor.
struct LastMap {
  std::string name;  ///< robot's name, followed by the sensor's number if that is not 0
  viz::PoseMarker place;
  maps::OccupancyGrid grid;
};

const record::ReadingSample* last_of(const record::Recording& recording, const sensors::SensorSpec& row) {
  const auto& all = recording.readings;
  const auto last = std::find_if(all.rbegin(), all.rend(), [&](const record::ReadingSample& r) {
    return r.type == sensors::kOccupancy && r.mover == row.mover && r.sensor == row.sensor;
  });
  return last != all.rend() && last->values.size() == row.elements ? &*last : nullptr;
}

std::vector<LastMap> last_maps(const record::Recording& recording, const world::World& world) {
  std::vector<LastMap> all;
  for (const sensors::Occupancy& map : sensors::occupancies_of(world)) {
    const record::ReadingSample* last = last_of(recording, map.row);
    if (last == nullptr) continue;
    const std::string& robot = world.movers[map.row.mover].name;
    LastMap found{map.row.sensor == 0 ? robot : fmt::format("{}_{}", robot, map.row.sensor),
                  {robot, world.movers[map.row.mover].X_WM},
                  maps::OccupancyGrid(map.settings.grid)};
    std::transform(last->values.begin(), last->values.end(), found.grid.words.begin(),
                   [](double word) { return static_cast<std::uint32_t>(word); });
    for (const record::StateSample& s : recording.states[map.row.mover])
      if (!base::is_absent(s.X_WM)) found.place.X_WR = s.X_WM;
    all.push_back(std::move(found));
  }
  return all;
}

}  // namespace

std::vector<std::string> draw_maps(const record::Recording& recording, const world::World& world,
                                   const PlotOptions& options, const std::string& folder) {
  const std::vector<LastMap> all = last_maps(recording, world);
  std::vector<std::string> files;
  const auto draw = [&](const maps::OccupancyGrid& grid, const viz::MapFigure& figure, const std::string& file) {
    files.push_back(folder + "/" + file + "." + options.format);
    viz::draw_map(grid, figure, files.back(), options.page);
  };
  if (all.empty()) return files;
  std::vector<const maps::OccupancyGrid*> grids;
  viz::MapFigure figure{all.size() > 1 ? "Merged occupancy map" : "Occupancy map", recording.info.world, {}};
  for (const LastMap& map : all) {
    grids.push_back(&map.grid);
    figure.places.push_back(map.place);
  }
  if (maps::merge_problem(grids).empty()) {
    if (all.size() > 1) figure.subtitle += fmt::format(", {} maps", all.size());
    draw(maps::merge(grids), figure, "map");
    return files;
  }
  for (const LastMap& map : all) draw(map.grid, {"Occupancy map", map.name, {map.place}}, "map_" + map.name);
  return files;
}

}  // namespace sf::apps
