#include "sensors/occupancy_host.h"

namespace sf::sensors {

HostMaps::HostMaps(std::span<const MapPlan> plans, double farthest) : rows_(plans.size(), kNone) {
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const MapPlan& plan = plans[i];
    if (plan.range_max <= farthest * plan.grid.cell) continue;
    rows_[i] = static_cast<std::uint32_t>(maps_.size());
    Map& map = maps_.emplace_back(Map{plan, maps::beam_directions(plan.fov, plan.samples),
                                      maps::OccupancyGrid(plan.grid), std::nullopt, maps::OccupancyGrid()});
    if (!plan.odds) continue;
    map.odds.emplace(plan.grid, *plan.odds);
    map.covered = maps::OccupancyGrid(plan.grid);
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
      const maps::ScanView view{scans[i].X_WS, scans[i].ranges, map.beams, map.plan.range_min, map.plan.range_max};
      const maps::TracedScan scan = maps::trace_scan(map.plan.grid, view, ends);
      if (map.odds) maps::add_traced_scan(*map.odds, scan, ends, map.covered);
      if (!map.odds) maps::add_traced_scan(map.grid, scan, ends);
    }
  });
  for (const std::uint32_t map : wanted)
    if (has(map) && maps_[rows_[map]].odds) maps::write_occupancy(*maps_[rows_[map]].odds, maps_[rows_[map]].grid);
}

}  // namespace sf::sensors
