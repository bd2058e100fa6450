#pragma once
// Synthetic scans for tests of occupancy maps, with any range.

#include <cmath>
#include <limits>
#include <vector>

#include "maps/grid_update.h"
#include "sensors/occupancy_batch.h"
#include "tests/maps/plain_scan.h"
#include "tests/sensors/chance.h"

namespace sf::trial {

/// Valid and invalid ranges: irregular walls, no return, zero, beyond range_max, NaN.
inline std::vector<double> odd_ranges(Chance& chance, const sensors::MapSettings& settings) {
  std::vector<double> ranges;
  double wall = chance.between(0.0, 1.2 * settings.range_max);
  for (std::uint32_t k = 0; k < settings.samples; ++k) {
    if (chance.below(12) == 0) wall = chance.between(0.0, 1.2 * settings.range_max);
    wall += chance.between(-0.01, 0.01) * settings.range_max;
    const std::uint32_t odd = chance.below(60);
    ranges.push_back(odd == 0   ? std::nan("")
                     : odd == 1 ? std::numeric_limits<double>::infinity()
                     : odd == 2 ? 0.0
                     : odd == 3 ? -0.3
                     : odd == 4 ? settings.range_min
                                : std::clamp(wall, 0.0, settings.range_max));
  }
  return ranges;
}

/// Returns a robot's pose: anywhere on the map, or up to a range outside it.
inline base::Pose odd_pose(Chance& chance, const sensors::MapSettings& settings) {
  const double wide = settings.grid.cell * static_cast<double>(maps::columns(settings.grid));
  const double high = settings.grid.cell * static_cast<double>(maps::rows(settings.grid));
  const double reach = chance.below(3) == 0 ? settings.range_max : 0.0;
  base::Pose X{settings.grid.left + chance.between(-reach, wide + reach),
               settings.grid.top - chance.between(-reach, high + reach), 0.0, chance.between(-10.0, 10.0)};
  // Occasionally on a cell's corner, facing along its sides.
  if (chance.below(8) == 0) X.x = settings.grid.left + settings.grid.cell * chance.below(100);
  if (chance.below(8) == 0) X.y = settings.grid.top - settings.grid.cell * chance.below(100);
  if (chance.below(8) == 0) X.yaw = 0.25 * M_PI * chance.below(8);
  return X;
}

/// The reference.
class PlainMaps {
 public:
  explicit PlainMaps(const std::vector<sensors::MapSettings>& map_settings) : map_settings_(map_settings) {
    for (const sensors::MapSettings& settings : map_settings) {
      grids_.emplace_back(settings.grid);
      odds_.emplace_back(settings.grid, settings.odds.value_or(maps::LogOddsUpdate{}));
      beams_.push_back(maps::beam_directions(settings.fov, settings.samples));
    }
  }
  void update(const sensors::MapScan& scan) {
    const sensors::MapSettings& settings = map_settings_[scan.map];
    const maps::ScanView view{scan.X_WS, scan.ranges, beams_[scan.map], settings.range_min, settings.range_max};
    std::vector<std::uint32_t> ends(scan.ranges.size());
    const maps::TracedScan traced = maps::trace_scan(settings.grid, view, ends);
    maps::OccupancyGrid covered(settings.grid);
    if (settings.odds) add_plainly(odds_[scan.map], traced, ends, covered);
    if (!settings.odds) add_plainly(grids_[scan.map], traced, ends);
  }
  std::vector<std::uint32_t> words(std::uint32_t map) const {
    return map_settings_[map].odds ? plain_words(odds_[map]) : grids_[map].words;
  }

 private:
  std::vector<sensors::MapSettings> map_settings_;
  std::vector<maps::OccupancyGrid> grids_;
  std::vector<maps::LogOddsGrid> odds_;
  std::vector<std::vector<glm::dvec2>> beams_;
};

}  // namespace sf::trial
