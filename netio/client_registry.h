#pragma once
// Who may speak for which id, and since when they have been silent. No clock is read here: time is always passed in.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/endpoint.h"
#include "netio/packet_status.h"

namespace sf::netio {

inline constexpr std::int64_t kClientTimeout = 2'000'000'000;  ///< [ns] after exactly this long a sender is silent

/// Less than 2^31 ahead: the counter may wrap (serial number arithmetic, RFC 1982, section 3.2).
inline bool newer(std::uint32_t sequence, std::uint32_t than) { return static_cast<std::int32_t>(sequence - than) > 0; }

/// The rule, for one space of ids (robots, or tags): the first sender of an id binds it until two seconds of silence.
/// A packet whose sequence is not newer than the last of its line is stale; it neither keeps the binding nor is used,
/// so a sender that starts its count again is taken after two seconds. Lines (one per packet type) count apart.
class ClientRegistry {
 public:
  static constexpr std::size_t kChannels = 2;

  /// @param ids that exist, in any order.
  explicit ClientRegistry(std::span<const std::uint32_t> ids);

  /// Position of `id` among the ids in ascending order; nothing for an id that does not exist.
  std::optional<std::size_t> row(std::uint32_t id) const;

  /// accepted, wrong_source or stale; of a known id only. `now` [ns] on any clock that does not go back.
  PacketStatus admit(std::uint32_t id, std::size_t channel, std::uint32_t sequence, const Endpoint& source,
                     std::int64_t now);

  /// `source` speaks for `id` no longer: accepted where it did (the id is free at once), wrong_source where another
  /// does, else stale. What comes from `source` for two seconds then is stale: it was overtaken.
  PacketStatus leave(std::uint32_t id, const Endpoint& source, std::int64_t now);

  /// A packet of `id` was accepted less than two seconds before `now`. False for unknown ids.
  bool is_active(std::uint32_t id, std::int64_t now) const;

  /// Who spoke last for `id`, be it silent since; nothing when it was never heard, or left.
  std::optional<Endpoint> source(std::uint32_t id) const;

 private:
  struct Channel {
    std::uint32_t sequence = 0;
    std::optional<std::int64_t> last;  ///< [ns] when a packet of it was accepted
  };
  struct Client {
    std::uint32_t id = 0;
    Endpoint source;
    std::optional<std::int64_t> last;
    Channel channels[kChannels];
    Endpoint departed;                        ///< who left last
    std::optional<std::int64_t> departed_at;  ///< [ns] when
  };
  std::vector<Client> clients_;  ///< by id
};

}  // namespace sf::netio
