#pragma once
// Laser scans as payloads, in three forms; docs/packets.md specifies every byte. Readings are in metres, payloads in
// integer wire units, rounded to nearest (half up). Values saturate at both ends and never wrap.
//
// The first six functions are the wire part of the laser's SensorType. They read only `elements` (samples), `range_min`
// and `limit` (range_max) of a spec.

#include <cstdint>
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/reading.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint32_t kPlainRays = 361;     ///< largest number of rays in the plain and the thesis form
inline constexpr double kPlainRange = 65.535;        ///< [m] largest range of these two forms
inline constexpr std::uint32_t kPartRays = 310;      ///< rays of each extended part except the last
inline constexpr std::size_t kPartHeaderBytes = 16;  ///< size before the rays of an extended part
inline constexpr std::size_t kPartBytes = kPartHeaderBytes + 4 * kPartRays;  ///< size of the longest payload
inline constexpr std::uint32_t kExtendedRays = 1'000'000;                    ///< largest number of rays in a scan
inline constexpr std::uint32_t kNoReturn = 0xFFFFFFFFu;                      ///< extended word for an infinite range

/// Returns the reason why `wire` cannot carry this laser's scans, with a remedy; empty if it can.
std::string laser_wire_problem(const SensorSpec& sensor, WireFormat wire);

/// Returns the number of datagrams per scan. Up to 361 rays of up to 65.535 m are sent plain, in one datagram.
std::uint32_t laser_parts(const SensorSpec& sensor, WireFormat wire);

/// Appends payload `part` in [0, laser_parts) of a scan.
/// @param scan its values are ranges [m]: negative ones become 0, infinity means no return
/// @return the payload's type; 0, with nothing appended, when a range of this part is NaN
std::uint8_t encode_laser(const SensorSpec& sensor, const base::ReadingBlock& scan, WireFormat wire, std::uint32_t part,
                          base::Bytes& out);

/// Implements SensorType::wire_error: half a millimetre, or a twentieth of one in the extended form; up to twice as
/// much for a range that is received as a limit (WireLimits).
double laser_wire_error(const SensorSpec& sensor, const base::ReadingBlock& scan);

/// Validates a payload against this laser: equal number of rays, none beyond range_max by more than 1 mm (except
/// saturated words and no return). A spec with 0 elements or limit 0 disables the respective check.
PayloadPart decode_laser(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                         WireFormat wire);

/// Fills in this part's ranges of a scan's `values`, from a payload that `decode_laser` accepted. A word at or beyond
/// the word of range_max or range_min becomes that limit. A saturated plain word becomes infinity for a laser of
/// smaller range.
void fill_laser(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
                std::span<double> values);

/// Words of the extended form, for ranges in [m]; infinity is no return.
std::uint32_t extended_range_word(double metres);
double extended_range(std::uint32_t word);
/// Returns the range that a receiver reads for the number of an extended word [m].
double read_range(const SensorSpec& sensor, double metres);

/// A decoded payload: a whole scan, or one part of an extended one.
struct LaserPart {
  std::uint32_t total = 0;  ///< rays of the whole scan, in [1, kExtendedRays]
  std::uint32_t first = 0;  ///< index of this part's first ray
  std::uint32_t count = 0;  ///< rays in this part
  std::uint16_t part = 0;
  std::uint16_t parts = 1;
  bool extended = false;
  std::span<const std::uint8_t> words;  ///< `count` words of 2 bytes, or 4 if extended; view of the payload
};

/// Accepts any bytes. A payload of the thesis format is a plain payload.
PayloadError read_laser(std::span<const std::uint8_t> payload, bool extended, LaserPart& scan);

/// Returns the range [m] of ray `i` in [0, scan.count); infinity for no return.
double range_of(const LaserPart& scan, std::uint32_t i);

}  // namespace sf::sensors
