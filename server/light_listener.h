#pragma once
// Hears the states of real or simulated traffic lights, and keeps those of the world's lights: SPaT messages at a port,
// one J2735 frame per datagram (server/signal_messages.h), and V2I packets that others received.
//
//   LightListener lights(world, roads, {.spat = netio::Endpoint{kLoopback, 9010}});
//   lights.receive(now, utc);
//   lights.accept(header, v2i, now);
//   lights.apply(now, signals);       // replaces planned states by those that were heard
//
// A light that was heard and is silent for two seconds is dark, which robots treat as a stop sign, or follows its plan
// again.

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

/// State of a light that was heard and is silent.
enum class StaleLights : std::uint8_t { dark, plan };

struct LightListenerOptions {
  std::optional<netio::Endpoint> spat;  ///< where to listen for SPaT; nullopt: nowhere
  StaleLights stale = StaleLights::dark;
  std::vector<netio::Peer> peers;  ///< of intersections: SPaT of one with a key is refused, being unsigned
};

struct LightCounts {
  std::uint64_t states = 0;    ///< of lights, that were taken
  std::uint64_t messages = 0;  ///< SPaT with such a state
  std::uint64_t others = 0;    ///< MAP, and SPaT of other intersections
  std::uint64_t invalid = 0;   ///< datagrams that are neither
  std::uint64_t packets = 0;   ///< V2I with such a state
  std::uint64_t refused = 0;   ///< SPaT of an intersection whose peer has a key or another address
  std::uint64_t silences = 0;  ///< times that a light that was heard fell silent
};

/// The world must outlive it. Times `now` are of one clock [ns] that does not go back. One thread.
class LightListener {
 public:
  static constexpr std::int64_t kSilence = 2'000'000'000;  ///< [ns] after which a light is stale

  /// @param roads the world's network; null: none
  /// @throws netio::PortInUse, base::InputError when the address cannot be bound
  LightListener(const world::World& world, const world::RoadNetwork* roads, const LightListenerOptions& options);

  /// Takes all waiting datagrams, up to a limit. @param utc [ms] since 1970
  void receive(std::int64_t now, std::int64_t utc);
  /// One datagram with SPaT.
  void accept(std::span<const std::uint8_t> bytes, const netio::Endpoint& source, std::int64_t now, std::int64_t utc);
  /// An accepted V2I packet.
  void accept(const netio::Header& header, const netio::V2i& signals, std::int64_t now);
  /// Replaces the states of lights that were ever heard. @param signals one per row of `World::lights`
  void apply(std::int64_t now, std::span<world::Signal> signals);

  bool listens() const { return socket_.has_value(); }                  ///< for SPaT
  std::uint16_t port() const { return bound_endpoint(*socket_).port; }  ///< @pre listens()
  const std::vector<Intersection>& intersections() const { return intersections_; }
  const LightCounts& counts() const { return counts_; }

 private:
  static constexpr std::int64_t kNever = -1;
  void hear(std::uint32_t light, const world::Signal& signal, std::int64_t now);
  bool is_refused(const v2x::Spat& spat, const netio::Endpoint& source) const;

  std::vector<Intersection> intersections_;
  LightListenerOptions options_;
  std::vector<world::Signal> signals_;  ///< per light, as it was heard
  std::vector<std::int64_t> heard_;     ///< [ns] per light, or kNever
  std::vector<bool> silent_;            ///< per light
  LightCounts counts_;
  std::optional<netio::Socket> socket_;
  netio::ReceiveBatch batch_;
};

}  // namespace sf::server
