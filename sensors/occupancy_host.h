#pragma once
// Occupancy maps on the host, on all cores.

#include <optional>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "maps/grid_update.h"
#include "sensors/occupancy_batch.h"

namespace sf::sensors {

/// Not thread-safe.
class HostMaps {
 public:
  HostMaps(std::span<const MapSettings> map_settings, base::ThreadPool& thread_pool);

  /// Adds scans, at most one per map.
  void update(std::span<const MapScan> scans);
  /// Makes a map unexplored.
  void restart(std::uint32_t map);
  /// Takes the first `maps` maps of `before`.
  void take_over(HostMaps& before, std::uint32_t maps);
  /// Returns the words of a map. Valid until the next update.
  std::span<const std::uint32_t> words(std::uint32_t map) const;

 private:
  struct Map {
    MapSettings settings;
    std::vector<glm::dvec2> beams;
    maps::OccupancyGrid grid;               ///< without log odds
    std::optional<maps::LogOddsGrid> odds;  ///< with log odds
  };
  std::vector<Map> maps_;
  base::ThreadPool& thread_pool_;
  std::vector<std::vector<std::uint32_t>> ends_;  ///< scratch per thread
};

}  // namespace sf::sensors
