#pragma once
// The farm's packets as values, with their encoding and decoding. docs/packets.md specifies every byte and limit.
//
// The sensor type defines the payload of a reading; here it is a sequence of bytes after a header. Decoding accepts any
// bytes and returns a packet or one PacketStatus. Encoding requires values within the limits: a value that the decoder
// would reject is a programming error and aborts.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "base/bytes.h"
#include "base/pose.h"
#include "base/reading.h"
#include "base/report.h"
#include "base/shape_state.h"
#include "base/state_quality.h"
#include "netio/lockstep_packets.h"
#include "netio/own_readings.h"
#include "netio/packet_status.h"
#include "netio/team_map.h"
#include "netio/v2i.h"

namespace sf::netio {

inline constexpr std::array<std::uint8_t, 4> kMagic = {'S', 'F', 'P', 'K'};
inline constexpr std::uint8_t kVersion = 2;
inline constexpr std::size_t kHeaderBytes = 64;
inline constexpr std::size_t kMaxDatagram = 1400;  ///< [byte] largest packet of the farm, which avoids fragmentation
inline constexpr std::size_t kVersionAt = 4, kTypeAt = 5, kRobotAt = 6;  ///< [byte] offsets in the header; robot: u16
inline constexpr std::size_t kTrailerAt = 60;   ///< [byte] offset of the trailer's size, u16, in the header
inline constexpr std::size_t kMaxTrailer = 80;  ///< [byte] maximum size of the trailer after the payload: a signature
                                                ///< (netio/signature.h)
inline constexpr std::size_t kMaxPayload = kMaxDatagram - kHeaderBytes - kMaxTrailer;  ///< [byte]
inline constexpr std::size_t kMaxHeaderlessDatagram = 2046;  ///< [byte] except for the thesis' halves of a map
inline constexpr std::uint32_t kMaxId = 0xFFFFu;             ///< largest id of a robot, and number of a sensor
inline constexpr std::uint16_t kBroadcastId = 0xFFFFu;       ///< START: addresses all robots; not available as an id
inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;          ///< V2V: no leader, no checkpoint
inline constexpr std::uint32_t kMinTag = 1;                  ///< tags are 1 to kMaxId; the thesis has 1 to 32
inline constexpr double kMaxPosition = 1e7;                  ///< [m] per coordinate; covers all UTM coordinates
inline constexpr double kMaxYaw = 1e6;                       ///< [rad] covers headings that are never wrapped
inline constexpr double kMaxSpeed = 1e3;                     ///< [m/s], and [rad/s]
inline constexpr std::int64_t kMaxTime = std::int64_t{1} << 62;  ///< [ns] 146 years; differences do not overflow

/// Types from 128 are states, requests and readings of robots' own sensors sent to the farm. The farm forwards V2V and
/// START, and also sends V2I and LANE. Robots send V2V and TEAM_MAP to each other. CHALLENGE, REFUSAL, DROPPED and
/// types from 140 to 143 are answers of the farm. A type below 64 is a reading of the sensor type with this wire id;
/// the same number plus 64 is its second form.
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
  values = 142,
  drive = 143,
  lane = 144,
  team_map = 145,
  own_readings = 146,
  dropped = 147
};

/// Returns the wire id (below 64) of the sensor type whose readings, in either form, have type
/// `type`; 0 for other types.
constexpr std::uint8_t sensor_type_of(Type type) {
  const auto number = static_cast<std::uint8_t>(type);
  return number < 128 ? number % 64 : std::uint8_t{0};
}

using base::StateQuality;

struct Header {
  Type type = Type::v2v;
  std::uint16_t robot = 0;     ///< id of the robot that the reading or state belongs to; TAG, OBJECT: the tag's id;
                               ///< V2I: the intersection's
  std::uint16_t sensor = 0;    ///< 0-based among the robot's sensors of this type; SUBSCRIBE: kFollowsDrive, kCentre or
                               ///< 0; 0 in other requests and states
  std::uint32_t sequence = 0;  ///< counter of messages of this type (and sensor), wraps to 0
  std::int64_t time = 0;       ///< [ns] in [0, kMaxTime]: time of measurement, not of sending
  std::uint16_t accuracy = 0;  ///< readings: accuracy word, see below; 0: not stated
  std::uint32_t session = 0;   ///< of the sender: a random number drawn when it starts; 0: not stated
  std::uint32_t token = 0;     ///< to the farm: the token of its CHALLENGE; from the farm: the receiver's session
  StateQuality state;          ///< readings, V2V and TAG only
  bool fused = false;          ///< readings: includes one of the robot's own sensor
};

