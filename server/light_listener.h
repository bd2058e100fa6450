#pragma once
// Receives the states of real or simulated traffic lights and stores those of the world's lights. Sources are SPaT
// messages at a port, one J2735 frame per datagram (server/signal_messages.h), and V2I packets that others received.
//
//   LightListener lights(world, roads, {.spat = netio::Endpoint{kLoopback, 9010}});
//   lights.receive(now, utc);
//   lights.accept(header, v2i, now);
//   lights.apply(now, signals);       // replaces planned states by received ones
//
// A light with a received state that is silent for two seconds becomes dark, which robots treat as a stop sign, or
// returns to its plan.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/endpoint.h"
#include "netio/packets.h"
#include "netio/peers.h"
#include "netio/socket.h"
#include "server/signal_messages.h"

namespace sf::server {

/// Selects the state of a light that was received once and is now silent.
enum class StaleLights : std::uint8_t { dark, plan };

struct LightListenerOptions {
  std::optional<netio::Endpoint> spat;  ///< where to receive SPaT; nullopt: nowhere
  StaleLights stale = StaleLights::dark;
  std::vector<netio::Peer> peers;  ///< of intersections; SPaT of one with a key is refused, because it is unsigned
};

struct LightCounts {
  std::uint64_t states = 0;    ///< accepted states of lights
  std::uint64_t messages = 0;  ///< SPaT messages with an accepted state
  std::uint64_t others = 0;    ///< MAP messages, and SPaT of other intersections
  std::uint64_t invalid = 0;   ///< datagrams that are neither
  std::uint64_t packets = 0;   ///< V2I packets with an accepted state
  std::uint64_t refused = 0;   ///< SPaT of intersections whose peer has a key or another address
  std::uint64_t silences = 0;  ///< number of times that a received light became silent
};

/// The world must outlive it. Times `now` [ns] are on one monotonic clock. Not thread-safe.
class LightListener {
 public:
  static constexpr std::int64_t kSilence = 2'000'000'000;  ///< [ns] after which a light is stale

  /// @param roads the world's network; null: none
  /// @throws netio::PortInUse, base::InputError if the address cannot be bound
  LightListener(const world::World& world, const world::RoadNetwork* roads, const LightListenerOptions& options);

  /// Processes waiting datagrams, up to a limit.
  /// @param utc [ms] since 1970
  void receive(std::int64_t now, std::int64_t utc);
  /// Processes one datagram with SPaT.
  void accept(std::span<const std::uint8_t> bytes, const netio::Endpoint& source, std::int64_t now, std::int64_t utc);
  /// Processes an accepted V2I packet.
  void accept(const netio::Header& header, const netio::V2i& signals, std::int64_t now);
  /// Replaces the states of lights that have ever been received, and darkens absent ones.
  /// @param signals one per row of `World::lights`
  void apply(std::int64_t now, std::span<world::Signal> signals);

  /// Returns whether the light is in the world: it is fixed, or it joins and was received within kSilence.
  bool is_present(std::size_t light, std::int64_t now) const;

  bool listens() const { return socket_.has_value(); }                  ///< whether it has a port for SPaT
  std::uint16_t port() const { return bound_endpoint(*socket_).port; }  ///< @pre listens()
  const std::vector<Intersection>& intersections() const { return intersections_; }
  const LightCounts& counts() const { return counts_; }

 private:
  static constexpr std::int64_t kNever = -1;
  void hear(std::uint32_t light, const world::Signal& signal, std::int64_t now);
  bool is_refused(const v2x::Spat& spat, const netio::Endpoint& source) const;

  std::vector<Intersection> intersections_;
  LightListenerOptions options_;
  std::vector<world::Signal> signals_;  ///< last received state per light
  std::vector<std::int64_t> heard_;     ///< [ns] per light, or kNever
  std::vector<bool> silent_;            ///< per light
  std::vector<bool> joins_;             ///< per light: it has a post that is a mover
  LightCounts counts_;
  std::optional<netio::Socket> socket_;
  netio::ReceiveBatch batch_;
};

}  // namespace sf::server
