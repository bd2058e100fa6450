#pragma once
// States that robots receive from others by V2V, as inputs `v2v` of derived sensors.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/reading.h"
#include "base/report.h"
#include "farm/farm.h"
#include "world/world.h"

namespace sf::farm {

class V2vInputs {
 public:
  /// Adds the farm's inputs that it does not have yet.
  void add(const Farm& farm);
  bool empty() const { return pairs_.empty(); }

  struct Received {
    std::int64_t sent = 0;  ///< [ns]
    std::int64_t time = 0;  ///< [ns] of `state`, no later than now
    base::Report state;
    base::StateQuality quality = {};  ///< without covariance: it is the true state
  };
  /// Returns the newest state of a mover that has reached a receiver; nullopt: none.
  using Newest = std::function<std::optional<Received>(std::uint32_t mover, std::uint32_t receiver)>;

  /// Returns the states received since the last call: each that was sent later than the last one.
  /// @param range [m] between both robots now @param states per mover @param absent per mover
  /// @return valid until the next call
  std::span<const base::ReadingBlock> receive(const world::World& world, double range, const Newest& newest,
                                              std::span<const base::Report> states, const std::vector<bool>& absent);

 private:
  struct Pair {
    Farm::ReceivedInput of;
    std::int64_t last = -1;      ///< [ns] at which the last state was sent
    std::uint32_t received = 0;  ///< number of states
  };
  void add_state(Pair& pair, const Received& received);

  std::vector<Pair> pairs_;
  std::vector<std::array<double, 13>> values_;  ///< of one call: pose, valid, covariance, velocity
  std::vector<base::ReadingBlock> readings_;
};

}  // namespace sf::farm