/// Accuracy of a reading in 16 bits: mode in bits 0 to 3, `unsure` in bit 4, and in the upper bits k in [1, 2047] for a
/// bound of 2^((k - 1024) / 16), rounded up by at most 4.5 %; k = 0: no bound is stated.
struct Accuracy {
  std::uint8_t mode = 0;  ///< row of the sensor type's modes, in [0, 15]
  bool unsure =
      false;           ///< the sensor type's bound does not hold for some element: base::is_unsure, or a saturated word
  double bound = 0.0;  ///< [unit of the first column] error bound of the numbers in the packet; infinite: not stated
};
/// Encodes a bound of 0, or above 2^(1023 / 16), as not stated. The smallest encoded bound is 2^(-1023 / 16).
std::uint16_t encode_accuracy(const Accuracy& accuracy);
Accuracy decode_accuracy(std::uint16_t word);

inline constexpr double kMaxRoll = M_PI, kMaxPitch = M_PI_2;  ///< [rad] of a robot

/// State of a robot.
struct V2v {
  base::Pose X_WR;                   ///< pose of the robot in the world
  base::Twist velocity;              ///< in the robot's frame
  std::uint32_t follows = kNone;     ///< id in [0, kMaxId] of its leader, or kNone
  std::uint32_t checkpoint = kNone;  ///< id of its next checkpoint, any number, or kNone
  bool docking = false;
  base::Tilt tilt;  ///< of the robot; roll within kMaxRoll, pitch within kMaxPitch. Level robots send the short form
};

/// State of a tag, measured by an overhead camera, in the world frame.
struct Tag {
  std::array<double, 3> position{};               ///< [m]
  std::array<double, 4> orientation{0, 0, 0, 1};  ///< unit quaternion x, y, z, w; its norm is within 0.001 of 1
  std::array<double, 3> linear{};                 ///< [m/s]
  std::array<double, 3> angular{};                ///< [rad/s]
};

/// Request for readings that does not set the robot's state.
struct Subscribe {
  base::SensorTypes types = 0;  ///< bit 0: states of other robots, see kNeighboursBit; 0: all types without these
                                ///< states
};
inline constexpr base::SensorTypes kNeighboursBit = 1;  ///< requests the states of other robots
inline constexpr std::uint16_t kFollowsDrive = 1;       ///< `Header::sensor` of SUBSCRIBE: the robot follows DRIVE
inline constexpr std::uint16_t kCentre = 2;             ///< the same, and of LEAVE: the sender is the control centre

/// Start signal to the robot in the header, or to all with kBroadcastId.
struct Start {};

/// Ends a robot's participation; its id is free afterwards.
struct Leave {};

/// States whether an object, identified by the id of its tag, is in the world, and changes its shape, colour or size.
struct Object {
  bool present = true;
  std::string shape = {};                          ///< name (base::is_shape_name); empty: unchanged
  std::optional<std::uint32_t> color = {};         ///< 0xAARRGGBB
  std::optional<std::array<double, 3>> size = {};  ///< [m] base::is_shape_length each

  bool changes_shape() const { return !shape.empty() || color || size; }
};

/// Answer of the farm to an unproven address. Packets from there are accepted once they carry the token.
struct Challenge {
  std::uint32_t token = 0;
};

/// Unsigned answer of the farm to a packet whose signature or address it refuses. Use it only for messages to users,
/// because anyone may have sent it. The header's time is the farm's Unix time.
struct Refusal {
  PacketStatus reason = PacketStatus::not_signed;  ///< not_signed, wrong_signature, replayed or wrong_source
};

/// From the farm: the velocity that a user of one of its bridges commands. Applies to the robot in the header until the
/// next DRIVE or until the robot's own timeout.
struct Drive {
  base::Twist twist;  ///< in the robot's frame; each number within kMaxSpeed
};

/// To the farm: the use that a lane is to have. From the farm to a robot: the use that it has.
struct Lane {
  std::uint32_t segment = 0, lane = 0;  ///< numbers in the road network
  std::uint32_t rule = 0;               ///< in [0, kMaxLaneRule]: open, closed, turn, left, right
  bool reversed = false;                ///< driven against the order of its way-points

  friend bool operator==(const Lane&, const Lane&) = default;
};
inline constexpr std::uint32_t kMaxLaneRule = 4;

