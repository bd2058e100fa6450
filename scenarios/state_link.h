#pragma once
// Simulates the transmission of robots' states to the farm: at a rate, with delay, loss and noise.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/report.h"
#include "netio/link_model.h"
#include "server/state_filter.h"
#include "world/world.h"

namespace sf::scenarios {

struct StateLinkOptions {
  double rate = 10.0;           ///< [Hz] > 0, at most one state per tick
  netio::LinkModel link;        ///< applied to every state
  double position_sigma = 0.0;  ///< [m] noise of reported positions, along x and y
  double yaw_sigma = 0.0;       ///< [rad] noise of reported yaw
  bool filter = false;  ///< as `serve --filter`, with the link's delay as minimum delay, and stale one second after its
                        ///< maximum; false: as `serve --raw`
};

/// The states of a fleet as received by a farm. Messages of one tick are processed at their own times of arrival. Not
/// thread-safe.
class StateLink {
 public:
  StateLink(const world::World& world, const StateLinkOptions& options);

  /// Adds the mover that was appended to the world.
  /// @param state assumed by the farm until its first message
  void add_mover(const base::Report& state);

  /// Reports the true states at `time` [ns] if due, and returns the states that the farm assumes.
  /// @param truth one per mover; tags are passed through
  /// @return one per mover, at `time`; valid until the next call
  std::span<const base::Report> pass(std::int64_t time, std::span<const base::Report> truth);

 private:
  struct Message {
    std::int64_t arrival = 0;  ///< [ns]
    std::uint32_t sequence = 0;
    base::Report report;  ///< at its time of sending
  };
  void send(std::int64_t time, std::span<const base::Report> truth);
  void take(const Message& message);

  const world::World& world_;
  StateLinkOptions options_;
  server::StateFilter filter_;
  std::uint32_t sent_ = 0;  ///< states per robot
  std::vector<Message> on_the_way_;
  std::vector<base::Report> newest_;                     ///< per mover, at the time of arrival
  std::vector<std::optional<std::uint32_t>> sequences_;  ///< per mover, of `newest_`
  std::vector<base::Report> known_;
};

}  // namespace sf::scenarios
