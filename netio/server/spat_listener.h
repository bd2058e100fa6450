#pragma once
// Hears SPaT messages of real or simulated traffic lights, one J2735 frame per datagram, and keeps the states of the
// world's lights that they name (netio/server/signal_messages.h).
//
//   SpatListener lights(world, roads, {kLoopback, 9010});
//   lights.receive(now, utc);
//   lights.apply(now, signals);       // replaces planned states by those that were heard
//
// A light that was heard and is silent for two seconds is dark, which robots treat as a stop sign.

#include <cstdint>
#include <span>
#include <vector>

#include "netio/endpoint.h"
#include "netio/server/signal_messages.h"
#include "netio/socket.h"

namespace sf::server {

struct SpatCounts {
  std::uint64_t states = 0;    ///< of lights, that were taken
  std::uint64_t messages = 0;  ///< SPaT with such a state
  std::uint64_t others = 0;    ///< MAP, and SPaT of other intersections
  std::uint64_t invalid = 0;   ///< datagrams that are neither
};

/// The world must outlive it. Times `now` are of one clock [ns] that does not go back. One thread.
class SpatListener {
 public:
  static constexpr std::int64_t kSilence = 2'000'000'000;  ///< [ns] after which a light is dark

  /// @param roads the world's network; null: none
  /// @throws netio::PortInUse, base::InputError when the address cannot be bound
  SpatListener(const world::World& world, const world::RoadNetwork* roads, const netio::Endpoint& bind);

  /// Takes all waiting datagrams, up to a limit. @param utc [ms] since 1970
  void receive(std::int64_t now, std::int64_t utc);
  /// One datagram.
  void accept(std::span<const std::uint8_t> bytes, std::int64_t now, std::int64_t utc);
  /// Replaces the states of lights that were ever heard. @param signals one per row of `World::lights`
  void apply(std::int64_t now, std::span<world::Signal> signals) const;

  std::uint16_t port() const { return bound_endpoint(socket_).port; }
  const SpatCounts& counts() const { return counts_; }

 private:
  static constexpr std::int64_t kNever = -1;

  std::vector<Intersection> intersections_;
  std::vector<world::Signal> signals_;  ///< per light, as it was heard
  std::vector<std::int64_t> heard_;     ///< [ns] per light, or kNever
  SpatCounts counts_;
  netio::Socket socket_;
  netio::ReceiveBatch batch_;
};

}  // namespace sf::server
