#pragma once
// The occupancy map that a robot builds from its own readings (thesis, 4.4), and its packets.
//
//   OwnMap map(world, sensor_set, mover, {.receiver = netio::Endpoint{address, 52008}});
//   map.add(scan, X_WS);      // each reading of its laser
//   map.send(now);            // once a step

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "base/reading.h"
#include "base/thread_pool.h"
#include "netio/outbox.h"
#include "sensors/occupancy.h"
#include "sensors/occupancy_host.h"
#include "sensors/occupancy_sources.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::server {

struct OwnMapOptions {
  std::optional<netio::Endpoint> receiver;  ///< of its packets; nullopt: none are sent
  sensors::WireFormat wire = sensors::WireFormat::farm;
  /// Called when the map is due, with the robot's pose at the newest scan. Returns soon: the robot drives meanwhile.
  std::function<void(const maps::OccupancyGrid& grid, const base::Pose& X_WM)> show = {};
};

struct OwnMapCounts {
  std::uint64_t scans = 0;  ///< added to the map
  std::uint64_t maps = 0;   ///< sent with all their parts, or shown
  netio::OutboxCounts sent;
};

/// Not thread-safe.
class OwnMap {
 public:
  /// Uses the settings of the robot's first `occupancy( )`. Without one, maps the whole world from laser 0 once a
  /// second, in cells of 3 cm, doubled until its range and the map size fit the limits.
  /// @throws base::InputError for a robot without lasers, for invalid settings, for sources of other robots, and for a
  /// map that the wire format cannot carry
  OwnMap(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
         const OwnMapOptions& options);

  /// Adds a reading of the map's laser that is newer than the last, or of its sources; ignores all others.
  /// @param X_WM of the robot at the reading's time
  void add(const base::ReadingBlock& reading, const base::Pose& X_WM);
  /// Sends and shows the map if it is due.
  /// @param now [ns] timestamp of the packets @param true_poses whether the map was built from true poses
  void send(std::int64_t now, bool true_poses);

  /// Returns a copy of the map.
  maps::OccupancyGrid grid() const;
  const sensors::Occupancy& settings() const { return settings_; }
  OwnMapCounts counts() const;

 private:
  void send_parts(std::int64_t now, bool true_poses);
  bool add_scan(const base::ReadingBlock& reading, const base::Pose& X_WM);
  bool add_to_sources(const base::ReadingBlock& reading, const base::Pose& X_WM);
  std::span<const std::uint32_t> map_words() const { return source_maps_ ? source_maps_->words(0) : map_.words(0); }

  sensors::Occupancy settings_;
  base::Pose X_ML_;  ///< laser in the robot frame
  OwnMapOptions options_;
  std::uint16_t robot_;
  std::uint32_t session_;
  base::ThreadPool thread_pool_{1};
  sensors::HostMaps map_;
  std::optional<sensors::SourceMaps> source_maps_;           ///< empty: the map is that of a laser
  std::optional<std::int64_t> last_scan_;                    ///< [ns]
  std::map<sensors::RangeSensor, std::int64_t> last_times_;  ///< [ns] per source
  base::Pose X_WM_;                                          ///< at the last scan
  std::int64_t next_ = 0;                                    ///< [ns]
  std::uint32_t sequence_ = 0;
  std::uint64_t scans_ = 0;
  std::vector<double> words_;
  base::Bytes payload_, packet_;
  std::optional<netio::Outbox> outbox_;  ///< empty: nothing is sent
};

}  // namespace sf::server
