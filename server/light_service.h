#pragma once
// The traffic lights of a serving farm. States follow the world's plans or received messages, and are sent to robots as
// V2I.
//
//   LightService lights(world, {.spat = ...});
//   lights.accept(header, v2i, now);             // packets accepted by the inbox
//   lights.update(now);                          // each tick; then lights.signals()
//   lights.publish(now, receiver, states);

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/light_listener.h"
#include "server/v2i_messages.h"
#include "world/roads/network.h"

namespace sf::server {

class StateReceiver;

struct LightServiceCounts {
  LightCounts heard;
  std::uint64_t sent = 0;  ///< V2I packets to robots
};

/// Times `now` [ns] are on one monotonic clock and are the simulated time of the plans. The world must outlive it. Not
/// thread-safe.
class LightService {
 public:
  static constexpr std::int64_t kPeriod = 100'000'000;  ///< [ns] minimum between two V2I of an intersection

  /// @param radio [m] range within which robots receive an intersection's state; 0: no robot does
  /// @throws netio::PortInUse, base::InputError if the port for SPaT cannot be bound
  LightService(const world::World& world, const LightListenerOptions& options, double radio);

  std::vector<std::uint32_t> ids() const;  ///< of intersections
  void accept(const netio::Header& header, const netio::V2i& signals, std::int64_t now);
  /// Processes waiting messages and sets the states at `now`.
  void update(std::int64_t now);
  /// One per row of `World::lights`, as of the last `update`.
  std::span<const world::Signal> signals() const { return signals_; }
  /// Queues the states for robots that subscribed to the states of others, at most once per `kPeriod`.
  void publish(std::int64_t now, StateReceiver& receiver);

  const LightListener& listener() const { return listener_; }
  LightServiceCounts counts() const { return {listener_.counts(), sent_}; }

 private:
  const world::World& world_;
  std::optional<world::RoadNetwork> roads_;
  LightListener listener_;
  V2iMessages messages_;
  double radio_;
  std::vector<world::SignalForecast> forecasts_;
  std::vector<world::Signal> signals_;
  std::vector<std::optional<glm::dvec2>> places_;  ///< [m] per mover, valid within one call
  std::optional<std::int64_t> published_;          ///< [ns]
  std::uint64_t sent_ = 0;
};

}  // namespace sf::server
