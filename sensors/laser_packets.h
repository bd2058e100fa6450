#pragma once
// Laser scans as payloads, in three forms; docs/packets.md gives every byte. Ranges are metres here and whole wire
// units there, rounded to nearest (half up); they saturate at both ends and never wrap.
//
// The first five are the wire part of the laser's SensorKind. Of its rows they read `elements` (samples) and `limit`
// (range_max).

#include <cstdint>
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/reading.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint32_t kPlainRays = 361;           ///< most rays of the plain and of the thesis' form
inline constexpr double kPlainRange = 65.535;              ///< [m] largest range of these two
inline constexpr std::uint32_t kPartRays = 310;            ///< rays of every extended part but the last
inline constexpr std::uint32_t kExtendedRays = 1'000'000;  ///< most rays of a scan
inline constexpr std::uint32_t kNoReturn = 0xFFFFFFFFu;    ///< extended word of an infinite range

/// Why `wire` cannot carry this laser's scans and what to do; empty when it can.
std::string laser_wire_problem(const SensorSpec& sensor, WireFormat wire);

/// Datagrams that one scan takes. At most 361 rays of at most 65.535 m are sent plain, in one.
std::uint32_t laser_parts(const SensorSpec& sensor, WireFormat wire);

/// Appends payload `part` in [0, laser_parts) of a scan. @return its type, or 0, with nothing appended, when a range of
/// this part is NaN.
/// @param scan its values are ranges [m]: negative ones become 0, infinity is no return
std::uint8_t encode_laser(const SensorSpec& sensor, const base::ReadingBlock& scan, WireFormat wire, std::uint32_t part,
                          base::Bytes& out);

/// Takes a payload for what this laser may have sent: as many rays, none farther than range_max by more than 1 mm
/// (saturated words and no return aside). A row of no elements, or of no limit, leaves that unchecked.
PayloadPart decode_laser(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                         WireFormat wire);

/// Fills in this part's ranges of a scan's `values`, from a payload that `decode_laser` took. A saturated plain word is
/// infinite where the laser cannot see as far as it says.
void fill_laser(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
                std::span<double> values);

/// A receiver's view of a payload: a whole scan, or one part of an extended one.
struct LaserPart {
  std::uint32_t total = 0;  ///< rays of the whole scan, in [1, kExtendedRays]
  std::uint32_t first = 0;  ///< ray that this part begins with
  std::uint32_t count = 0;  ///< rays in this part
  std::uint16_t part = 0;
  std::uint16_t parts = 1;
  bool extended = false;
  std::span<const std::uint8_t> words;  ///< `count` words, 2 bytes each, or 4 when extended; alive with the payload
};

/// Any bytes give a part or a fault. The thesis' datagram is a plain payload.
PayloadError read_laser(std::span<const std::uint8_t> payload, bool extended, LaserPart& scan);

/// [m] of ray `i` of [0, scan.count); infinity for no return.
double range_of(const LaserPart& scan, std::uint32_t i);

}  // namespace sf::sensors
