#include "sensors/occupancy_host.h"

#include <utility>

namespace sf::sensors {

HostMaps::HostMaps(std::span<const MapSettings> map_settings, base::ThreadPool& thread_pool)
    : thread_pool_(thread_pool), ends_(thread_pool.threads()) {
  for (const MapSettings& settings : map_settings) {
    maps_.push_back(
        {settings, maps::beam_directions(settings.fov, settings.samples), maps::OccupancyGrid(), std::nullopt});
    restart(static_cast<std::uint32_t>(maps_.size() - 1));
  }
}

void HostMaps::restart(std::uint32_t map) {
  const MapSettings& settings = maps_[map].settings;
  if (settings.odds)
    maps_[map].odds.emplace(settings.grid, *settings.odds);
  else
    maps_[map].grid = maps::OccupancyGrid(settings.grid);
}

void HostMaps::update(std::span<const MapScan> scans) {
  thread_pool_.parallel_for(scans.size(), 4, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t i = first; i < last; ++i) {
      Map& map = maps_[scans[i].map];
      std::vector<std::uint32_t>& ends = ends_[thread];
      ends.resize(map.beams.size());
      const maps::ScanView view{scans[i].X_WS, scans[i].ranges, map.beams, map.settings.range_min,
                                map.settings.range_max};
      const maps::TracedScan scan = maps::trace_scan(map.settings.grid, view, ends);
      if (map.odds) maps::add_traced_scan(*map.odds, scan, ends);
      if (!map.odds) maps::add_traced_scan(map.grid, scan, ends);
    }
  });
}

void HostMaps::take_over(HostMaps& before, std::uint32_t maps) {
  for (std::uint32_t i = 0; i < maps; ++i) std::swap(maps_[i], before.maps_[i]);
}

std::span<const std::uint32_t> HostMaps::words(std::uint32_t map) const {
  return maps_[map].odds ? maps_[map].odds->words : maps_[map].grid.words;
}

}  // namespace sf::sensors
