#pragma once
// Fuses readings of robots' own sensors, which sense the real world alone (OWN_READINGS), with those of the virtual
// sensors of the same type and number, which sense the farm's world alone.
//
//   farm.fuse_with([&](auto readings) { fusion.fuse(readings); });
//   fusion.take(packet.header, own_readings, mover, now);
//
// Ranges, element by element: the nearer of both echoes. Bumpers: pressed if either is. Both are idempotent: what both
// worlds contain, such as a wall of the laboratory that is drawn in the world file, counts once. A fused reading states
// no error bound. docs/robots.md has the whole rule.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/reading.h"
#include "netio/packets.h"
#include "netio/rate_limited_log.h"
#include "robots/estimation/sender_clock.h"
#include "sensors/sensor_set.h"
#include "server/real_walls.h"
#include "world/world.h"

namespace sf::server {

struct FusionOptions {
  std::int64_t max_age = 250'000'000;  ///< [ns] > 0 of an own reading at the time of the virtual one
  estimation::ClockOptions clock;
  std::int64_t epoch = 0;  ///< [ns] Unix time at time 0 of the farm's clock, for estimation::ClockSource::trusted
};

struct FusionCounts {
  std::uint64_t taken = 0;       ///< own readings that arrived whole
  std::uint64_t incomplete = 0;  ///< own readings of which a part did not arrive, or not in order
  std::uint64_t unfit = 0;       ///< packets of sensors that the world's robot lacks, or with other elements
  std::uint64_t overtaken = 0;   ///< own readings that are not newer than the last one of their sensor
  std::uint64_t mistimed = 0;    ///< own readings that their sender's clock places in the future or too far in the past
  std::uint64_t fused = 0;       ///< readings of virtual sensors with an own one
  std::uint64_t too_old = 0;     ///< readings of virtual sensors without, since the newest own one was too old
  std::uint64_t mapped = 0;      ///< readings of simulated robots with walls that real ones have shown
  double age_s = 0.0;            ///< [s] sum of the ages of own readings over `fused`
  double oldest_s = 0.0;         ///< [s] largest of them

  friend bool operator==(const FusionCounts&, const FusionCounts&) = default;
};

/// Times [ns] are on the farm's clock, which does not decrease. The world and the sensor set must outlive it. Memory is
/// bounded by the sensors of the world. Not thread-safe.
class ReadingFusion {
 public:
  static constexpr std::uint32_t kMostRefused = 64;  ///< number from which on sensors share their line in the log
  static constexpr double kFovTolerance = 1e-3;      ///< [rad] between the fields of view of both lasers

  ReadingFusion(const world::World& world, const sensors::SensorSet& sensor_set, const FusionOptions& options);

  void set_epoch(std::int64_t epoch) { options_.epoch = epoch; }

  /// Takes a packet of the robot in row `mover`. Logs once per sensor why its readings are refused.
  void take(const netio::Header& header, const netio::OwnReadings& own, std::uint32_t mover, std::int64_t now,
            netio::RateLimitedLog& log);
  /// Replaces values of readings and marks them (ReadingBlock::fused). The new values are valid until the next call.
  void fuse(std::span<base::ReadingBlock> readings);

  const FusionCounts& counts() const { return counts_; }
  /// Returns the estimated clocks of the senders, by row of their robot.
  const auto& senders() const { return senders_; }

 private:
  struct Sender {
    std::uint32_t session = 0;
    estimation::SenderClock clock;
  };
  struct Whole {
    std::int64_t time = 0;       ///< [ns] of the sender
    std::size_t elements = 0;    ///< that arrived, in order
    std::vector<double> values;  ///< per element, as netio::value_of
  };
  struct Sensor {
    Whole arriving;        ///< the reading that arrives
    Whole newest;          ///< the newest whole reading; without elements: none
    bool mapped = false;   ///< `newest` was offered to the map of walls
    base::Pose X_WS;       ///< at the last virtual reading
    std::int64_t at = -1;  ///< [ns] of that reading; -1: none
    // The fused reading.
    std::vector<double> values;
    std::vector<std::uint32_t> hits;
    std::vector<base::QualityFlag> quality;
  };

  std::string refusal_of(const netio::Header& header, const netio::OwnReadings& own, std::uint32_t mover) const;
  bool begin(const netio::Header& header, Sensor& sensor, std::uint32_t mover, std::int64_t now);
  void forget(std::uint32_t mover);
  std::int64_t arrival(std::int64_t now) const;
  bool fuse(base::ReadingBlock& reading, Sensor& sensor, std::span<const double> own) const;
  void fuse_ranges(base::ReadingBlock& reading, Sensor& sensor, std::span<const double> own) const;
  void fuse_own(base::ReadingBlock& reading, Sensor& sensor);
  void map(const base::ReadingBlock& reading, std::int64_t age, Sensor& sensor);
  void fuse_walls(base::ReadingBlock& reading);

  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  FusionOptions options_;
  std::map<std::uint32_t, Sender> senders_;  ///< by row of the robot
  using Key = std::array<std::uint32_t, 3>;  ///< row of the robot, type, number
  std::map<Key, Sensor> sensors_;            ///< that exist
  std::map<Key, std::string> refusals_;      ///< the last one of each sensor, up to kMostRefused
  RealWalls walls_;
  std::vector<double> seen_;  ///< [m] per beam: the next real wall; NaN: none
  FusionCounts counts_;
};

}  // namespace sf::server
