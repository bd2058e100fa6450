#pragma once
// Changes the use of lanes in a running service: applies LANE packets of operators and forwards them to robots.
//
//   LaneService lanes(world);
//   lanes.accept(packet);                              // LANE accepted by the inbox
//   lanes.update(now, states, absent, log);            // each tick
//   lanes.publish(now, receiver);
//
//   ReceivedLanes lanes(roads);                        // in a robot's process
//   if (!lanes.take(packet)) ...                       // the farm has another road network
//   input.roads = lanes.network();

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "netio/packets.h"
#include "world/roads/lane_control.h"

namespace sf::netio {
class RateLimitedLog;
}

namespace sf::server {

class StateReceiver;

/// Not thread-safe.
class LaneService {
 public:
  static constexpr std::int64_t kPeriod = 1'000'000'000;  ///< [ns] between two LANE of one lane to a robot
  static constexpr std::size_t kMostLanes = 64;           ///< lanes whose uses may change during a run
  /// Requests per update that are tried on the road network, which builds it anew; the others wait.
  static constexpr std::size_t kMostTried = 4;

  /// @throws base::InputError if the road network cannot be read
  explicit LaneService(const world::World& world);

  /// Keeps the newest request for each lane until the next update, for at most kMostLanes lanes.
  void accept(const netio::Lane& lane);
  /// Applies requests, or logs why they are refused, and logs each change of use. Lanes take turns.
  /// @param states one per mover @param absent per mover
  void update(std::int64_t now, std::span<const base::Report> states, const std::vector<bool>& absent,
              netio::RateLimitedLog& log);
  /// Queues the use of each lane that was changed during the run for robots that subscribed to the states of others: at
  /// once, and every kPeriod.
  void publish(std::int64_t now, StateReceiver& receiver);

  /// Returns the current uses, one per lane; empty before the first accepted request.
  std::span<const world::LaneUse> uses() const;
  std::uint64_t refused() const { return refused_; }  ///< requests

 private:
  void apply(std::int64_t now, netio::RateLimitedLog& log);

  std::string file_;  ///< of the world
  std::optional<world::RoadNetwork> roads_;
  std::optional<world::LaneControl> control_;                                   ///< since the first accepted request
  std::map<std::pair<std::uint32_t, std::uint32_t>, world::LaneUse> requests_;  ///< by segment and lane
  std::pair<std::uint32_t, std::uint32_t> last_{};  ///< key of the last request that was tried
  std::set<std::uint32_t> changed_;                 ///< rows of lanes
  std::vector<base::Report> present_;               ///< for one update
  std::map<std::uint32_t, std::uint32_t> sent_;     ///< packets by robot
  std::optional<std::int64_t> published_;           ///< [ns]
  bool news_ = false;                               ///< since the last `publish`
  std::uint64_t refused_ = 0;
  std::uint64_t left_out_ = 0;  ///< requests beyond kMostLanes since the last update
  base::Bytes packet_;
};

/// The uses of lanes that a robot receives. Not thread-safe.
class ReceivedLanes {
 public:
  /// @param roads null: the world has none; must outlive it
  explicit ReceivedLanes(const world::RoadNetwork* roads);

  /// @return false if the network has no such lane, or the lane cannot have this use
  bool take(const netio::Lane& lane);
  /// Returns the current network; null until a use differs from that at the start.
  const std::shared_ptr<const world::RoadNetwork>& network() const { return network_; }

 private:
  const world::RoadNetwork* roads_;
  std::vector<world::LaneUse> uses_;  ///< per lane
  std::shared_ptr<const world::RoadNetwork> network_;
};

}  // namespace sf::server