/// From the farm to a robot: readings of one of its sensors (`Header::sensor`) that the farm dropped since it started,
/// because a budget was exhausted. The header's time is that of the newest of them. Counts wrap to 0.
struct Dropped {
  std::uint32_t type = 0;       ///< wire id of the sensor type, in [1, 63]
  std::uint32_t processor = 0;  ///< not measured: no processor time was left
  std::uint32_t network = 0;    ///< measured and not sent: no bytes were left
};

inline constexpr std::size_t kV2vBytes = kHeaderBytes + 68;                 ///< size of a V2V of a level robot
inline constexpr std::size_t kTiltBytes = 16;                               ///< appended to V2V and STATE by a tilt
inline constexpr std::size_t kTagBytes = 104;                               ///< payload sizes
inline constexpr std::size_t kObjectBytes = 4, kShapedObjectBytes = 96;     ///< without and with a change of shape
inline constexpr std::size_t kSubscribeBytes = 4, kWideSubscribeBytes = 8;  ///< without and with types above 31
inline constexpr std::size_t kChallengeBytes = 4, kRefusalBytes = 4, kDriveBytes = 24, kLaneBytes = 12,
                             kDroppedBytes = 12;
inline constexpr std::size_t kMaxNeighbours = kMaxPayload / kV2vBytes;  ///< V2V packets in one NEIGHBOURS
inline constexpr double kV2vRange = 50.0;  ///< [m] default radius within which the farm forwards V2V

/// Forwarded states of other robots: complete V2V datagrams without tilt, one after another.
struct Neighbours {
  std::span<const std::uint8_t> states;  ///< 1 to kMaxNeighbours states of kV2vBytes, not decoded; valid as long as the
                                         ///< datagram
};

/// A reading or a part of one. Its sensor type decodes it.
struct Reading {
  std::span<const std::uint8_t> payload;  ///< valid as long as the datagram
};

struct Packet {
  Header header;
  std::variant<V2v, Tag, Subscribe, Start, Leave, Challenge, V2i, Object, Neighbours, Reading, Command, Step, Fetch,
               State, Values, Refusal, Drive, Lane, TeamMap, OwnReadings, Dropped>
      body;
  bool late = false;       ///< a state whose sequence is not newer than the last one of its sender
                           ///< (`InboxOptions::take_late`)
  bool unchecked = false;  ///< signed, but the farm has no key to check the signature (set by Inbox)
};

/// Decodes any bytes. Fills `packet` only if the result is PacketStatus::accepted.
PacketStatus decode(std::span<const std::uint8_t> bytes, Packet& packet);

/// Replaces the content of `out`, keeping its capacity. The functions set the header's type.
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
void encode(const Header& header, const Drive& command, base::Bytes& out);
void encode(const Header& header, const Lane& lane, base::Bytes& out);
void encode(const Header& header, const TeamMap& map, base::Bytes& out);
void encode(const Header& header, const OwnReadings& readings, base::Bytes& out);
void encode(const Header& header, const Dropped& dropped, base::Bytes& out);
void encode(const Header& header, const Command& command, base::Bytes& out);
void encode(const Header& header, const Step& step, base::Bytes& out);
void encode(const Header& header, const Fetch& fetch, base::Bytes& out);
void encode(const Header& header, const State& state, base::Bytes& out);
void encode(const Header& header, const Values& values, base::Bytes& out);

/// Encodes a reading with type `type`, one of the two types of its sensor type. Replaces the content of `out`. @pre the
/// payload has at most kMaxPayload bytes
void encode_reading(const Header& header, std::uint8_t type, std::span<const std::uint8_t> payload, base::Bytes& out);

/// Appends the 64 bytes of the header, with a trailer size of 0.
void put_header(const Header& header, base::ByteWriter& writer);

/// The header fields that differ by receiver.
struct SessionToken {
  std::uint32_t session = 0;
  std::uint32_t token = 0;
};
/// Writes both fields into an encoded packet.
void write_session_token(std::span<std::uint8_t> packet, const SessionToken& session_token);

/// Returns the report for world mover `mover` from a state. Converts a tag's velocity to the mover's velocity in the
/// mover's frame; of its angular velocity only the turn about the vertical counts.
/// @param X_MT pose of the tag in the mover's frame
base::Report report(const Header& header, const V2v& state, std::uint32_t mover);
base::Report report(const Header& header, const Tag& state, std::uint32_t mover, const base::Pose& X_MT = {});

}  // namespace sf::netio
