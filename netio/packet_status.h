#pragma once
// Result of checking a datagram, and counts of the results.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sf::netio {

/// Each datagram gets exactly one status: the first that applies, in this order.
enum class PacketStatus : std::uint8_t {
  accepted,         ///< not dropped
  too_short,        ///< shorter than its header or its type requires
  bad_magic,        ///< does not start with "SFPK"
  unknown_version,  ///< other than version 2
  unknown_type,     ///< a type number unknown to this version
  too_long,         ///< longer than its type
  not_finite,       ///< contains NaN or infinity
  out_of_range,     ///< contains a number outside the range in docs/packets.md
  wrong_direction,  ///< a reading sent to the farm, or a state sent to a receiver of readings
  unknown_robot,    ///< a robot id that the world does not have
  unknown_tag,      ///< a tag id that the world does not have
  unknown_light,    ///< an intersection id that the world does not have
  not_signed,       ///< without a signature, where the table of peers has a key
  wrong_signature,  ///< signed with another key, or changed on its way
  replayed,         ///< its signature is valid and came before, or is too old
  unproven,         ///< without the token of its address; answered by a CHALLENGE
  wrong_source,  ///< the id is bound to another sender or address, the packet came to another sensor's port, or it is
                 ///< not from the selected farm
  stale,         ///< its sequence is not newer than the last accepted one
};
inline constexpr std::size_t kPacketStatuses = 18;

/// Text for tables and summaries: "too short", "bad magic", ...
std::string_view name(PacketStatus status);

/// Number of datagrams per status.
struct PacketCounts {
  std::array<std::uint64_t, kPacketStatuses> of{};

  void add(PacketStatus status) { ++of[static_cast<std::size_t>(status)]; }
  std::uint64_t operator[](PacketStatus status) const { return of[static_cast<std::size_t>(status)]; }
  std::uint64_t total() const;
  std::uint64_t dropped() const { return total() - (*this)[PacketStatus::accepted]; }
};

/// Non-zero counts, such as "accepted 12, too short 1, stale 3"; "nothing received" without datagrams.
std::string text(const PacketCounts& counts);

}  // namespace sf::netio
