#include "sensors/occupancy_host.h"

namespace sf::sensors {

HostMaps::HostMaps(std::span<const MapSettings> map_settings, double farthest) : rows_(map_settings.size(), kNone) {
  for (std::size_t i = 0; i < map_settings.size(); ++i) {
    const MapSettings& settings = map_settings[i];
    if (settings.range_max <= farthest * settings.grid.cell) continue;
    rows_[i] = static_cast<std::uint32_t>(maps_.size());
    Map& map = maps_.emplace_back(Map{settings, maps::beam_directions(settings.fov, settings.samples),
                                      maps::OccupancyGrid(settings.grid), std::nullopt, maps::OccupancyGrid()});
    if (!settings.odds) continue;
    map.odds.emplace(settings.grid, *settings.odds);
    map.covered = maps::OccupancyGrid(settings.grid);
  }
}

void HostMaps::update(std::span<const MapScan> scans, std::span<const std::uint32_t> wanted,
                      base::ThreadPool& thread_pool) {
  if (empty()) return;
  ends_.resize(thread_pool.threads());
  thread_pool.parallel_for(scans.size(), 4, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t i = first; i < last; ++i) {
      if (!has(scans[i].map)) continue;
      Map& map = maps_[rows_[scans[i].map]];
      std::vector<std::uint32_t>& ends = ends_[thread];
      ends.resize(map.beams.size());
      const maps::ScanView view{scans[i].X_WS, scans[i].ranges, map.beams, map.settings.range_min,
                                map.settings.range_max};
      const maps::TracedScan scan = maps::trace_scan(map.settings.grid, view, ends);
      if (map.odds) maps::add_traced_scan(*map.odds, scan, ends, map.covered);
      if (!map.odds) maps::add_traced_scan(map.grid, scan, ends);
    }
  });
  for (const std::uint32_t map : wanted)
    if (has(map) && maps_[rows_[map]].odds) maps::write_occupancy(*maps_[rows_[map]].odds, maps_[rows_[map]].grid);
}

}  // namespace sf::sensors
