#include "netio/packets.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "base/elementary.h"
#include "base/error.h"
#include "base/tilted_pose.h"

namespace sf::netio {

namespace {

constexpr std::size_t kSessionTokenAt = 24;  ///< [byte] offset of session and token
constexpr std::uint32_t kDockingBit = 1;
constexpr std::uint32_t kPresentBit = 1, kShapeBit = 2, kColorBit = 4, kSizeBit = 8;
constexpr std::uint32_t kReversedBit = 8;
constexpr std::uint16_t kStaleBit = 1, kNoStateBit = 2, kFusedBit = 4;
constexpr std::int64_t kAgeUnit = 1000;  ///< [ns]
/// By number, from 1.
constexpr std::array kRefusals{PacketStatus::not_signed, PacketStatus::wrong_signature, PacketStatus::replayed,
                               PacketStatus::wrong_source};

PacketStatus check(std::span<const double> values, double limit) {
  for (const double value : values) {
    if (!std::isfinite(value)) return PacketStatus::not_finite;
  }
  for (const double value : values) {
    if (std::abs(value) > limit) return PacketStatus::out_of_range;
  }
  return PacketStatus::accepted;
}

/// Returns the first status that is not `accepted`, except that not_finite takes precedence over out_of_range.
PacketStatus first_fault(std::initializer_list<PacketStatus> reasons) {
  PacketStatus found = PacketStatus::accepted;
  for (const PacketStatus status : reasons) {
    if (status == PacketStatus::not_finite) return status;
    if (found == PacketStatus::accepted) found = status;
  }
  return found;
}

PacketStatus check(const base::Tilt& tilt) {
  return first_fault({check(std::array{tilt.roll}, kMaxRoll), check(std::array{tilt.pitch}, kMaxPitch)});
}

PacketStatus check(const V2v& state) {
  const base::Pose& pose = state.X_WR;
  const base::Twist& twist = state.velocity;
  const PacketStatus numbers =
      first_fault({check(std::array{pose.x, pose.y, pose.z}, kMaxPosition), check(std::array{pose.yaw}, kMaxYaw),
                   check(std::array{twist.forward, twist.left, twist.turn}, kMaxSpeed), check(state.tilt)});
  if (numbers != PacketStatus::accepted) return numbers;
  return state.follows == kNone || state.follows <= kMaxId ? PacketStatus::accepted : PacketStatus::out_of_range;
}

PacketStatus check(const Tag& state) {
  const auto& q = state.orientation;
  const PacketStatus numbers = first_fault({check(state.position, kMaxPosition), check(q, 2.0),
                                            check(state.linear, kMaxSpeed), check(state.angular, kMaxSpeed)});
  if (numbers != PacketStatus::accepted) return numbers;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return std::abs(norm - 1.0) <= 1e-3 ? PacketStatus::accepted : PacketStatus::out_of_range;
}

template <std::size_t n>
std::array<double, n> get_doubles(base::ByteReader& reader) {
  std::array<double, n> values{};
  for (double& value : values) value = reader.get<double>();
  return values;
}

template <std::size_t n>
void put_doubles(const std::array<double, n>& values, base::ByteWriter& writer) {
  for (const double value : values) writer.put(value);
}

base::Tilt get_tilt(base::ByteReader& reader) {
  const auto [roll, pitch] = get_doubles<2>(reader);
  return {roll, pitch};
}

PacketStatus check(const Drive& drive) {
  const base::Twist& twist = drive.twist;
  return check(std::array{twist.forward, twist.left, twist.turn}, kMaxSpeed);
}

PacketStatus check_size(std::size_t size, std::size_t expected) {
  if (size == expected) return PacketStatus::accepted;
  return size < expected ? PacketStatus::too_short : PacketStatus::too_long;
}

PacketStatus read_v2v(base::ByteReader& reader, Packet& packet) {
  V2v state;
  const auto v = get_doubles<7>(reader);
  state.X_WR = {v[0], v[1], v[2], v[3]};
  state.velocity = {v[4], v[5], v[6]};
  state.follows = reader.get<std::uint32_t>();
  state.checkpoint = reader.get<std::uint32_t>();
  const auto flags = reader.get<std::uint32_t>();
  state.docking = flags == kDockingBit;
  if (reader.left() > 0) state.tilt = get_tilt(reader);
  packet.body = state;
  const PacketStatus status = check(state);
  if (status != PacketStatus::accepted) return status;
  return flags <= kDockingBit ? PacketStatus::accepted : PacketStatus::out_of_range;
}

PacketStatus read_tag(base::ByteReader& reader, Packet& packet) {
  Tag state;
  state.position = get_doubles<3>(reader);
  state.orientation = get_doubles<4>(reader);
  state.linear = get_doubles<3>(reader);
  state.angular = get_doubles<3>(reader);
  packet.body = state;
  const PacketStatus status = check(state);
  if (status != PacketStatus::accepted) return status;
  return packet.header.robot >= kMinTag ? PacketStatus::accepted : PacketStatus::out_of_range;
}

template <class Body>
PacketStatus read_lockstep(std::span<const std::uint8_t> payload, Packet& packet) {
  Body body;
  const PacketStatus status = read_payload(payload, body);
  packet.body = body;
  return status;
}

/// Fields without their flag are 0.
PacketStatus read_shape(base::ByteReader& reader, std::uint32_t flags, Object& object) {
  const auto color = reader.get<std::uint32_t>();
  const auto size = get_doubles<3>(reader);
  const auto name = reader.get_bytes(base::kMostShapeName);
  const auto end = std::find(name.begin(), name.end(), std::uint8_t{0});
  object.shape.assign(name.begin(), end);
  if ((flags & kColorBit) != 0) object.color = color;
  if ((flags & kSizeBit) != 0) object.size = size;
  if (!std::isfinite(size[0] + size[1] + size[2])) return PacketStatus::not_finite;
  const auto is_zero = [](double length) { return std::bit_cast<std::uint64_t>(length) == 0; };
  const bool good =
      flags > kPresentBit && flags < 2 * kSizeBit && ((flags & kShapeBit) != 0) != object.shape.empty() &&
      (object.shape.empty() || base::is_shape_name(object.shape)) &&
      std::all_of(end, name.end(), [](std::uint8_t byte) { return byte == 0; }) && (object.color || color == 0) &&
      (object.size ? std::ranges::all_of(size, base::is_shape_length) : std::ranges::all_of(size, is_zero));
  return good ? PacketStatus::accepted : PacketStatus::out_of_range;
}

PacketStatus read_object(std::span<const std::uint8_t> payload, base::ByteReader& reader, Packet& packet) {
  const bool shaped = payload.size() == kShapedObjectBytes;
  PacketStatus status = shaped ? PacketStatus::accepted : check_size(payload.size(), kObjectBytes);
  if (status != PacketStatus::accepted) return status;
  const auto flags = reader.get<std::uint32_t>();
  Object object{.present = (flags & kPresentBit) != 0};
  if (shaped) status = read_shape(reader, flags, object);
  if (packet.header.robot < kMinTag || (!shaped && flags > kPresentBit)) status = PacketStatus::out_of_range;
  packet.body = std::move(object);
  return status;
}

PacketStatus read_refusal(base::ByteReader& reader, Packet& packet) {
  const auto number = reader.get<std::uint32_t>();
  if (number < 1 || number > kRefusals.size()) return PacketStatus::out_of_range;
  packet.body = Refusal{kRefusals[number - 1]};
  return PacketStatus::accepted;
}

PacketStatus read_drive(base::ByteReader& reader, Packet& packet) {
  const auto v = get_doubles<3>(reader);
  const Drive drive{{v[0], v[1], v[2]}};
  packet.body = drive;
  return check(drive);
}

PacketStatus read_drops(base::ByteReader& reader, Packet& packet) {
  Dropped dropped;
  for (std::uint32_t* const number : {&dropped.type, &dropped.processor, &dropped.network})
    *number = reader.get<std::uint32_t>();
  packet.body = dropped;
  return dropped.type >= 1 && dropped.type <= 63 ? PacketStatus::accepted : PacketStatus::out_of_range;
}

PacketStatus read_lane(base::ByteReader& reader, Packet& packet) {
  Lane lane;
  lane.segment = reader.get<std::uint32_t>();
  lane.lane = reader.get<std::uint32_t>();
  const auto use = reader.get<std::uint32_t>();
  lane.rule = use & ~kReversedBit;
  lane.reversed = (use & kReversedBit) != 0;
  packet.body = lane;
  return lane.rule <= kMaxLaneRule ? PacketStatus::accepted : PacketStatus::out_of_range;
}

PacketStatus read_body(std::span<const std::uint8_t> payload, Packet& packet) {
  base::ByteReader reader(payload);
  PacketStatus status = PacketStatus::accepted;
  switch (packet.header.type) {
    case Type::v2v:
      if (payload.size() != kV2vBytes - kHeaderBytes + kTiltBytes)
        status = check_size(payload.size(), kV2vBytes - kHeaderBytes);
      return status == PacketStatus::accepted ? read_v2v(reader, packet) : status;
    case Type::tag:
      status = check_size(payload.size(), kTagBytes);
      return status == PacketStatus::accepted ? read_tag(reader, packet) : status;
    case Type::subscribe:
      if (payload.size() == kWideSubscribeBytes) {
        packet.body = Subscribe{reader.get<std::uint64_t>()};
        return status;
      }
      packet.body = Subscribe{reader.get<std::uint32_t>()};
      return check_size(payload.size(), kSubscribeBytes);
    case Type::start:
      packet.body = Start{};
      return check_size(payload.size(), 0);
    case Type::leave:
      packet.body = Leave{};
      return check_size(payload.size(), 0);
    case Type::challenge:
      packet.body = Challenge{reader.get<std::uint32_t>()};
      return check_size(payload.size(), kChallengeBytes);
    case Type::v2i: {
      V2i signals;
      status = read_v2i(payload, signals);
      packet.body = signals;
      return status;
    }
    case Type::team_map: {
      TeamMap map;
      status = read_team_map(payload, map);
      packet.body = map;
      return status;
    }
    case Type::dropped:
      status = check_size(payload.size(), kDroppedBytes);
      return status == PacketStatus::accepted ? read_drops(reader, packet) : status;
    case Type::own_readings: {
      OwnReadings readings;
      status = read_own_readings(payload, readings);
      packet.body = readings;
      return status;
    }
    case Type::object:
      return read_object(payload, reader, packet);
    case Type::refusal:
      status = check_size(payload.size(), kRefusalBytes);
      return status == PacketStatus::accepted ? read_refusal(reader, packet) : status;
    case Type::drive:
      status = check_size(payload.size(), kDriveBytes);
      return status == PacketStatus::accepted ? read_drive(reader, packet) : status;
    case Type::lane:
      status = check_size(payload.size(), kLaneBytes);
      return status == PacketStatus::accepted ? read_lane(reader, packet) : status;
    case Type::neighbours:
      packet.body = Neighbours{payload};
      if (payload.size() > kMaxNeighbours * kV2vBytes) return PacketStatus::too_long;
      return payload.empty() || payload.size() % kV2vBytes != 0 ? PacketStatus::too_short : PacketStatus::accepted;
    case Type::command:
      return read_lockstep<Command>(payload, packet);
    case Type::step:
      return read_lockstep<Step>(payload, packet);
    case Type::fetch:
      return read_lockstep<Fetch>(payload, packet);
    case Type::state:
      return read_lockstep<State>(payload, packet);
    case Type::values:
      return read_lockstep<Values>(payload, packet);
  }
  if (sensor_type_of(packet.header.type) == 0) return PacketStatus::unknown_type;
  packet.body = Reading{payload};
  return payload.size() <= kMaxPayload ? PacketStatus::accepted : PacketStatus::too_long;
}

/// Drops an impossible covariance instead of rejecting the packet, because its bytes used to be reserved.
void read_covariance(base::ByteReader& reader, std::array<float, 6>& covariance) {
  for (float& each : covariance) each = reader.get<float>();
  const bool finite = std::all_of(covariance.begin(), covariance.end(), [](float v) { return std::isfinite(v); });
  if (!finite || covariance[0] < 0.0f || covariance[3] < 0.0f || covariance[5] < 0.0f) covariance = {};
}

/// @param trailer [byte] size of the trailer after the payload
PacketStatus read_header(base::ByteReader& reader, Header& header, std::size_t& trailer) {
  for (const std::uint8_t letter : kMagic) {
    if (reader.get<std::uint8_t>() != letter) return PacketStatus::bad_magic;
  }
  if (reader.get<std::uint8_t>() != kVersion) return PacketStatus::unknown_version;
  header.type = static_cast<Type>(reader.get<std::uint8_t>());
  header.robot = reader.get<std::uint16_t>();
  header.sensor = reader.get<std::uint16_t>();
  header.accuracy = reader.get<std::uint16_t>();
  header.sequence = reader.get<std::uint32_t>();
  header.time = reader.get<std::int64_t>();
  header.session = reader.get<std::uint32_t>();
  header.token = reader.get<std::uint32_t>();
  const auto age = reader.get<std::uint32_t>();
  StateQuality state{.stated = age > 0, .age = kAgeUnit * age};
  read_covariance(reader, state.covariance);
  trailer = reader.get<std::uint16_t>();
  const auto flags = reader.get<std::uint16_t>();
  state.stale = (flags & kStaleBit) != 0;
  if ((flags & kNoStateBit) != 0) state.age = base::kNoStateYet;
  const bool is_reading = sensor_type_of(header.type) != 0;
  header.fused = is_reading && (flags & kFusedBit) != 0;
  const bool has_state = is_reading || header.type == Type::v2v || header.type == Type::tag;
  if (state.stated && has_state) header.state = state;
  return PacketStatus::accepted;
}

/// Returns at least 1, because 0 means "not stated".
std::uint32_t age_word(std::int64_t age) {
  constexpr std::int64_t kMost = 0xFFFFFFFF;
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(age / kAgeUnit + (age % kAgeUnit > 0 ? 1 : 0), 1, kMost));
}

std::uint16_t flags_of(const Header& header) {
  const StateQuality& state = header.state;
  const bool stale = state.stated && state.stale, none = state.stated && state.age == base::kNoStateYet;
  return static_cast<std::uint16_t>((stale ? kStaleBit : 0) | (none ? kNoStateBit : 0) |
                                    (header.fused ? kFusedBit : 0));
}

void start(Header header, Type type, base::Bytes& out) {
  header.type = type;
  out.clear();
  base::ByteWriter writer(out);
  put_header(header, writer);
}

}  // namespace

