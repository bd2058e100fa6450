#pragma once
// Encodes commands and decodes packets of ARCOS, the firmware of a Pioneer 3 (its operations manual; factors as in
// Player's and ARIA's parameters of the robots). Does not access a serial line or a clock.
//
// A packet, in both directions: 0xFA, 0xFB, number of bytes that follow, payload, checksum (two bytes, high byte
// first). The payload of a command is its number, then the type and the value of its argument. Numbers are
// little-endian.

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "base/bytes.h"

namespace sf::robots {

inline constexpr double kArcosAngle = 2.0 * std::numbers::pi / 4096.0;  ///< [rad] unit of headings
inline constexpr int kArcosTurn = 4096;                                 ///< units of headings in a turn
inline constexpr int kArcosWrap = 4096;                                 ///< positions [units] are compared modulo this
inline constexpr std::size_t kArcosSonars = 16;

enum class ArcosCommand : std::uint8_t {
  pulse = 0,   ///< resets the watchdog, as every command does
  open = 1,    ///< starts the stream of SIPs
  close = 2,   ///< ends the session
  enable = 4,  ///< 1: motors on
  vel = 11,    ///< [mm/s]
  rvel = 21,   ///< [degree/s] counter-clockwise
  sonar = 28,  ///< 1: sonars on
  stop = 29    ///< stops the wheels; the motors stay on
};

/// Returns the payload with header, length and checksum. @param payload 1 to 200 bytes
base::Bytes arcos_packet(std::span<const std::uint8_t> payload);
base::Bytes arcos_command(ArcosCommand command);
/// @param value in [-32767, 32767]
base::Bytes arcos_command(ArcosCommand command, int value);
/// Synchronization packet 0, 1 or 2, which the robot sends back before a session.
base::Bytes arcos_sync(std::uint8_t number);

/// Robot as named in its answer to synchronization packet 2.
struct ArcosName {
  std::string name;     ///< given by its owner
  std::string type;     ///< "Pioneer"
  std::string subtype;  ///< "p3at-sh"
  /// [m] per unit of positions. Robots with older controllers (P3AT without -SH) count parts of a millimetre.
  double distance = 1e-3;
};
std::optional<ArcosName> parse_arcos_name(std::span<const std::uint8_t> payload);

/// Standard server information packet (SIP), sent every 100 ms.
struct ArcosSip {
  int x = 0, y = 0;         ///< [units] since the start of the session, modulo kArcosWrap
  int heading = 0;          ///< [units of kArcosAngle]
  int left = 0, right = 0;  ///< [mm/s] wheels
  double volts = 0.0;       ///< of the battery
  bool left_stall = false, right_stall = false;
  std::array<std::uint8_t, 10> bumpers{};  ///< five in front, then five behind, each from left to right: 1 pressed
  bool motors = false;                     ///< switched on
  bool stop_button = false;                ///< pressed
  std::uint8_t sonar_count = 0;            ///< new ranges
  std::array<std::optional<double>, kArcosSonars> ranges;  ///< [m] new ones only
};
/// @return nullopt if the payload is not a standard SIP or is too short
std::optional<ArcosSip> parse_arcos_sip(std::span<const std::uint8_t> payload);

/// Finds packets in a byte stream with losses and other data.
class ArcosStream {
 public:
  static constexpr std::size_t kMostBytes = 200;  ///< of a payload

  void add(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  /// @return the payload of the next whole packet
  std::optional<base::Bytes> next();
  /// Drops an incomplete packet.
  void reset() { bytes_.clear(); }

  std::uint64_t frames() const { return packets_; }  ///< packets with the right checksum
  std::uint64_t wrong_checksums() const { return wrong_checksums_; }
  std::uint64_t skipped() const { return skipped_; }  ///< bytes that are not part of a packet

 private:
  void skip(std::size_t count);

  base::Bytes bytes_;
  std::uint64_t packets_ = 0, wrong_checksums_ = 0, skipped_ = 0;
};

}  // namespace sf::robots
