#pragma once
// Many occupancy maps, on the device or the host. One batch adds a tick's scans to all of them and sets exactly the
// same cells as maps::add_scan.
//
// The host converts ranges to end cells in double, on all cores (maps/traced_scan.h). The device holds the maps and
// covers cells in integer arithmetic: it needs no 64-bit floats, and its rounding has no effect.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "gpu/device.h"
#include "maps/grid_update.h"

namespace sf::sensors {

inline constexpr std::uint32_t kMostMapBeams = 20'000;  ///< three loops over them stay below 65 535 iterations

/// One map with the settings of its laser.
struct MapSettings {
  maps::GridGeometry grid;                  ///< must satisfy is_valid
  std::optional<maps::LogOddsUpdate> odds;  ///< log-odds update; empty: the last scan overwrites
  double fov = 0.0;                         ///< [rad] in [0, 2 pi]
  std::uint32_t samples = 1;                ///< in [1, kMostMapBeams]
  double range_min = 0.0;                   ///< [m]
  double range_max = 0.0;                   ///< [m] at most maps::kMaxRangeCells cells
};

/// A scan for one map.
struct MapScan {
  std::uint32_t map = 0;
  base::Pose X_WS;                 ///< pose of the sensor
  std::span<const double> ranges;  ///< [m] `samples` values
};

class HostMaps;

/// Not thread-safe. `device` and `thread_pool` must outlive it.
class MapBatch {
 public:
  /// All maps start unexplored.
  /// @param on_host true: the host adds the scans; false: the device does, and holds the maps
  /// @throws base::DeviceError when the device cannot hold the maps
  MapBatch(gpu::Device& device, base::ThreadPool& thread_pool, std::vector<MapSettings> map_settings, bool on_host);
  ~MapBatch();

  /// Adds scans, at most one per map. @param wanted maps whose words will be read
  void update(std::span<const MapScan> scans, std::span<const std::uint32_t> wanted);

  /// Makes a map unexplored, from the next update on.
  void restart(std::uint32_t map);

  /// Continues the first `maps` maps of another batch of the same device, which must not be used afterwards. Call it
  /// before the first update.
  void take_over(MapBatch& before, std::uint32_t maps);

  /// Returns the words of a map in the last `wanted`, packed as in maps/grid.h. Valid until the next update.
  std::span<const std::uint32_t> words(std::uint32_t map) const;

 private:
  struct Tables;
  std::size_t maps_;
  std::unique_ptr<HostMaps> host_;  ///< null if `t_` is used
  std::unique_ptr<Tables> t_;
};

}  // namespace sf::sensors
