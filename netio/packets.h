#pragma once
// The farm's packets as values, and their bytes. docs/packets.md gives every byte and every limit; this is its code.
//
// What a reading's payload says is its sensor kind's business: here it is any bytes behind a header.
// Decoding is total: any bytes give a packet or one PacketStatus. Encoding is for those who keep the limits: a value
// that the decoder would refuse is our bug and aborts.

#include <array>
#include <cstdint>
#include <span>
#include <variant>

#include "base/bytes.h"
#include "base/pose.h"
#include "base/report.h"
#include "netio/packet_status.h"

namespace sf::netio {

inline constexpr std::array<std::uint8_t, 4> kMagic = {'S', 'F', 'P', 'K'};
inline constexpr std::uint8_t kVersion = 2;
inline constexpr std::size_t kHeaderBytes = 64;
inline constexpr std::size_t kMaxDatagram = 1400;  ///< [byte] no packet of ours is longer, so none is fragmented
inline constexpr std::size_t kMaxTrailer = 80;     ///< [byte] kept free for a signature behind the payload
inline constexpr std::size_t kMaxPayload = kMaxDatagram - kHeaderBytes - kMaxTrailer;  ///< [byte]
inline constexpr std::size_t kMaxHeaderlessDatagram = 2046;      ///< [byte] but for the thesis' halves of a map
inline constexpr std::uint32_t kMaxId = 0xFFFFu;                 ///< of a robot, and of a sensor
inline constexpr std::uint16_t kBroadcastId = 0xFFFFu;           ///< START: every robot, and not the one with this id
inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;              ///< V2V: follows nobody, heads for no checkpoint
inline constexpr std::uint32_t kMinTag = 1;                      ///< tags are 1 to kMaxId; the thesis has 1 to 32
inline constexpr double kMaxPosition = 1e7;                      ///< [m] of each coordinate: every UTM coordinate fits
inline constexpr double kMaxYaw = 1e6;                           ///< [rad] a heading that was never wrapped
inline constexpr double kMaxSpeed = 1e3;                         ///< [m/s], and [rad/s]
inline constexpr std::int64_t kMaxTime = std::int64_t{1} << 62;  ///< [ns] 146 years: differences cannot overflow

/// From 128: states and requests sent to the farm, of which it passes V2V and START on. Below 64: a reading of the
/// sensor kind with that number; 64 more: its second form.
enum class Type : std::uint8_t {
  v2v = 128,
  tag = 129,
  subscribe = 130,
  start = 131,
  leave = 132,
  challenge = 133,
  neighbours = 140
};

/// The sensor kind in [1, 63] whose readings, of either form, are sent as `type`; 0 when it is no reading's.
constexpr std::uint8_t kind_of(Type type) {
  const auto number = static_cast<std::uint8_t>(type);
  return number < 128 ? number % 64 : std::uint8_t{0};
}

struct Header {
  Type type = Type::v2v;
  std::uint16_t robot = 0;     ///< whose reading or state; in a TAG the tag's id
  std::uint16_t sensor = 0;    ///< 0-based among the robot's sensors of this kind; 0 in states
  std::uint32_t sequence = 0;  ///< counts up by one per message sent of this type (and sensor), wraps to 0
  std::int64_t time = 0;       ///< [ns] in [0, kMaxTime]: when it was measured, not when it was sent
  std::uint16_t accuracy = 0;  ///< of readings: an accuracy word, below; 0: not said
  std::uint32_t session = 0;   ///< of its sender: a random number that it draws when it starts; 0: not said
  std::uint32_t token = 0;     ///< to the farm: what its CHALLENGE gave; from the farm: the receiver's session
};

/// How a reading was measured, in 16 bits: mode in bits 0 to 3, `unsure` in bit 4, and above these k in [1, 2047]: a
/// bound of 2^((k - 1024) / 16), rounded up by at most 4.5 %; k = 0: none is stated.
struct Accuracy {
  std::uint8_t mode = 0;  ///< row of the kind's modes, in [0, 15]
  bool unsure = false;  ///< for some element the bound does not hold: by the mode's own rule, or since its beam grazes
  double bound = 0.0;   ///< [unit of the first column]; infinite: none is stated
};
/// Bounds of 0 and infinite ones are not stated; others saturate at 2^-63 and 2^63.
std::uint16_t encode_accuracy(const Accuracy& accuracy);
Accuracy decode_accuracy(std::uint16_t word);

/// A robot says where it is.
struct V2v {
  base::Pose X_WR;                   ///< the robot in the world
  base::Twist velocity;              ///< in the robot's own frame
  std::uint32_t follows = kNone;     ///< robot id in [0, kMaxId], or kNone
  std::uint32_t checkpoint = kNone;  ///< any number, or kNone
  bool docking = false;
};

/// An overhead camera says where a tag is. All in the world frame.
struct Tag {
  std::array<double, 3> position{};               ///< [m]
  std::array<double, 4> orientation{0, 0, 0, 1};  ///< unit quaternion x, y, z, w; its norm within 0.001 of 1
  std::array<double, 3> linear{};                 ///< [m/s]
  std::array<double, 3> angular{};                ///< [rad/s]
};

/// A robot asks for readings without moving anything.
struct Subscribe {
  std::uint32_t kinds =
      0;  ///< bit k: sensor kind k; bit 0: others' states, see kNeighboursBit; 0: all kinds, but not these
};
inline constexpr std::uint32_t kNeighboursBit = 1;  ///< the bit of SUBSCRIBE that asks for what other robots say

/// The signal to begin, to the robot that the header names or to kBroadcastId.
struct Start {};

/// A robot's last word: it will not be heard again, and its id is free.
struct Leave {};

/// The farm's answer to an address that has not proven itself: packets from there count once they carry the token.
struct Challenge {
  std::uint32_t token = 0;
};

inline constexpr std::size_t kV2vBytes = kHeaderBytes + 68;             ///< of a whole V2V
inline constexpr std::size_t kMaxNeighbours = kMaxPayload / kV2vBytes;  ///< V2V in one NEIGHBOURS
inline constexpr double kV2vRange = 50.0;  ///< [m] how far the farm passes V2V on, unless told otherwise

/// The farm passes on what other robots said: whole V2V datagrams, one after another.
struct Neighbours {
  std::span<const std::uint8_t> states;  ///< 1 to kMaxNeighbours of kV2vBytes, not looked into; live like the datagram
};

/// A sensor's reading, or a part of one; its kind reads it.
struct Reading {
  std::span<const std::uint8_t> payload;  ///< lives as long as the datagram
};

struct Packet {
  Header header;
  std::variant<V2v, Tag, Subscribe, Start, Leave, Challenge, Neighbours, Reading> body;
};

/// Reads any bytes. Fills `packet` only when the answer is PacketStatus::accepted.
PacketStatus decode(std::span<const std::uint8_t> bytes, Packet& packet);

/// Replace what `out` holds; its capacity is kept. The header's type is set by the function.
void encode(const Header& header, const V2v& state, base::Bytes& out);
void encode(const Header& header, const Tag& state, base::Bytes& out);
void encode(const Header& header, const Subscribe& request, base::Bytes& out);
void encode(const Header& header, const Start& signal, base::Bytes& out);
void encode(const Header& header, const Leave& word, base::Bytes& out);
void encode(const Header& header, const Challenge& challenge, base::Bytes& out);
void encode(const Header& header, const Neighbours& neighbours, base::Bytes& out);

/// A reading of type `type`, one of a sensor kind's two; replaces what `out` holds.
/// Rule: the payload takes at most kMaxPayload.
void encode_reading(const Header& header, std::uint8_t type, std::span<const std::uint8_t> payload, base::Bytes& out);

/// Appends the 64 bytes that every packet begins with. Age, covariance and trailer are reserved: 0.
void put_header(const Header& header, base::ByteWriter& writer);

/// The two fields of a header that differ by receiver.
struct SessionToken {
  std::uint32_t session = 0;
  std::uint32_t token = 0;
};
/// Writes both into an encoded packet.
void write_session_token(std::span<std::uint8_t> packet, const SessionToken& session_token);

/// The state of world mover `mover`, as the farm takes it in. A tag's tilt is left out; its velocity becomes that of
/// the mover, in the mover's own frame. @param X_MT the tag in the mover's frame
base::Report report(const Header& header, const V2v& state, std::uint32_t mover);
base::Report report(const Header& header, const Tag& state, std::uint32_t mover, const base::Pose& X_MT = {});

}  // namespace sf::netio
