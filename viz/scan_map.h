#pragma once
// The map of a recorded run: all lasers' scans by the update rule of robots' maps (maps/grid_update.h).
//
// One hit weighs as much as eight scans that pass: a wall persists although beams graze it, and an obstacle that is
// gone disappears.

#include <map>
#include <utility>
#include <vector>

#include "base/reading.h"
#include "maps/grid_update.h"
#include "world/world.h"

namespace sf::viz {

/// Cells of whole centimetres over the extent, fine enough to show walls, coarse enough for a page.
maps::GridGeometry grid_over(const world::Extent& extent);

/// One thread. Allocates nothing after the first scans.
class ScanMap {
 public:
  explicit ScanMap(const maps::GridGeometry& geometry);

  /// Adds a scan without noise of one of the world's lasers. A beam that ends on a mover frees its cells. A range
  /// beyond maps::kMaxRangeCells cells has no echo. An echo counts half a cell behind its range: the cell of a wall is
  /// mostly solid, whatever the rounding, and lines of cells, up to half a cell beside their beams, free no cell behind
  /// it.
  void add(const world::World& world, const base::ReadingBlock& scan);
  maps::OccupancyGrid states() const { return maps::to_occupancy(odds_); }

 private:
  maps::LogOddsGrid odds_;
  std::map<std::pair<double, std::uint32_t>, std::vector<glm::dvec2>> beams_;  ///< by field of view and samples
  std::vector<double> ranges_;
  std::vector<std::uint32_t> ends_;
};

}  // namespace sf::viz
