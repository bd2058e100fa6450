#pragma once
// The farm's packets as values, with their encoding and decoding. docs/packets.md specifies every byte and limit.
//
// The payload of a reading is defined by its sensor type; here it is a sequence of bytes behind a header. Decoding
// accepts any bytes and returns a packet or one PacketStatus. Encoding requires values within the limits: a value that
// the decoder would reject is a programming error and aborts.

#include <array>
#include <cstdint>
#include <span>
#include <variant>

#include "base/bytes.h"
#include "base/pose.h"
#include "base/report.h"
#include "base/state_quality.h"
#include "netio/lockstep_packets.h"
#include "netio/packet_status.h"
#include "netio/v2i.h"

namespace sf::netio {

inline constexpr std::array<std::uint8_t, 4> kMagic = {'S', 'F', 'P', 'K'};
inline constexpr std::uint8_t kVersion = 2;
inline constexpr std::size_t kHeaderBytes = 64;
inline constexpr std::size_t kMaxDatagram = 1400;  ///< [byte] of the farm's packets, which avoids fragmentation
inline constexpr std::size_t kVersionAt = 4, kTypeAt = 5, kRobotAt = 6;  ///< [byte] in the header; robot: u16
inline constexpr std::size_t kTrailerAt = 60;   ///< [byte] place of the trailer's size, u16, in the header
inline constexpr std::size_t kMaxTrailer = 80;  ///< [byte] behind the payload: a signature (netio/signature.h)
inline constexpr std::size_t kMaxPayload = kMaxDatagram - kHeaderBytes - kMaxTrailer;  ///< [byte]
inline constexpr std::size_t kMaxHeaderlessDatagram = 2046;  ///< [byte] except the thesis' halves of a map
inline constexpr std::uint32_t kMaxId = 0xFFFFu;             ///< of a robot, and of a sensor
inline constexpr std::uint16_t kBroadcastId = 0xFFFFu;       ///< START: addresses all robots; not available as an id
inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;          ///< V2V: no leader, no checkpoint
inline constexpr std::uint32_t kMinTag = 1;                  ///< tags are 1 to kMaxId; the thesis has 1 to 32
inline constexpr double kMaxPosition = 1e7;                  ///< [m] per coordinate; covers all UTM coordinates
inline constexpr double kMaxYaw = 1e6;                       ///< [rad] covers headings that are never wrapped
inline constexpr double kMaxSpeed = 1e3;                     ///< [m/s], and [rad/s]
inline constexpr std::int64_t kMaxTime = std::int64_t{1} << 62;  ///< [ns] 146 years; differences cannot overflow

/// From 128: states and requests sent to the farm, of which it forwards V2V and START and sends V2I as well; CHALLENGE,
/// REFUSAL and from 140: its answers. Below 64: a reading of the sensor type with this wire id; the same plus 64: its
/// second form.
enum class Type : std::uint8_t {
  v2v = 128,
  tag = 129,
  subscribe = 130,
  start = 131,
  leave = 132,
  challenge = 133,
  command = 134,
  step = 135,
  fetch = 136,
  v2i = 137,
  object = 138,
  refusal = 139,
  neighbours = 140,
  state = 141,
  values = 142
};

/// Wire id (below 64; sensor types end at 31) of the sensor type whose readings, in either form, have type `type`; 0
/// for other types.
constexpr std::uint8_t sensor_type_of(Type type) {
  const auto number = static_cast<std::uint8_t>(type);
  return number < 128 ? number % 64 : std::uint8_t{0};
}

using base::StateQuality;

struct Header {
  Type type = Type::v2v;
  std::uint16_t robot = 0;     ///< of the reading or state; TAG, OBJECT: the tag's id; V2I: the intersection's
  std::uint16_t sensor = 0;    ///< 0-based among the robot's sensors of this type; 0 in states
  std::uint32_t sequence = 0;  ///< counter of messages of this type (and sensor), wraps to 0
  std::int64_t time = 0;       ///< [ns] in [0, kMaxTime]: time of measurement, not of sending
  std::uint16_t accuracy = 0;  ///< of readings: accuracy word, see below; 0: not stated
  std::uint32_t session = 0;   ///< of the sender: a random number drawn at its start; 0: not stated
  std::uint32_t token = 0;     ///< to the farm: the token of its CHALLENGE; from the farm: the receiver's session
  StateQuality state;          ///< of readings
};

/// Accuracy of a reading in 16 bits: mode in bits 0 to 3, `unsure` in bit 4, and in the upper bits k in [1, 2047] for a
/// bound of 2^((k - 1024) / 16), rounded up by at most 4.5 %; k = 0: no bound is stated.
struct Accuracy {
  std::uint8_t mode = 0;  ///< row of the sensor type's modes, in [0, 15]
  bool unsure =
      false;           ///< the sensor type's bound does not hold for some element: base::is_unsure, or a saturated word
  double bound = 0.0;  ///< [unit of the first column] of the numbers in the packet; infinite: not stated
};
/// Bounds of 0, and above 2^(1023 / 16), are encoded as not stated; the least that is stated is 2^(-1023 / 16).
std::uint16_t encode_accuracy(const Accuracy& accuracy);
Accuracy decode_accuracy(std::uint16_t word);

/// State of a robot.
struct V2v {
  base::Pose X_WR;                   ///< pose of the robot in the world
  base::Twist velocity;              ///< in the robot's frame
  std::uint32_t follows = kNone;     ///< id in [0, kMaxId] of its leader, or kNone
  std::uint32_t checkpoint = kNone;  ///< id of its next checkpoint, any number, or kNone
  bool docking = false;
};

/// State of a tag, from an overhead camera, in the world frame.
struct Tag {
  std::array<double, 3> position{};               ///< [m]
  std::array<double, 4> orientation{0, 0, 0, 1};  ///< unit quaternion x, y, z, w; its norm within 0.001 of 1
  std::array<double, 3> linear{};                 ///< [m/s]
  std::array<double, 3> angular{};                ///< [rad/s]
};

/// Request for readings that does not set the robot's state.
struct Subscribe {
  std::uint32_t types = 0;  ///< bit k: sensor type k; bit 0: states of other robots, see kNeighboursBit; 0: all types
                            ///< without these states
};
inline constexpr std::uint32_t kNeighboursBit = 1;  ///< requests the states of other robots

/// Start signal to the robot in the header, or to all with kBroadcastId.
struct Start {};

/// Ends a robot's participation; its id is free afterwards.
struct Leave {};

/// Whether an object, named by the id of its tag, is in the world.
struct Object {
  bool present = true;
};

/// Answer of the farm to an unproven address: packets from there are accepted once they carry the token.
struct Challenge {
  std::uint32_t token = 0;
};

/// Unsigned answer of the farm to a packet whose signature or address it refuses, for messages to users only: anyone
/// may have sent it. The header's time is the farm's Unix time.
struct Refusal {
  PacketStatus reason = PacketStatus::not_signed;  ///< or wrong_signature, replayed, wrong_source
};

inline constexpr std::size_t kV2vBytes = kHeaderBytes + 68;                           ///< of a complete V2V packet
inline constexpr std::size_t kTagBytes = 104, kSubscribeBytes = 4, kObjectBytes = 4;  ///< of their payloads
inline constexpr std::size_t kChallengeBytes = 4, kRefusalBytes = 4;
inline constexpr std::size_t kMaxNeighbours = kMaxPayload / kV2vBytes;  ///< V2V packets in one NEIGHBOURS
inline constexpr double kV2vRange = 50.0;  ///< [m] default radius within which the farm forwards V2V

/// Forwarded states of other robots: complete V2V datagrams, one after another.
struct Neighbours {
  std::span<const std::uint8_t> states;  ///< 1 to kMaxNeighbours of kV2vBytes, not decoded; live like the datagram
};

/// A reading or a part of one; its sensor type decodes it.
struct Reading {
  std::span<const std::uint8_t> payload;  ///< lives as long as the datagram
};

struct Packet {
  Header header;
  std::variant<V2v, Tag, Subscribe, Start, Leave, Challenge, V2i, Object, Neighbours, Reading, Command, Step, Fetch,
               State, Values, Refusal>
      body;
  bool late = false;  ///< a state whose sequence is not newer than the last of its sender (`InboxOptions::take_late`)
  bool unchecked = false;  ///< it has a signature, and the farm no key to check it with (set by Inbox)
};

/// Decodes any bytes. Fills `packet` only when the result is PacketStatus::accepted.
PacketStatus decode(std::span<const std::uint8_t> bytes, Packet& packet);

/// Replace the content of `out`; its capacity is kept. The functions set the header's type.
void encode(const Header& header, const V2v& state, base::Bytes& out);
void encode(const Header& header, const Tag& state, base::Bytes& out);
void encode(const Header& header, const Subscribe& request, base::Bytes& out);
void encode(const Header& header, const Start& signal, base::Bytes& out);
void encode(const Header& header, const Leave& word, base::Bytes& out);
void encode(const Header& header, const Challenge& challenge, base::Bytes& out);
void encode(const Header& header, const V2i& signals, base::Bytes& out);
void encode(const Header& header, const Object& object, base::Bytes& out);
void encode(const Header& header, const Refusal& refusal, base::Bytes& out);
void encode(const Header& header, const Neighbours& neighbours, base::Bytes& out);
void encode(const Header& header, const Command& command, base::Bytes& out);
void encode(const Header& header, const Step& step, base::Bytes& out);
void encode(const Header& header, const Fetch& fetch, base::Bytes& out);
void encode(const Header& header, const State& state, base::Bytes& out);
void encode(const Header& header, const Values& values, base::Bytes& out);

/// Encodes a reading of type `type`, one of the two of a sensor type; replaces the content of `out`. @pre the payload
/// has at most kMaxPayload bytes
void encode_reading(const Header& header, std::uint8_t type, std::span<const std::uint8_t> payload, base::Bytes& out);

/// Appends the 64 bytes of the header, with a trailer of 0 bytes.
void put_header(const Header& header, base::ByteWriter& writer);

/// The header fields that differ by receiver.
struct SessionToken {
  std::uint32_t session = 0;
  std::uint32_t token = 0;
};
/// Writes both into an encoded packet.
void write_session_token(std::span<std::uint8_t> packet, const SessionToken& session_token);

/// The report for world mover `mover` from a state. A tag's tilt is ignored, and its velocity is converted to that of
/// the mover in the mover's frame.
/// @param X_MT pose of the tag in the mover's frame
base::Report report(const Header& header, const V2v& state, std::uint32_t mover);
base::Report report(const Header& header, const Tag& state, std::uint32_t mover, const base::Pose& X_MT = {});

}  // namespace sf::netio
