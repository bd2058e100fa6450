#pragma once
// Laser scans as datagrams, in three forms. Ranges are metres here and whole wire units there, rounded to nearest (half
// up); they saturate at both ends and never wrap. A scan with a NaN is never sent: the functions say false and the
// caller counts it.

#include <cstdint>
#include <span>
#include <string>

#include "base/bytes.h"
#include "netio/packets.h"
#include "netio/reason.h"

namespace sf::netio {

inline constexpr std::uint32_t kLaserRays = 361;  ///< most rays of the plain and of the thesis form
inline constexpr double kLaserRange = 65.535;     ///< [m] largest range of these two
inline constexpr std::uint32_t kPartRays = 340;   ///< rays of every extended part but the last
inline constexpr std::uint32_t kExtendedRays = 1'000'000;
inline constexpr std::uint32_t kNoReturn =
    0xFFFFFFFFu;  ///< extended word of a beam that met nothing (an infinite range)

/// Which bytes a sensor's readings are sent as.
enum class Wire { farm, thesis };

/// LASER and the thesis' form hold it; otherwise LASER_EXTENDED is sent.
/// @param range_max [m] of the sensor
bool fits_plain(std::uint32_t samples, double range_max);

/// Datagrams that one scan takes.
std::uint32_t laser_parts(Wire wire, std::uint32_t samples, double range_max);

/// @throws base::InputError naming `sensor` when `wire` cannot carry its scans. Call once per sensor at load.
void require_wire(Wire wire, std::uint32_t samples, double range_max, const std::string& sensor);

/// Datagram `part` of [0, laser_parts) of a scan: replaces what `out` holds. The header's type is set here.
/// False, with `out` empty, when a range of this part is NaN.
/// @param ranges [m] in order of bearing from -fov/2 to +fov/2; negative ones become 0, infinity is no return
bool encode_laser(Wire wire, const Header& header, std::span<const double> ranges, double range_max, std::uint32_t part,
                  base::Bytes& out);

/// [m] of ray `i` of [0, scan.count); infinity for no return.
double range(const LaserPart& scan, std::uint32_t i);

/// Payloads, without the header: any bytes give a scan or a reason. The thesis' datagram is exactly a LASER's payload.
Reason read_laser(std::span<const std::uint8_t> payload, LaserPart& scan);
Reason read_laser_extended(std::span<const std::uint8_t> payload, LaserPart& scan);

}  // namespace sf::netio
