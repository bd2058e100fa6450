#pragma once
// Result of checking a datagram, and counts of the results.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sf::netio {

// Each status: its enumerator, its text in tables and summaries, and its meaning. Each datagram gets exactly one
// status: the first that applies, in this order. A macro keeps the enumerators, the texts and their number consistent.
// clang-format off
#define SF_PACKET_STATUSES(X) \
  X(accepted, "accepted")               /* not dropped */ \
  X(too_short, "too short")             /* shorter than its header or its type requires */ \
  X(bad_magic, "bad magic")             /* does not start with "SFPK" */ \
  X(unknown_version, "unknown version") /* other than version 2 */ \
  X(unknown_type, "unknown type")       /* a type number unknown to this version */ \
  X(too_long, "too long")               /* longer than its type allows */ \
  X(not_finite, "not finite")           /* contains NaN or infinity */ \
  X(out_of_range, "out of range")       /* contains a number outside the range in docs/packets.md */ \
  X(wrong_direction, "wrong direction") /* a reading sent to the farm, or a state sent to a receiver of readings */ \
  X(unknown_robot, "unknown robot")     /* a robot id that the world does not have */ \
  X(unknown_tag, "unknown tag")         /* a tag id that the world does not have */ \
  X(unknown_light, "unknown light")     /* an intersection id that the world does not have */ \
  X(not_signed, "not signed")           /* has no signature, but the table of peers has a key */ \
  X(wrong_signature, "wrong signature") /* signed with another key, or changed in transit */ \
  X(replayed, "replayed")               /* its signature is valid, but was received before or is too old */ \
  X(unproven, "unproven")               /* lacks the token of its address; answered with a CHALLENGE */ \
  X(wrong_source, "wrong source")       /* its id belongs to another sender or address, its port to another sensor, or its farm is not selected */ \
  X(stale, "stale")                     /* its sequence is not newer than the last accepted one */
// clang-format on

/// The statuses of SF_PACKET_STATUSES.
enum class PacketStatus : std::uint8_t {
#define SF_ENUMERATOR(status, text) status,
  SF_PACKET_STATUSES(SF_ENUMERATOR)
#undef SF_ENUMERATOR
};
#define SF_ONE(status, text) +1
inline constexpr std::size_t kPacketStatuses = SF_PACKET_STATUSES(SF_ONE);
#undef SF_ONE

/// Returns the text for tables and summaries: "too short", "bad magic", ...
std::string_view name(PacketStatus status);

/// Number of datagrams per status.
struct PacketCounts {
  std::array<std::uint64_t, kPacketStatuses> of{};

  void add(PacketStatus status) { ++of[static_cast<std::size_t>(status)]; }
  std::uint64_t operator[](PacketStatus status) const { return of[static_cast<std::size_t>(status)]; }
  std::uint64_t total() const;
  std::uint64_t dropped() const { return total() - (*this)[PacketStatus::accepted]; }
};

/// Returns the non-zero counts, such as "accepted 12, too short 1, stale 3"; "nothing received" if all are zero.
std::string packet_counts_text(const PacketCounts& counts);

}  // namespace sf::netio