PacketStatus decode(std::span<const std::uint8_t> bytes, Packet& packet) {
  if (bytes.size() < kHeaderBytes) return PacketStatus::too_short;
  base::ByteReader reader(bytes);
  Packet read;
  std::size_t trailer = 0;
  PacketStatus status = read_header(reader, read.header, trailer);
  if (status != PacketStatus::accepted) return status;
  if (bytes.size() < kHeaderBytes + trailer) return PacketStatus::too_short;

  status = read_body(bytes.subspan(kHeaderBytes, bytes.size() - kHeaderBytes - trailer), read);
  if (status != PacketStatus::accepted) return status;
  if (read.header.time < 0 || read.header.time > kMaxTime || trailer > kMaxTrailer) return PacketStatus::out_of_range;
  packet = read;
  return PacketStatus::accepted;
}

std::uint16_t encode_accuracy(const Accuracy& accuracy) {
  SF_CHECK(accuracy.mode < 16, "mode " + std::to_string(accuracy.mode) + " in a packet");
  const unsigned low = accuracy.mode | (accuracy.unsure ? 0x10u : 0u);
  if (!(accuracy.bound > 0.0) || std::isinf(accuracy.bound)) return static_cast<std::uint16_t>(low);
  // The tolerance keeps rounding of the logarithm from encoding a smaller bound.
  const double code = std::ceil(16.0 * std::log2(accuracy.bound) + 1e-9) + 1024.0;
  if (code > 2047.0) return static_cast<std::uint16_t>(low);
  const auto k = static_cast<unsigned>(std::max(code, 1.0));
  return static_cast<std::uint16_t>(k << 5 | low);
}

