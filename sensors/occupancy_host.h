#pragma once
// Occupancy maps on the host. Long scans are entered faster line by line than strip by strip.

#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "maps/grid_update.h"
#include "sensors/occupancy_batch.h"

namespace sf::sensors {

/// [cells] On a software device, which is slower at them, scans of longer range are entered by the host.
inline constexpr double kFarScan = 60.0;

/// Not thread-safe.
class HostMaps {
 public:
  /// @param map_settings of all maps  @param farthest [cells] largest range of scans on the device
  HostMaps(std::span<const MapSettings> map_settings, double farthest);

  bool has(std::uint32_t map) const { return rows_[map] != kNone; }
  bool empty() const { return maps_.empty(); }

  /// Enters the scans of maps on the host, at most one per map; ignores the others.
  void update(std::span<const MapScan> scans, std::span<const std::uint32_t> wanted, base::ThreadPool& thread_pool);
  /// Words of a map in the last `wanted`. Valid until the next update.
  std::span<const std::uint32_t> words(std::uint32_t map) const { return maps_[rows_[map]].grid.words; }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  struct Map {
    MapSettings settings;
    std::vector<glm::dvec2> beams;
    maps::OccupancyGrid grid;  ///< its words; with log odds, their classification
    std::optional<maps::LogOddsGrid> odds;
    maps::OccupancyGrid covered;  ///< scratch, with log odds
  };
  std::vector<std::uint32_t> rows_;  ///< per map: its row in `maps_`, or kNone
  std::vector<Map> maps_;
  std::vector<std::vector<std::uint32_t>> ends_;  ///< scratch per thread
};

}  // namespace sf::sensors
