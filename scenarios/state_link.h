#pragma once
// The states of robots on their way to the farm, in a simulation: reported at a rate, late, lost, with noise.

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
  netio::LinkModel link;        ///< of every state
  double position_sigma = 0.0;  ///< [m] noise of reported positions, along x and y
  double yaw_sigma = 0.0;       ///< [rad] likewise of yaw
  bool filter = false;          ///< as `serve --filter`, with the link's delay as least delay, and stale one
                                ///< second beyond its largest; false: as `serve` without
};

/// The states of a fleet as a farm receives them. Messages of one tick are taken at their own times of arrival. One
/// thread.
class StateLink {
 public:
  StateLink(const world::World& world, const StateLinkOptions& options);

  /// The world has got one more mover, in its last row. @param state as the farm assumes it until its first message
  void add_mover(const base::Report& state);

  /// Reports the true states of time `time` [ns], as far as they are due, and returns those that the farm assumes.
  /// @param truth one per mover; tags are passed through
  /// @return likewise, at `time`; lives until the next call
  std::span<const base::Report> pass(std::int64_t time, std::span<const base::Report> truth);

 private:
  struct Message {
    std::int64_t arrival = 0;  ///< [ns]
    std::uint32_t sequence = 0;
    base::Report report;  ///< at the time of its sending
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