Accuracy decode_accuracy(std::uint16_t word) {
  const int k = word >> 5;
  const double bound = k > 0 ? std::exp2((k - 1024) / 16.0) : HUGE_VAL;
  return {static_cast<std::uint8_t>(word & 0xFu), (word & 0x10u) != 0, bound};
}

void put_header(const Header& header, base::ByteWriter& writer) {
  SF_CHECK(header.time >= 0 && header.time <= kMaxTime, "timestamp " + std::to_string(header.time) + " ns in a packet");
  writer.put_bytes(kMagic.data(), kMagic.size());
  writer.put(kVersion);
  writer.put(static_cast<std::uint8_t>(header.type));
  writer.put(header.robot);
  writer.put(header.sensor);
  writer.put(header.accuracy);
  writer.put(header.sequence);
  writer.put(header.time);
  writer.put(header.session);
  writer.put(header.token);
  const StateQuality& state = header.state;
  writer.put(state.stated ? age_word(state.age) : std::uint32_t{0});
  for (const float each : state.covariance) writer.put(state.stated ? each : 0.0f);
  writer.put(std::uint16_t{0});
  writer.put(flags_of(header));
}

void write_session_token(std::span<std::uint8_t> packet, const SessionToken& session_token) {
  SF_CHECK(packet.size() >= kHeaderBytes, std::to_string(packet.size()) + " bytes without a header");
  const std::uint32_t words[] = {session_token.session, session_token.token};
  std::memcpy(packet.data() + kSessionTokenAt, words, sizeof words);
}

