#pragma once
// The payload of OWN_READINGS packets, by which a robot sends a reading of one of its own sensors, which sense the real
// world alone, to the farm, in parts of one datagram each. docs/packets.md specifies every byte.

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/bytes.h"
#include "netio/packet_status.h"

namespace sf::netio {

inline constexpr std::size_t kOwnReadingsHeadBytes = 16;  ///< [byte] before the words
inline constexpr std::uint32_t kOwnReadingsPart = 310;    ///< most ranges in one packet
inline constexpr std::uint32_t kMostOwnBeams = 1'000'000, kMostOwnTransducers = 64, kMostOwnBumpers = 32;
inline constexpr double kOwnRangeUnit = 1e-4;                ///< [m] of a word
inline constexpr std::uint32_t kNoOwnEcho = 0xFFFFFFFEu;     ///< word: no surface within the sensor's range
inline constexpr std::uint32_t kUnknownRange = 0xFFFFFFFFu;  ///< word: not measured
inline constexpr double kOwnFovUnit = 1e-6;                  ///< [rad] of `OwnReadings::fov`
inline constexpr std::uint32_t kMostOwnFov = 6'283'186;

/// Wire ids of the sensor types whose readings a robot may send.
inline constexpr std::uint8_t kOwnLaser = 1, kOwnSonar = 4, kOwnInfrared = 5, kOwnBumper = 6;

/// Its words are valid as long as the datagram.
struct OwnReadings {
  std::uint8_t type = kOwnLaser;
  std::uint16_t count = 0;  ///< values in this packet
  std::uint32_t total = 0;  ///< values of the whole reading
  std::uint32_t first = 0;  ///< number of the first value in this packet, a multiple of kOwnReadingsPart
  std::uint32_t fov = 0;    ///< [kOwnFovUnit] of a laser, from its first beam to its last; else 0
  std::span<const std::uint8_t>
      words;  ///< u32 each: a range per value; of bumpers one word, bit k: bumper k is pressed
};

/// Returns value `k` of the packet: a range [m], infinite without an echo, NaN if it was not measured; of bumpers 0 or
/// 1.
double value_of(const OwnReadings& readings, std::size_t k);
/// Appends a range [m] as a word: rounded to nearest, infinite as kNoOwnEcho, NaN as kUnknownRange.
void put_own_range(double range, base::Bytes& words);

/// Reads the payload of OWN_READINGS. Fills `readings` whatever the status is.
PacketStatus read_own_readings(std::span<const std::uint8_t> payload, OwnReadings& readings);
/// Checks that the packet is within the limits.
PacketStatus check(const OwnReadings& readings);
void put_own_readings(const OwnReadings& readings, base::Bytes& out);

}  // namespace sf::netio
