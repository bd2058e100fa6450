#pragma once
// Why a stranger's datagram was dropped, and how often.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sf::netio {

/// Every datagram ends in exactly one of these. The first that applies, in this order, is the one counted.
enum class PacketStatus : std::uint8_t {
  accepted,         ///< not dropped
  too_short,        ///< fewer bytes than its header or its type asks for
  bad_magic,        ///< does not begin with "SFPK"
  unknown_version,  ///< not version 2
  unknown_type,     ///< a type number that this version does not have
  too_long,         ///< more bytes than its type has
  not_finite,       ///< a NaN or an infinity among its numbers
  out_of_range,     ///< a number outside the range that docs/packets.md gives
  wrong_direction,  ///< a reading sent to the farm, or a state to a listener
  unknown_robot,    ///< a robot id that the world does not have
  unknown_tag,      ///< a tag id that the world does not have
  unproven,         ///< it does not carry its address' token: a CHALLENGE was due
  wrong_source,  ///< the id is bound to another sender, it came to another sensor's port, or not from the farm that is
                 ///< listened to
  stale,         ///< its sequence is not newer than one already taken
};
inline constexpr std::size_t kPacketStatuses = 14;

/// "too short", "bad magic", ...: words for a table or a summary.
std::string_view name(PacketStatus status);

/// How many datagrams ended in each reason.
struct PacketCounts {
  std::array<std::uint64_t, kPacketStatuses> of{};

  void add(PacketStatus status) { ++of[static_cast<std::size_t>(status)]; }
  std::uint64_t operator[](PacketStatus status) const { return of[static_cast<std::size_t>(status)]; }
  std::uint64_t total() const;
  std::uint64_t dropped() const { return total() - (*this)[PacketStatus::accepted]; }
};

/// "accepted 12, too short 1, stale 3": those that happened; "nothing received" where none did.
std::string text(const PacketCounts& counts);

}  // namespace sf::netio