void encode(const Header& header, const V2v& state, base::Bytes& out) {
  SF_CHECK(check(state) == PacketStatus::accepted,
           "V2V of robot " + std::to_string(header.robot) + ": " + std::string(name(check(state))));
  start(header, Type::v2v, out);
  base::ByteWriter writer(out);
  put_doubles(std::array{state.X_WR.x, state.X_WR.y, state.X_WR.z, state.X_WR.yaw}, writer);
  put_doubles(std::array{state.velocity.forward, state.velocity.left, state.velocity.turn}, writer);
  writer.put(state.follows);
  writer.put(state.checkpoint);
  writer.put(state.docking ? kDockingBit : std::uint32_t{0});
  if (!base::is_level(state.tilt)) put_doubles(std::array{state.tilt.roll, state.tilt.pitch}, writer);
}

void encode(const Header& header, const Tag& state, base::Bytes& out) {
  SF_CHECK(header.robot >= kMinTag, "tag id 0 in a packet");
  SF_CHECK(check(state) == PacketStatus::accepted,
           "TAG " + std::to_string(header.robot) + ": " + std::string(name(check(state))));
  start(header, Type::tag, out);
  base::ByteWriter writer(out);
  put_doubles(state.position, writer);
  put_doubles(state.orientation, writer);
  put_doubles(state.linear, writer);
  put_doubles(state.angular, writer);
}

