#pragma once
// A robot's own end of V2V: one socket that it speaks to the farm from, and hears others on.
//
//   Radio radio({.farm = farm, .robot = 7, .others = ids});
//   radio.send(bytes);                                             // what encode() made
//   radio.receive([&](std::span<const std::uint8_t> bytes) { ... radio.accept(bytes, now, packet); });
//
// One thread. No clock is read.

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "netio/bindings.h"
#include "netio/endpoint.h"
#include "netio/outbox.h"
#include "netio/packets.h"
#include "netio/reason.h"
#include "netio/socket.h"

namespace sf::netio {

struct RadioOptions {
  Endpoint farm;                      ///< that it speaks to, and whose word alone counts
  std::uint32_t robot = 0;            ///< its own id
  std::vector<std::uint32_t> others;  ///< ids of the other robots that the world has
  std::size_t receive_buffer = 1u << 20;
};

class Radio {
 public:
  /// @throws base::InputError when no socket can be opened.
  explicit Radio(const RadioOptions& options);

  /// To the farm, at once.
  void send(std::span<const std::uint8_t> bytes);

  /// Gives `take(std::span<const std::uint8_t> bytes)` all that waits and comes from the farm, as far as it is no
  /// flood: NEIGHBOURS as the V2V that are in them. The rest is counted as Reason::wrong_source.
  template <class Take>
  void receive(Take&& take) {
    constexpr std::size_t kMost = 65'536;
    for (std::size_t taken = 0, n = 1; n > 0 && taken < kMost; taken += n) {
      n = batch_.fill(socket_);
      for (std::size_t i = 0; i < n; ++i) {
        if (batch_.source(i) != options_.farm) {
          counts_.add(Reason::wrong_source);
          continue;
        }
        Packet packet;
        const bool many = decode(batch_.bytes(i), packet) == Reason::accepted && packet.header.type == Type::neighbours;
        if (!many) take(batch_.bytes(i));
        if (many) each_state(std::get<Neighbours>(packet.body), take);
      }
    }
  }

  /// Any bytes that come from the farm at `now` [ns]: V2V of others and START for this robot are accepted and fill
  /// `packet`. What is meant for others is Reason::unknown_robot; old states are stale.
  Reason accept(std::span<const std::uint8_t> bytes, std::int64_t now, Packet& packet);

  /// A state of `robot` was accepted less than two seconds before `now`.
  bool heard(std::uint32_t robot, std::int64_t now) const { return others_.heard(robot, now); }

  const Counts& counts() const { return counts_; }
  const OutboxCounts& sent() const { return outbox_.counts(); }
  const Socket& socket() const { return socket_; }

 private:
  template <class Take>
  static void each_state(const Neighbours& neighbours, Take& take) {
    for (std::size_t at = 0; at < neighbours.states.size(); at += kV2vBytes)
      take(neighbours.states.subspan(at, kV2vBytes));
  }
  Reason judge(const Packet& packet, std::int64_t now);

  RadioOptions options_;
  Socket socket_;
  Outbox outbox_;
  Bindings others_;
  Counts counts_;
  ReceiveBatch batch_;
};

}  // namespace sf::netio
