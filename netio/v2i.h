#pragma once
// The rows of V2I packets: the approaches of an intersection with the states of their lights, and its stop lines.
// docs/packets.md specifies every byte.
//
//   base::Bytes approaches, stops;
//   put(SignalApproach{...}, approaches);
//   encode(header, V2i{approaches, stops}, packet);          // netio/packets.h
//   for (std::size_t k = 0; k < count(v2i.approaches); ++k) ... approach_at(v2i, k)

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "base/bytes.h"
#include "base/pose.h"
#include "netio/packet_status.h"

namespace sf::netio {

inline constexpr std::size_t kV2iRowBytes = 32;        ///< [byte] size of an approach, and of a stop line
inline constexpr std::size_t kV2iHeadBytes = 8;        ///< [byte] size of the head before the rows
inline constexpr std::uint8_t kMaxSignalGroup = 254;   ///< groups are in [1, kMaxSignalGroup]
inline constexpr std::uint8_t kSignalStates = 6;       ///< dark, red, yellow, green, flashing red, flashing yellow
inline constexpr std::uint8_t kNoSignalState = 0xFFu;  ///< `SignalApproach::next`: not stated

/// The light of one approach.
struct SignalApproach {
  std::uint8_t group = 1;              ///< in [1, kMaxSignalGroup], unique in its intersection
  std::uint8_t state = 0;              ///< below kSignalStates, in their order
  std::uint8_t next = kNoSignalState;  ///< state after the change
  /// [s] >= 0 until the next change, sent in ms, rounded up; infinity: no change is known
  double left = std::numeric_limits<double>::infinity();
  base::Pose X_WL;  ///< pose of the light, which faces along x; z and yaw have single precision
};

/// The point where a lane ends before an intersection.
struct SignalStop {
  std::uint8_t group = 1;                          ///< group of its approach
  std::uint16_t segment = 0, lane = 0, point = 0;  ///< way-point of the road network
  double x = 0.0, y = 0.0;                         ///< [m] middle of the line, world frame
  double heading = 0.0;                            ///< [rad] driving direction; single precision
  double width = 0.0;                              ///< [m] >= 0, of the lane; single precision
};

/// States of an intersection's lights; `Header::robot` is the intersection's id. Its rows are valid as long as the
/// datagram.
struct V2i {
  std::span<const std::uint8_t> approaches;  ///< at least one row
  std::span<const std::uint8_t> stops;       ///< rows; may be empty
};

inline std::size_t count(std::span<const std::uint8_t> rows) { return rows.size() / kV2iRowBytes; }
SignalApproach approach_at(const V2i& v2i, std::size_t k);
/// Returns the approach with that group; nullopt if there is none.
std::optional<SignalApproach> find_approach(const V2i& v2i, std::uint8_t group);
SignalStop stop_at(const V2i& v2i, std::size_t k);

/// Appends a row. @pre within the limits of docs/packets.md
void put(const SignalApproach& approach, base::Bytes& rows);
void put(const SignalStop& stop, base::Bytes& rows);

/// Reads the payload of a V2I. Fills `v2i` whatever the status is.
PacketStatus read_v2i(std::span<const std::uint8_t> payload, V2i& v2i);
/// Checks that all rows are within the limits.
PacketStatus check(const V2i& v2i);
void put_v2i(const V2i& v2i, base::Bytes& out);

}  // namespace sf::netio