void encode(const Header& header, const Subscribe& request, base::Bytes& out) {
  start(header, Type::subscribe, out);
  base::ByteWriter writer(out);
  if (request.types >> 32 != 0)
    writer.put(request.types);
  else
    writer.put(static_cast<std::uint32_t>(request.types));
}

void encode(const Header& header, const Start&, base::Bytes& out) { start(header, Type::start, out); }
void encode(const Header& header, const Leave&, base::Bytes& out) { start(header, Type::leave, out); }

void encode(const Header& header, const Challenge& challenge, base::Bytes& out) {
  start(header, Type::challenge, out);
  base::ByteWriter writer(out);
  writer.put(challenge.token);
}

void encode(const Header& header, const V2i& signals, base::Bytes& out) {
  SF_CHECK(check(signals) == PacketStatus::accepted,
           "V2I " + std::to_string(header.robot) + ": " + std::string(name(check(signals))));
  start(header, Type::v2i, out);
  put_v2i(signals, out);
}

void encode(const Header& header, const TeamMap& map, base::Bytes& out) {
  SF_CHECK(check(map) == PacketStatus::accepted,
           "TEAM_MAP of robot " + std::to_string(header.robot) + ": " + std::string(name(check(map))));
  start(header, Type::team_map, out);
  put_team_map(map, out);
}

