#pragma once
// States that robots receive from others by V2V, as inputs `v2v` of derived sensors: within netio::kV2vRange, as
// `serve` relays them. With [v2v], each broadcast when it has arrived; otherwise the others' states at each tick.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/reading.h"
#include "farm/farm.h"
#include "scenarios/v2v_link.h"
#include "world/world.h"

namespace sf::scenarios {

class V2vInputs {
 public:
  /// Adds the farm's inputs that it does not have yet.
  void add(const farm::Farm& farm);
  bool empty() const { return links_.empty(); }

  /// Returns the states received since the last call. Called at each tick, at `time` [ns].
  /// @param link null: V2V is current @param current returns what a mover broadcasts now
  /// @param states per mover @param absent per mover @return valid until the next call
  std::span<const base::ReadingBlock> receive(std::int64_t time, const world::World& world, const V2vLink* link,
                                              const std::function<Broadcast(std::uint32_t mover)>& current,
                                              std::span<const base::Report> states, const std::vector<bool>& absent);

 private:
  struct Pair {
    farm::Farm::ReceivedInput of;
    std::int64_t last = -1;      ///< [ns] time of the last state
    std::uint32_t received = 0;  ///< number of states
  };
  void add_state(Pair& pair, std::int64_t time, const Broadcast& broadcast);

  std::vector<Pair> links_;
  std::vector<std::array<double, 13>> values_;  ///< of one tick: pose, valid, covariance, velocity
  std::vector<base::ReadingBlock> readings_;
};

}  // namespace sf::scenarios
