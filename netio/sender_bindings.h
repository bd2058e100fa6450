#pragma once
// Binds ids to the addresses that may send for them. Reads no clock: time is always an argument.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/endpoint.h"
#include "netio/packet_status.h"

namespace sf::netio {

inline constexpr std::int64_t kSenderTimeout = 2'000'000'000;  ///< [ns] of silence after which a binding ends

/// Returns whether `sequence` is less than 2^31 ahead of `than`. The counter may wrap (serial number arithmetic, RFC
/// 1982, section 3.2).
inline bool newer(std::uint32_t sequence, std::uint32_t than) { return static_cast<std::int32_t>(sequence - than) > 0; }

/// Bindings for one space of ids (robots or tags). The first sender of an id binds it until two seconds of silence. A
/// packet whose sequence is not newer than the last one of its channel is stale: it is dropped and does not extend the
/// binding. A sender that restarts its count is therefore accepted after two seconds. Each channel (one per packet
/// type) has its own count.
class SenderBindings {
 public:
  static constexpr std::size_t kChannels = 3;

  /// @param ids known ids, in any order
  /// @param take_late of all ids (`set_takes_late`)
  explicit SenderBindings(std::span<const std::uint32_t> ids, bool take_late = false);

  /// Returns the row of `id` in ascending order of ids; nullopt for an unknown id.
  std::optional<std::size_t> row(std::uint32_t id) const;

  /// Returns accepted, wrong_source or stale. @pre `id` is known. `now` [ns] is from any clock that does not decrease.
  PacketStatus admit(std::uint32_t id, std::size_t channel, std::uint32_t sequence, const Endpoint& source,
                     std::int64_t now);

  /// Renews the binding of `id` for a packet whose order does not matter. Returns accepted if `source` was the last
  /// sender, even after a silence; wrong_source while `id` is bound to another sender; stale otherwise. @pre as `admit`
  PacketStatus renew(std::uint32_t id, const Endpoint& source, std::int64_t now);

  /// Ends the binding of `id` to `source`. Returns accepted if it existed (the id is free at once), wrong_source if
  /// `id` is bound to another sender, stale otherwise. Packets from `source` in the next two seconds are stale, because
  /// they were sent earlier.
  PacketStatus leave(std::uint32_t id, const Endpoint& source, std::int64_t now);

  /// Ends the binding of `id`, whose next packet is accepted from any sender. @pre `id` is known
  void forget(std::uint32_t id);

  /// Returns whether a packet of `id` was accepted less than two seconds before `now`. False for unknown ids.
  bool is_active(std::uint32_t id, std::int64_t now) const;

  /// Sets whether overtaken states of `id` are accepted (`InboxOptions::take_late`). @pre `id` is known
  void set_takes_late(std::uint32_t id, bool takes) { bindings_[*row(id)].takes_late = takes; }
  bool takes_late(std::uint32_t id) const { return bindings_[*row(id)].takes_late; }  ///< @pre `id` is known

  /// Returns the last sender for `id`, even if it is silent now; nullopt if there was none or it has left.
  std::optional<Endpoint> source(std::uint32_t id) const;

 private:
  struct Channel {
    std::uint32_t sequence = 0;
    std::optional<std::int64_t> last;  ///< [ns] when its last packet was accepted
  };
  struct Binding {
    std::uint32_t id = 0;
    Endpoint source;
    std::optional<std::int64_t> last;
    Channel channels[kChannels];
    bool takes_late = false;
    Endpoint departed;                        ///< the last sender that left
    std::optional<std::int64_t> departed_at;  ///< [ns] when it left
  };
  std::vector<Binding> bindings_;  ///< sorted by id
};

}  // namespace sf::netio
