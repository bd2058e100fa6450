#pragma once
// Many occupancy maps, on the device or the host: a tick's scans entered into all of them in one batch, word by word,
// with exactly the cells that maps::add_scan would set.
//
// The host turns ranges into end cells, in double, on all cores (maps/traced_scan.h); the device owns the maps and
// covers cells in whole numbers. So it needs no 64-bit floats, and how it rounds changes nothing.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "gpu/device.h"
#include "maps/grid_update.h"

namespace sf::sensors {

inline constexpr std::uint32_t kMostMapBeams = 20'000;  ///< three runs of candidates stay below 65 535 turns of a loop

/// One map and the laser that fills it.
struct MapPlan {
  maps::GridGeometry grid;                  ///< is_valid
  std::optional<maps::LogOddsUpdate> odds;  ///< cells are weighed; else the last scan is right
  double fov = 0.0;                         ///< [rad] in [0, 2 pi]
  std::uint32_t samples = 1;                ///< in [1, kMostMapBeams]
  double range_min = 0.0;                   ///< [m]
  double range_max = 0.0;                   ///< [m] at most maps::kMaxRangeCells cells
};

/// A scan for one map.
struct MapScan {
  std::uint32_t map = 0;
  base::Pose X_WS;                 ///< of the sensor
  std::span<const double> ranges;  ///< [m] `samples` of them
};

/// Not thread-safe. `device` and `thread_pool` must outlive it.
class MapBatch {
 public:
  /// All maps unexplored. @param farthest [cells] range of scans that the device enters; the host enters the others
  /// @throws base::DeviceError when the device cannot hold them.
  MapBatch(gpu::Device& device, base::ThreadPool& thread_pool, std::vector<MapPlan> plans,
           double farthest = maps::kMaxRangeCells);
  ~MapBatch();

  /// Enters scans, at most one into each map. @param wanted maps whose words are looked at afterwards
  void update(std::span<const MapScan> scans, std::span<const std::uint32_t> wanted);

  /// Of a map that was wanted last: packed as in maps/grid.h. Lives until the next update.
  std::span<const std::uint32_t> words(std::uint32_t map) const;

 private:
  struct Tables;
  std::unique_ptr<Tables> t_;
};

}  // namespace sf::sensors
