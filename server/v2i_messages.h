#pragma once
// The traffic lights of a world as V2I packets.
//
//   V2iMessages messages(world, roads);
//   for (std::size_t k = 0; k < messages.intersections().size(); ++k)
//     messages.for_each_packet(k, forecasts, now, [&](const base::Bytes& packet) { outbox.queue(to, packet); });

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "netio/packets.h"
#include "server/signal_messages.h"
#include "world/lights.h"

namespace sf::server {

/// The world must outlive it. Not thread-safe.
class V2iMessages {
 public:
  /// @param roads the world's network; null: none, and packets have no stop lines @param first as `intersections_of`
  V2iMessages(const world::World& world, const world::RoadNetwork* roads, std::uint32_t first = 1);

  const std::vector<Intersection>& intersections() const { return intersections_; }
  /// [m] position of its first light.
  glm::dvec2 position(std::size_t intersection) const;

  /// Sets where a light is that joins.
  void place(std::uint32_t light, const base::Pose& X_WL) { poses_[light] = X_WL; }

  /// Encodes the packets of an intersection; more than 38 lights and stop lines need several.
  /// @param forecasts one per row of `World::lights` @param now [ns] time of the states
  void for_each_packet(std::size_t intersection, std::span<const world::SignalForecast> forecasts, std::int64_t now,
                       const std::function<void(const base::Bytes&)>& take);

 private:
  netio::SignalApproach approach_of(const Intersection& one, std::size_t i,
                                    const world::SignalForecast& forecast) const;

  std::vector<base::Pose> poses_;  ///< per light
  std::vector<Intersection> intersections_;
  std::vector<std::vector<netio::SignalStop>> stops_;  ///< per intersection, by group
  std::vector<std::uint32_t> sent_;                    ///< packets per intersection
  base::Bytes approach_rows_, stop_rows_, packet_;
};

}  // namespace sf::server