void encode(const Header& header, const OwnReadings& readings, base::Bytes& out) {
  SF_CHECK(check(readings) == PacketStatus::accepted,
           "OWN_READINGS of robot " + std::to_string(header.robot) + ": " + std::string(name(check(readings))));
  start(header, Type::own_readings, out);
  put_own_readings(readings, out);
}

void encode(const Header& header, const Dropped& dropped, base::Bytes& out) {
  SF_CHECK(dropped.type >= 1 && dropped.type <= 63, "type " + std::to_string(dropped.type) + " of dropped readings");
  start(header, Type::dropped, out);
  base::ByteWriter writer(out);
  for (const std::uint32_t number : {dropped.type, dropped.processor, dropped.network}) writer.put(number);
}

void encode(const Header& header, const Object& object, base::Bytes& out) {
  SF_CHECK(header.robot >= kMinTag && (object.shape.empty() || base::is_shape_name(object.shape)),
           "object of tag 0 in a packet, or '" + object.shape + "'");
  start(header, Type::object, out);
  base::ByteWriter writer(out);
  writer.put((object.present ? kPresentBit : 0) | (object.shape.empty() ? 0 : kShapeBit) |
             (object.color ? kColorBit : 0) | (object.size ? kSizeBit : 0));
  if (!object.changes_shape()) return;
  writer.put(object.color.value_or(0));
  for (const double length : object.size.value_or(std::array<double, 3>{})) writer.put(length);
  out.insert(out.end(), object.shape.begin(), object.shape.end());
  out.resize(out.size() + base::kMostShapeName - object.shape.size());
}

void encode(const Header& header, const Refusal& refusal, base::Bytes& out) {
  const auto* const at = std::find(kRefusals.begin(), kRefusals.end(), refusal.reason);
  SF_CHECK(at != kRefusals.end(), "REFUSAL for " + std::string(name(refusal.reason)));
  start(header, Type::refusal, out);
  base::ByteWriter(out).put(static_cast<std::uint32_t>(at - kRefusals.begin() + 1));
}

void encode(const Header& header, const Drive& command, base::Bytes& out) {
  SF_CHECK(check(command) == PacketStatus::accepted,
           "DRIVE of robot " + std::to_string(header.robot) + ": " + std::string(name(check(command))));
  start(header, Type::drive, out);
  base::ByteWriter writer(out);
  put_doubles(std::array{command.twist.forward, command.twist.left, command.twist.turn}, writer);
}

void encode(const Header& header, const Lane& lane, base::Bytes& out) {
  SF_CHECK(lane.rule <= kMaxLaneRule, "rule " + std::to_string(lane.rule) + " of a lane");
  start(header, Type::lane, out);
  base::ByteWriter writer(out);
  writer.put(lane.segment);
  writer.put(lane.lane);
  writer.put(lane.rule | (lane.reversed ? kReversedBit : 0u));
}

