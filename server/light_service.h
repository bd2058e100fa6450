#pragma once
// The traffic lights of a farm that serves: by the world's plans, or as they are heard, and on to the robots as V2I.
//
//   LightService lights(world, {.spat = ...});
//   lights.accept(header, v2i, now);             // what the inbox accepted
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

/// Times `now` [ns] are of one clock that does not go back; simulated time of the plans. The world must outlive it. One
/// thread.
class LightService {
 public:
  static constexpr std::int64_t kPeriod = 100'000'000;  ///< [ns] least between two V2I of an intersection

  /// @param radio [m] beyond which robots are not told of an intersection; 0: none is
  /// @throws netio::PortInUse, base::InputError when the port for SPaT cannot be bound
  LightService(const world::World& world, const LightListenerOptions& options, double radio);

  std::vector<std::uint32_t> ids() const;  ///< of intersections
  void accept(const netio::Header& header, const netio::V2i& signals, std::int64_t now);
  /// Hears what waits, and sets the states at `now`.
  void update(std::int64_t now);
  /// One per row of `World::lights`, at the last `update`.
  std::span<const world::Signal> signals() const { return signals_; }
  /// Queues the states for robots that want those of others, where `kPeriod` has passed.
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
  std::vector<std::optional<glm::dvec2>> places_;  ///< [m] per mover, in one call
  std::optional<std::int64_t> published_;          ///< [ns]
  std::uint64_t sent_ = 0;
};

}  // namespace sf::server