void encode(const Header& header, const Neighbours& neighbours, base::Bytes& out) {
  const std::size_t size = neighbours.states.size();
  SF_CHECK(size > 0 && size % kV2vBytes == 0 && size <= kMaxNeighbours * kV2vBytes,
           std::to_string(size) + " bytes of V2V");
  start(header, Type::neighbours, out);
  out.insert(out.end(), neighbours.states.begin(), neighbours.states.end());
}

namespace {

/// Packets that are encoded are also accepted.
template <class Body>
void encode_lockstep(const Header& header, Type type, const Body& body, base::Bytes& out) {
  start(header, type, out);
  base::ByteWriter writer(out);
  write_payload(body, writer);
  Body again;
  const PacketStatus status = read_payload(std::span(out).subspan(kHeaderBytes), again);
  SF_CHECK(status == PacketStatus::accepted, "type " + std::to_string(static_cast<int>(type)) + " of robot " +
                                                 std::to_string(header.robot) + ": " + std::string(name(status)));
}

}  // namespace

void encode(const Header& header, const Command& command, base::Bytes& out) {
  encode_lockstep(header, Type::command, command, out);
}
void encode(const Header& header, const Step& step, base::Bytes& out) {
  encode_lockstep(header, Type::step, step, out);
}
void encode(const Header& header, const Fetch& fetch, base::Bytes& out) {
  encode_lockstep(header, Type::fetch, fetch, out);
}
void encode(const Header& header, const State& state, base::Bytes& out) {
  encode_lockstep(header, Type::state, state, out);
}
void encode(const Header& header, const Values& values, base::Bytes& out) {
  encode_lockstep(header, Type::values, values, out);
}

void encode_reading(const Header& header, std::uint8_t type, std::span<const std::uint8_t> payload, base::Bytes& out) {
  SF_CHECK(sensor_type_of(Type{type}) != 0, "type " + std::to_string(type) + " is not a reading type");
  SF_CHECK(payload.size() <= kMaxPayload, std::to_string(payload.size()) + " bytes of payload");
  start(header, Type{type}, out);
  out.insert(out.end(), payload.begin(), payload.end());
}

base::Report report(const Header& header, const V2v& state, std::uint32_t mover) {
  return {mover, header.time, state.X_WR, state.velocity, state.tilt};
}

namespace {

/// Returns the pose of the mover under a tag with this orientation at the origin; its position is minus the arm from
/// the mover's origin to the tag, in the world frame.
base::TiltedPose under(const std::array<double, 4>& orientation, const base::Pose& X_MT) {
  const auto& [x, y, z, w] = orientation;
  if (x != 0.0 || y != 0.0) {
    const base::RigidTransform X_TM = base::relative(base::transform_of(X_MT), {});
    return base::tilted_pose_of(base::compose({base::rotation_of(base::Quaternion{w, x, y, z})}, X_TM));
  }
  const double yaw = base::atan2(2.0 * (w * z), 1.0 - 2.0 * (z * z)) - X_MT.yaw;
  const glm::dvec2 arm = base::rotate(yaw, {X_MT.x, X_MT.y});
  return {{-arm.x, -arm.y, -X_MT.z, yaw}};
}

}  // namespace

base::Report report(const Header& header, const Tag& state, std::uint32_t mover, const base::Pose& X_MT) {
  const auto [X, tilt] = under(state.orientation, X_MT);
  const double turn = state.angular[2];
  const glm::dvec2 velocity = base::rotate(-X.yaw, {state.linear[0] - turn * X.y, state.linear[1] + turn * X.x});
  const auto& p = state.position;
  return {mover, header.time, {p[0] + X.x, p[1] + X.y, p[2] + X.z, X.yaw}, {velocity.x, velocity.y, turn}, tilt};
}

}  // namespace sf::netio
