#include "netio/packets.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "base/tilted_pose.h"
#include "tests/netio/documented.h"
#include "tests/netio/examples.h"
#include "tests/units.h"

namespace sf::netio {
namespace {

using sf::test::documented;

PacketStatus reason_of(const base::Bytes& bytes) {
  Packet packet;
  return decode(bytes, packet);
}

template <class Body>
Body body_of(const base::Bytes& bytes) {
  Packet packet;
  EXPECT_EQ(decode(bytes, packet), PacketStatus::accepted);
  return std::get<Body>(packet.body);
}

TEST(Packets, BytesMatchTheDocumentation) {
  EXPECT_EQ(reading_example(), documented("laser"));
  EXPECT_EQ(extended_example(), documented("laser_extended"));
  EXPECT_EQ(v2v_example(), documented("v2v"));
  EXPECT_EQ(tilted_v2v_example(), documented("tilted_v2v"));
  EXPECT_EQ(tag_example(), documented("tag"));
  EXPECT_EQ(subscribe_example(), documented("subscribe"));
  EXPECT_EQ(start_example(), documented("start"));
  EXPECT_EQ(leave_example(), documented("leave"));
  EXPECT_EQ(challenge_example(), documented("challenge"));
  EXPECT_EQ(refusal_example(), documented("refusal"));
  EXPECT_EQ(drive_example(), documented("drive"));
  EXPECT_EQ(v2i_example(), documented("v2i"));
  EXPECT_EQ(object_example(), documented("object"));
  EXPECT_EQ(shaped_object_example(), documented("shaped_object"));
  EXPECT_EQ(lane_example(), documented("lane"));
  EXPECT_EQ(team_map_example(), documented("team_map"));
  EXPECT_EQ(own_readings_example(), documented("own_readings"));
  EXPECT_EQ(dropped_example(), documented("dropped"));
  EXPECT_EQ(neighbours_example(), documented("neighbours"));
  EXPECT_EQ(command_example(), documented("command"));
  EXPECT_EQ(step_example(), documented("step"));
  EXPECT_EQ(fetch_example(), documented("fetch"));
  EXPECT_EQ(state_example(), documented("state"));
  EXPECT_EQ(values_example(), documented("values"));
}

TEST(Packets, HeaderRoundTrips) {
  base::Bytes bytes;
  encode({.robot = 0xFFFF,
          .sensor = 0xABCD,
          .sequence = 0xFEDCBA98u,
          .time = kMaxTime,
          .session = 0xFFFFFFFFu,
          .token = 1},
         Subscribe{}, bytes);
  Packet packet;
  ASSERT_EQ(decode(bytes, packet), PacketStatus::accepted);
  EXPECT_EQ(packet.header.type, Type::subscribe);
  EXPECT_EQ(packet.header.robot, 0xFFFF);
  EXPECT_EQ(packet.header.sensor, 0xABCD);
  EXPECT_EQ(packet.header.sequence, 0xFEDCBA98u);
  EXPECT_EQ(packet.header.time, kMaxTime);
  EXPECT_EQ(packet.header.session, 0xFFFFFFFFu);
  EXPECT_EQ(packet.header.token, 1u);
}

/// Returns the state of a decoded reading whose header contains `sent`.
StateQuality received(const StateQuality& sent) {
  base::Bytes bytes;
  encode_reading({.robot = 7, .state = sent}, 1, {}, bytes);
  Packet packet;
  EXPECT_EQ(decode(bytes, packet), PacketStatus::accepted);
  return packet.header.state;
}

TEST(Packets, StateOfAReadingRoundTrips) {
  const StateQuality got =
      received({.stated = true, .stale = true, .age = 80'000'000, .covariance = {1, 2, 3, 4, 5, 6}});
  EXPECT_TRUE(got.stated);
  EXPECT_TRUE(got.stale);
  EXPECT_EQ(got.age, 80'000'000);
  EXPECT_EQ(got.covariance, (std::array<float, 6>{1, 2, 3, 4, 5, 6}));
  EXPECT_FALSE(received({.stated = true}).stale);
  EXPECT_FALSE(received({.stale = true, .age = 5, .covariance = {1}}).stated);
}

TEST(Packets, AgeIsRoundedUpAndNeverZero) {
  EXPECT_EQ(received({.stated = true, .age = 0}).age, 1000);   // 0 would mean that nothing is stated
  EXPECT_EQ(received({.stated = true, .age = -5}).age, 1000);  // a state later than the reading
  EXPECT_EQ(received({.stated = true, .age = 1001}).age, 2000);
  EXPECT_EQ(received({.stated = true, .age = kMaxTime}).age, 4'294'967'295'000);
}

// Older clients see a stale state with the largest age.
TEST(Packets, MissingStateRoundTrips) {
  base::Bytes bytes;
  encode_reading({.robot = 7, .state = {.stated = true, .stale = true, .age = base::kNoStateYet}}, 1, {}, bytes);
  EXPECT_EQ(base::ByteReader(std::span(bytes).subspan(32)).get<std::uint32_t>(), 0xFFFFFFFFu);
  EXPECT_EQ(base::ByteReader(std::span(bytes).subspan(62)).get<std::uint16_t>(), 3u);
  EXPECT_EQ(received({.stated = true, .stale = true, .age = base::kNoStateYet}).age, base::kNoStateYet);
}

TEST(Packets, ImpossibleCovarianceIsDropped) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (const std::array<float, 6>& bad :
       {std::array<float, 6>{-1, 0, 0, 1, 0, 1}, {1, kNone, 0, 1, 0, 1}, {1, 0, 0, 1, 0, -1}}) {
    EXPECT_EQ(received({.stated = true, .age = 5000, .covariance = bad}).covariance, (std::array<float, 6>{}));
    EXPECT_EQ(received({.stated = true, .age = 5000, .covariance = bad}).age, 5000);
  }
}

TEST(Packets, AgeAndCovarianceOfV2vAndTagRoundTrip) {
  base::Bytes v2v, tag, other;
  const Header header{.robot = 7, .state = {.stated = true, .age = 5000, .covariance = {1, 0, 0, 2, 0, 3}}};
  encode(header, V2v{}, v2v);
  encode(header, Tag{}, tag);
  encode(header, Subscribe{}, other);
  for (const base::Bytes* bytes : {&v2v, &tag}) {
    Packet packet;
    EXPECT_EQ(decode(*bytes, packet), PacketStatus::accepted);
    EXPECT_EQ(packet.header.state.age, 5000);
    EXPECT_EQ(packet.header.state.covariance, header.state.covariance);
  }
  Packet packet;
  EXPECT_EQ(decode(other, packet), PacketStatus::accepted);
  EXPECT_FALSE(packet.header.state.stated) << "reserved in requests";
}

TEST(Packets, V2vRoundTrips) {
  base::Bytes bytes;
  const V2v sent{.X_WR = {-kMaxPosition, kMaxPosition, 0.1, -kMaxYaw},
                 .velocity = {kMaxSpeed, -0.0, -1e-300},
                 .follows = kMaxId,
                 .checkpoint = 0};
  encode({.robot = 1}, sent, bytes);
  const auto got = body_of<V2v>(bytes);
  EXPECT_EQ(got.X_WR.x, sent.X_WR.x);
  EXPECT_EQ(got.X_WR.y, sent.X_WR.y);
  EXPECT_EQ(got.X_WR.z, sent.X_WR.z);
  EXPECT_EQ(got.X_WR.yaw, sent.X_WR.yaw);
  EXPECT_EQ(got.velocity.forward, sent.velocity.forward);
  EXPECT_TRUE(std::signbit(got.velocity.left));
  EXPECT_EQ(got.velocity.turn, sent.velocity.turn);
  EXPECT_EQ(got.follows, kMaxId);
  EXPECT_EQ(got.checkpoint, 0u);
  EXPECT_FALSE(got.docking);
}

TEST(Packets, NoRobotAndNoCheckpointHaveReservedValues) {
  base::Bytes bytes;
  encode({}, V2v{}, bytes);
  EXPECT_EQ(body_of<V2v>(bytes).follows, kNone);
  EXPECT_EQ(body_of<V2v>(bytes).checkpoint, kNone);
}

TEST(Packets, TagRoundTrips) {
  const auto got = body_of<Tag>(tag_example());
  EXPECT_EQ(got.position, (std::array<double, 3>{3, 4, 0.5}));
  EXPECT_EQ(got.orientation, (std::array<double, 4>{0, 0, 0.6, 0.8}));
  EXPECT_EQ(got.linear, (std::array<double, 3>{0.5, 0, 0}));
  EXPECT_EQ(got.angular, (std::array<double, 3>{0, 0, 0.25}));
}

TEST(Packets, SubscribeRoundTrips) {
  EXPECT_EQ(body_of<Subscribe>(subscribe_example()).types, 2u);
  base::Bytes bytes;
  for (const base::SensorTypes types : {base::only(31), base::only(32), base::only(63) | 1u}) {
    encode({}, Subscribe{types}, bytes);
    EXPECT_EQ(bytes.size(), kHeaderBytes + (types >> 32 == 0 ? 4 : 8)) << "senders of earlier versions stay valid";
    EXPECT_EQ(body_of<Subscribe>(bytes).types, types);
  }
}

TEST(Packets, NeighboursContainWholeV2v) {
  static_assert(kMaxNeighbours == 9 && kV2vBytes == 132);
  const base::Bytes whole = neighbours_example();
  const auto states = body_of<Neighbours>(whole).states;
  ASSERT_EQ(states.size(), 2 * kV2vBytes);
  Packet packet;
  ASSERT_EQ(decode(states.subspan(kV2vBytes), packet), PacketStatus::accepted);
  EXPECT_EQ(packet.header.robot, 9);
  EXPECT_EQ(reason_of({whole.begin(), whole.end() - 1}), PacketStatus::too_short) << "the last one is cut";
  EXPECT_EQ(reason_of({whole.begin(), whole.begin() + kHeaderBytes}), PacketStatus::too_short) << "none";
  base::Bytes longer = whole;
  longer.resize(kHeaderBytes + kMaxNeighbours * kV2vBytes);
  EXPECT_EQ(reason_of(longer), PacketStatus::accepted) << "its states are checked one by one";
  longer.push_back(0);
  EXPECT_EQ(reason_of(longer), PacketStatus::too_long);
}

TEST(Packets, ReservedBytesOfTheHeaderAreIgnored) {
  EXPECT_EQ(reason_of(patched<std::uint16_t>(v2v_example(), 10, 0xFFFF)), PacketStatus::accepted);
  for (std::size_t at = 32; at < 60; ++at)  // age and covariance
    EXPECT_EQ(reason_of(patched<std::uint8_t>(v2v_example(), at, 0xFF)), PacketStatus::accepted) << at;
  EXPECT_EQ(reason_of(patched<std::uint16_t>(v2v_example(), 62, 0xFFFF)), PacketStatus::accepted);
}

TEST(Packets, ReservedBytesAreSentAsZero) {
  for (const base::Bytes& bytes : all_examples())
    for (std::size_t at = 32; at < kHeaderBytes; ++at) EXPECT_EQ(bytes[at], 0) << at;
}

/// A later release may sign packets. This one accepts them and ignores the signature.
TEST(Packets, TrailerIsIgnored) {
  for (const std::uint16_t size : {std::uint16_t{1}, std::uint16_t{kMaxTrailer}}) {
    for (const base::Bytes& example : all_examples()) {
      base::Bytes bytes = patched<std::uint16_t>(example, 60, size);
      bytes.resize(bytes.size() + size, 0xAB);
      EXPECT_EQ(reason_of(bytes), PacketStatus::accepted) << size;
      bytes.push_back(0);
      const bool any_size = sensor_type_of(Type{example[5]}) != 0;  // the type of a reading defines its length
      const bool several = Type{example[5]} == Type::neighbours;    // further bytes begin another V2V
      EXPECT_EQ(reason_of(bytes), any_size  ? PacketStatus::accepted
                                  : several ? PacketStatus::too_short
                                            : PacketStatus::too_long)
          << size;
    }
  }
  base::Bytes reading = patched<std::uint16_t>(reading_example(), 60, 5);
  EXPECT_EQ(body_of<Reading>(reading).payload.size(), 3u);                                // of 8
  EXPECT_TRUE(body_of<Reading>(patched<std::uint16_t>(reading, 60, 8)).payload.empty());  // all of them
  EXPECT_EQ(reason_of(patched<std::uint16_t>(reading, 60, 9)), PacketStatus::too_short);  // more than the datagram has
  reading.resize(kMaxDatagram, 0);
  EXPECT_EQ(reason_of(patched<std::uint16_t>(reading, 60, kMaxTrailer)), PacketStatus::accepted);  // the maximum
  EXPECT_EQ(reason_of(patched<std::uint16_t>(reading, 60, kMaxTrailer + 1)), PacketStatus::out_of_range);
}

TEST(Packets, WritesOnlySessionAndToken) {
  base::Bytes bytes = v2v_example();
  write_session_token(bytes, {0x11223344, 0x55667788});
  Packet packet;
  ASSERT_EQ(decode(bytes, packet), PacketStatus::accepted);
  EXPECT_EQ(packet.header.session, 0x11223344u);
  EXPECT_EQ(packet.header.token, 0x55667788u);
  write_session_token(bytes, {});
  EXPECT_EQ(bytes, v2v_example());
}

TEST(Packets, EveryShorterPrefixIsTooShort) {
  const auto check = [](const base::Bytes& whole, std::size_t least) {
    for (std::size_t size = 0; size < least; ++size) {
      EXPECT_EQ(reason_of({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}), PacketStatus::too_short)
          << size;
    }
  };
  for (const base::Bytes& state : states()) check(state, state.size());
  for (const base::Bytes& packet : lockstep_examples()) check(packet, packet.size());
  check(reading_example(), kHeaderBytes);  // the type of a reading defines its length
}

TEST(Packets, OneByteMoreIsTooLong) {
  for (base::Bytes bytes : states()) {
    bytes.push_back(0);
    EXPECT_EQ(reason_of(bytes), PacketStatus::too_long);
  }
  base::Bytes reading = reading_example();
  reading.resize(kHeaderBytes + kMaxPayload);
  EXPECT_EQ(reason_of(reading), PacketStatus::accepted);  // the longest datagram
  reading.push_back(0);
  EXPECT_EQ(reason_of(reading), PacketStatus::too_long);
}

TEST(Packets, PayloadOfAReadingFollowsTheHeader) {
  const base::Bytes bytes = reading_example();
  Packet packet;
  ASSERT_EQ(decode(bytes, packet), PacketStatus::accepted);
  EXPECT_EQ(sensor_type_of(packet.header.type), 1);
  EXPECT_EQ(packet.header.robot, 7);
  EXPECT_EQ(packet.header.sequence, 258u);
  EXPECT_EQ(packet.header.time, 1'500'000'000);
  const auto payload = std::get<Reading>(packet.body).payload;
  EXPECT_EQ(payload.data(), bytes.data() + kHeaderBytes);  // a view, not a copy
  EXPECT_EQ(payload.size(), 8u);
}

TEST(Packets, ReadingMayBeEmpty) {
  base::Bytes bytes;
  encode_reading({}, 31, {}, bytes);
  EXPECT_EQ(bytes.size(), kHeaderBytes);
  EXPECT_TRUE(body_of<Reading>(bytes).payload.empty());
}

TEST(Packets, TypesBelow128AreReadings) {
  for (int type = 0; type < 256; ++type) {
    const bool is_reading = type < 128 && type % 64 != 0;  // type 0 does not exist
    EXPECT_EQ(sensor_type_of(Type(type)), is_reading ? type % 64 : 0) << type;
    const bool is_state = type >= 128 && type <= 147;
    if (is_state) continue;
    EXPECT_EQ(reason_of(patched(reading_example(), 5, static_cast<std::uint8_t>(type))),
              is_reading ? PacketStatus::accepted : PacketStatus::unknown_type)
        << type;
  }
}

TEST(Packets, ChecksEachByteOfTheMagic) {
  for (std::size_t i = 0; i < kMagic.size(); ++i)
    EXPECT_EQ(reason_of(patched<std::uint8_t>(v2v_example(), i, 0)), PacketStatus::bad_magic);
}

TEST(Packets, OtherVersionsAreUnknown) {
  for (const int version : {0, 1, 3, 255})
    EXPECT_EQ(reason_of(patched(v2v_example(), 4, static_cast<std::uint8_t>(version))), PacketStatus::unknown_version);
}

TEST(Packets, RejectsNanAndInfinityInStates) {
  for (const double bad : {kNaN, kInf, -kInf}) {
    for (std::size_t i = 0; i < 7; ++i)
      EXPECT_EQ(reason_of(patched(v2v_example(), 64 + 8 * i, bad)), PacketStatus::not_finite) << i;
    for (const std::size_t at : {132u, 140u})
      EXPECT_EQ(reason_of(patched(tilted_v2v_example(), at, bad)), PacketStatus::not_finite) << at;
    for (std::size_t i = 0; i < 13; ++i)
      EXPECT_EQ(reason_of(patched(tag_example(), 64 + 8 * i, bad)), PacketStatus::not_finite) << i;
  }
}

TEST(Packets, NotFiniteTakesPrecedenceOverOutOfRange) {
  EXPECT_EQ(reason_of(patched(patched(v2v_example(), 64, 1e300), 112, kNaN)), PacketStatus::not_finite);
}

TEST(Packets, RejectsStatesBeyondTheirLimits) {
  struct Limit {
    std::size_t offset;
    double limit;
  };
  const Limit v2v[] = {{64, 1e7}, {72, 1e7}, {80, 1e7}, {88, 1e6}, {96, 1e3}, {104, 1e3}, {112, 1e3}};
  const Limit tag[] = {{64, 1e7},  {72, 1e7},  {80, 1e7},  {120, 1e3}, {128, 1e3},
                       {136, 1e3}, {144, 1e3}, {152, 1e3}, {160, 1e3}};
  const auto check = [](const base::Bytes& bytes, const Limit& at) {
    for (const double sign : {1.0, -1.0}) {
      EXPECT_EQ(reason_of(patched(bytes, at.offset, sign * at.limit)), PacketStatus::accepted) << at.offset;
      EXPECT_EQ(reason_of(patched(bytes, at.offset, sign * std::nextafter(at.limit, kInf))), PacketStatus::out_of_range)
          << at.offset;
      for (const double tiny : {0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::min()})
        EXPECT_EQ(reason_of(patched(bytes, at.offset, sign * tiny)), PacketStatus::accepted) << at.offset;
    }
  };
  for (const Limit& at : v2v) check(v2v_example(), at);
  for (const Limit& at : tag) check(tag_example(), at);
  for (const Limit& at : {Limit{132, kMaxRoll}, Limit{140, kMaxPitch}}) check(tilted_v2v_example(), at);
}

TEST(Packets, RejectsV2iRowsBeyondTheirLimits) {
  const auto check = [](std::size_t offset, auto limit) {
    for (const auto edge : {limit, -limit}) {
      EXPECT_EQ(reason_of(patched(v2i_example(), offset, edge)), PacketStatus::accepted) << offset;
      EXPECT_EQ(reason_of(patched(v2i_example(), offset, std::nextafter(edge, 2 * edge))), PacketStatus::out_of_range)
          << offset;
    }
  };
  for (const std::size_t position : {80, 88, 112, 120}) check(position, 1e7);
  check(96, 1e7f);  // z
  for (const std::size_t yaw : {100, 128}) check(yaw, 1e6f);
  EXPECT_EQ(reason_of(patched(v2i_example(), 132, 1e7f)), PacketStatus::accepted);  // width
  EXPECT_EQ(reason_of(patched(v2i_example(), 132, std::nextafter(1e7f, 2e7f))), PacketStatus::out_of_range);
}

TEST(Packets, RejectsIntegersBeyondTheirLimits) {
  EXPECT_EQ(reason_of(patched<std::uint32_t>(v2v_example(), 120, 65535)), PacketStatus::accepted);  // last robot id
  EXPECT_EQ(reason_of(patched<std::uint32_t>(v2v_example(), 120, 65536)),
            PacketStatus::out_of_range);  // neither a robot nor kNone
  EXPECT_EQ(reason_of(patched<std::uint32_t>(v2v_example(), 120, 0xFFFFFFFE)),
            PacketStatus::out_of_range);  // next to kNone
  EXPECT_EQ(reason_of(patched<std::uint32_t>(v2v_example(), 124, 0xFFFFFFFE)),
            PacketStatus::accepted);                                                                 // any checkpoint
  EXPECT_EQ(reason_of(patched<std::uint32_t>(v2v_example(), 128, 2)), PacketStatus::out_of_range);   // an unknown flag
  EXPECT_EQ(reason_of(patched<std::uint16_t>(tag_example(), 6, 0)), PacketStatus::out_of_range);     // tags begin at 1
  EXPECT_EQ(reason_of(patched<std::uint16_t>(tag_example(), 6, 1)), PacketStatus::accepted);         // the first tag
  EXPECT_EQ(reason_of(patched<std::int64_t>(v2v_example(), 16, -1)), PacketStatus::out_of_range);    // before the epoch
  EXPECT_EQ(reason_of(patched<std::int64_t>(v2v_example(), 16, 0)), PacketStatus::accepted);         // the first time
  EXPECT_EQ(reason_of(patched<std::int64_t>(v2v_example(), 16, kMaxTime)), PacketStatus::accepted);  // the last
  EXPECT_EQ(reason_of(patched<std::int64_t>(v2v_example(), 16, kMaxTime + 1)),
            PacketStatus::out_of_range);  // beyond it
}

TEST(Packets, OrientationsAreUnitQuaternions) {
  EXPECT_EQ(reason_of(patched(tag_example(), 112, 0.0)), PacketStatus::out_of_range);                    // norm 0.6
  EXPECT_EQ(reason_of(patched(patched(tag_example(), 104, 0.0), 112, 1.0009)), PacketStatus::accepted);  // within 0.001
  EXPECT_EQ(reason_of(patched(patched(tag_example(), 104, 0.0), 112, 1.0011)), PacketStatus::out_of_range);
  EXPECT_EQ(reason_of(patched(patched(tag_example(), 104, 0.0), 112, 0.9989)), PacketStatus::out_of_range);
  EXPECT_EQ(reason_of(patched(tag_example(), 104, 1e200)), PacketStatus::out_of_range);  // its square overflows
}

TEST(Packets, RejectedBytesDoNotChangeThePacket) {
  Packet packet;
  packet.header.sequence = 77;
  decode(patched(v2v_example(), 64, kNaN), packet);
  EXPECT_EQ(packet.header.sequence, 77u);
}

TEST(Packets, EncodingInvalidNumbersAborts) {
  base::Bytes out;
  EXPECT_DEATH(encode({}, V2v{.X_WR = {kNaN, 0, 0, 0}}, out), "not finite");
  EXPECT_DEATH(encode({.time = -1}, Subscribe{}, out), "timestamp -1");
  EXPECT_DEATH(encode({.robot = 0}, Tag{}, out), "tag id 0");
  EXPECT_DEATH(encode_reading({}, 0, {}, out), "type 0 is not a reading type");
  EXPECT_DEATH(encode_reading({}, 64, {}, out), "type 64 is not a reading type");    // second form of type 0
  EXPECT_DEATH(encode_reading({}, 128, {}, out), "type 128 is not a reading type");  // type of a state
  EXPECT_DEATH(encode_reading({}, 1, base::Bytes(kMaxPayload + 1), out), "1257 bytes of payload");
}

TEST(Packets, ConvertsStatesToReports) {
  Packet packet;
  ASSERT_EQ(decode(v2v_example(), packet), PacketStatus::accepted);
  const base::Report got = report(packet.header, std::get<V2v>(packet.body), 5);
  EXPECT_EQ(got.mover, 5u);
  EXPECT_EQ(got.time, 1'500'000'000);
  EXPECT_EQ(got.X_WM.y, -2.25);
  EXPECT_EQ(got.velocity.turn, -0.125);
}

TEST(Packets, TiltOfAV2vIsThatOfTheReport) {
  Packet packet;
  ASSERT_EQ(decode(tilted_v2v_example(), packet), PacketStatus::accepted);
  const base::Report got = report(packet.header, std::get<V2v>(packet.body), 5);
  EXPECT_EQ(got.tilt.roll, 0.0625);
  EXPECT_EQ(got.tilt.pitch, 0.25);
}

/// Any tilt, also upside down and with a vertical x axis, where yaw and roll are not unique: compares rotations.
TEST(Packets, TiltOfATagIsThatOfItsModel) {
  const base::Pose X_MT{0.2, 0.1, 0.3, 2.0};
  for (const base::Tilt& tilt :
       {base::Tilt{0.1, 0.0}, {0.0, -0.2}, {0.3, 1.5}, {3.0, 0.4}, {0.2, M_PI_2}, {1.0, -M_PI_2}})
    for (const double yaw : {0.0, M_PI / 2, -2.5}) {
      const base::RigidTransform X_WM = base::transform_of({1.0, 2.0, 0.2, yaw}, tilt);
      const base::RigidTransform X_WT = base::compose(X_WM, base::transform_of(X_MT));
      const base::Quaternion R_WM = base::quaternion_of(yaw, tilt), R_MT = base::quaternion_of(X_MT.yaw, {});
      const double norm = 1.0009;  // within the limits
      const Tag tag{
          .position = {X_WT.p.x, X_WT.p.y, X_WT.p.z},
          .orientation = {norm * (R_WM.x * R_MT.w + R_WM.y * R_MT.z), norm * (R_WM.y * R_MT.w - R_WM.x * R_MT.z),
                          norm * (R_WM.w * R_MT.z + R_WM.z * R_MT.w), norm * (R_WM.w * R_MT.w - R_WM.z * R_MT.z)}};
      const base::Report got = report({.robot = 1}, tag, 3, X_MT);
      const base::RigidTransform found = base::transform_of(got.X_WM, got.tilt);
      EXPECT_LT(glm::distance(found.p, X_WM.p), 1e-12) << tilt.roll << " " << tilt.pitch << " " << yaw;
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_LT(glm::distance(found.R[axis], X_WM.R[axis]), 1e-12) << tilt.roll << " " << tilt.pitch << " " << yaw;
      EXPECT_LE(std::abs(got.tilt.roll), kMaxRoll);
      EXPECT_LE(std::abs(got.tilt.pitch), kMaxPitch);
    }
}

TEST(Packets, RotatesTagVelocityIntoTheMoversFrame) {
  // Rotated by +90 degrees and moving along world x, which is to its right.
  const double half = std::sqrt(0.5);
  const base::Report got =
      report({.robot = 1}, Tag{.orientation = {0, 0, half, half}, .linear = {2, 0, 0}, .angular = {9, 9, 0.5}}, 3);
  EXPECT_NEAR(got.X_WM.yaw, M_PI / 2, 1e-12);
  EXPECT_NEAR(got.velocity.forward, 0.0, 1e-12);
  EXPECT_NEAR(got.velocity.left, -2.0, 1e-12);
  EXPECT_EQ(got.velocity.turn, 0.5);
}

/// Returns the time [s] in a V2I row for `left`.
double sent_left(double left) {
  base::Bytes rows;
  put(SignalApproach{.left = left}, rows);
  return approach_at({rows, {}}, 0).left;
}

/// No change is announced before it happens, or a millisecond late.
TEST(Packets, TimeToAChangeIsRoundedUp) {
  for (int tenth = 0; tenth < 100'000; ++tenth) {  // of a millisecond
    const double left = 1e-4 * tenth;
    ASSERT_GE(sent_left(left), left - 1e-7);
    ASSERT_LT(sent_left(left), left + 0.001);
  }
  EXPECT_EQ(sent_left(0.0), 0.0);
  EXPECT_EQ(sent_left(6.5 + 1e-12), 6.5) << "rounding errors of sums are ignored";
  EXPECT_DOUBLE_EQ(sent_left(1e9), 1e-3 * 0xFFFFFFFE) << "49 days at most";
  EXPECT_EQ(sent_left(std::numeric_limits<double>::infinity()), std::numeric_limits<double>::infinity());
}

/// Without an offset, the result equals the tag's own numbers, bitwise.
TEST(Packets, TagAtTheOriginEqualsTheModelsPose) {
  Packet packet;
  ASSERT_EQ(decode(tag_example(), packet), PacketStatus::accepted);
  const Tag& tag = std::get<Tag>(packet.body);
  const base::Report got = report(packet.header, tag, 3, {});
  const double yaw = std::atan2(2.0 * 0.8 * 0.6, 1.0 - 2.0 * 0.6 * 0.6);
  const glm::dvec2 velocity = base::rotate(-yaw, {tag.linear[0], tag.linear[1]});
  EXPECT_EQ(got.X_WM.x, tag.position[0]);
  EXPECT_EQ(got.X_WM.y, tag.position[1]);
  EXPECT_EQ(got.X_WM.z, tag.position[2]);
  EXPECT_EQ(got.X_WM.yaw, yaw);
  EXPECT_EQ(got.velocity.forward, velocity.x);
  EXPECT_EQ(got.velocity.left, velocity.y);
}

/// A tag ahead of its model's origin, to its left and above it, rotated by 90 degrees. The model turns in place: its
/// tag moves, its origin does not.
TEST(Packets, TagMayBeMountedAnywhereOnItsModel) {
  const base::Pose X_MT{0.2, 0.1, 0.3, M_PI / 2};
  for (const double yaw : {0.0, M_PI / 2, -2.5}) {
    const base::Pose X_WM{1.0, 2.0, 0.2, yaw};
    const base::Pose X_WT = base::compose(X_WM, X_MT);
    const glm::dvec2 arm = base::rotate(yaw, {X_MT.x, X_MT.y});
    const Tag tag{.position = {X_WT.x, X_WT.y, X_WT.z},
                  .orientation = {0, 0, std::sin(X_WT.yaw / 2), std::cos(X_WT.yaw / 2)},
                  .linear = {-0.5 * arm.y, 0.5 * arm.x, 0},
                  .angular = {0, 0, 0.5}};
    const base::Report got = report({.robot = 1}, tag, 3, X_MT);
    EXPECT_NEAR(got.X_WM.x, 1.0, 1e-12) << yaw;
    EXPECT_NEAR(got.X_WM.y, 2.0, 1e-12) << yaw;
    EXPECT_NEAR(got.X_WM.z, 0.2, 1e-12) << yaw;
    EXPECT_NEAR(base::wrap_angle(got.X_WM.yaw - yaw), 0.0, 1e-12) << yaw;
    EXPECT_NEAR(got.velocity.forward, 0.0, 1e-12) << yaw;
    EXPECT_NEAR(got.velocity.left, 0.0, 1e-12) << yaw;
    EXPECT_EQ(got.velocity.turn, 0.5);
  }
}

TEST(PacketStatus, NamesAreUnique) {
  for (std::size_t i = 0; i < kPacketStatuses; ++i) {
    EXPECT_FALSE(name(static_cast<PacketStatus>(i)).empty());
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_NE(name(static_cast<PacketStatus>(i)), name(static_cast<PacketStatus>(j)));
  }
  EXPECT_EQ(name(PacketStatus::wrong_source), "wrong source");
  EXPECT_EQ(name(PacketStatus::stale), "stale");
  EXPECT_EQ(static_cast<std::size_t>(PacketStatus::stale) + 1, kPacketStatuses) << "the last one";
}

TEST(PacketStatus, CountsAsText) {
  PacketCounts counts;
  EXPECT_EQ(packet_counts_text(counts), "nothing received");
  counts.add(PacketStatus::accepted);
  counts.add(PacketStatus::stale);
  counts.add(PacketStatus::stale);
  EXPECT_EQ(counts.total(), 3u);
  EXPECT_EQ(counts.dropped(), 2u);
  EXPECT_EQ(packet_counts_text(counts), "accepted 1, stale 2");
}

/// Integers of lockstep at their limits and one beyond.
TEST(Packets, RejectsLockstepNumbersBeyondTheirLimits) {
  struct Limit {
    base::Bytes packet;
    std::size_t at;  ///< offset of the number in its payload
    std::uint32_t least, most;
  };
  const std::vector<Limit> limits{
      {step_example(), 8, 1, kMaxTicks},     {step_example(), 12, 0, kMaxStepCommands},
      {fetch_example(), 12, 1, kMaxFetched}, {state_example(), 8, 0, 2},
      {state_example(), 72, 0, 1},           {state_example(), 76, 0, kDriverLostBit},
  };
  for (const Limit& l : limits) {
    const auto with = [&l](std::uint32_t value) { return reason_of(patched(l.packet, kHeaderBytes + l.at, value)); };
    EXPECT_EQ(with(l.least), PacketStatus::accepted) << l.at;
    EXPECT_EQ(with(l.most), PacketStatus::accepted) << l.at;
    EXPECT_EQ(with(l.most + 1), PacketStatus::out_of_range) << l.at;
    EXPECT_EQ(with(l.least - 1), PacketStatus::out_of_range) << l.at << ": 0 is too few, -1 too many";
  }
}

/// VALUES and rows of COMMAND at the limits in docs/packets.md, each number separately.
TEST(Packets, RejectsValuesAndCommandsBeyondTheirLimits) {
  using Status = PacketStatus;
  const base::Bytes values = values_example();  // three values of type 1, part 1 of 3
  const auto with = [&](std::size_t at, auto value) { return reason_of(patched(values, at, value)); };
  for (const auto& [type, status] : {std::pair{0, Status::out_of_range},
                                     {1, Status::accepted},
                                     {63, Status::accepted},
                                     {64, Status::out_of_range},
                                     {257, Status::out_of_range}})
    EXPECT_EQ(with(80, static_cast<std::uint16_t>(type)), status) << type;
  for (const std::uint32_t total : {0u, 2u, 4u, 148u, 149u, 16'777'217u})
    EXPECT_EQ(with(84, total), Status::out_of_range) << total;
  for (const std::uint32_t first : {1u, 3u, 148u}) EXPECT_EQ(with(88, first), Status::out_of_range) << first;
  for (const std::uint32_t index : {0u, 2u}) EXPECT_EQ(with(72, index), Status::accepted) << index;
  EXPECT_EQ(with(72, std::uint32_t{3}), Status::out_of_range);
  EXPECT_EQ(with(82, std::uint16_t{2}), Status::too_long);
  EXPECT_EQ(with(82, std::uint16_t{4}), Status::too_short);
  for (const std::size_t at : {96u, 104u, 112u, 120u})
    for (const double bad : {kNaN, kInf}) EXPECT_EQ(with(at, bad), Status::not_finite) << at;
  EXPECT_EQ(with(128, kNaN), Status::not_finite);
  EXPECT_EQ(with(128, -1e-300), Status::out_of_range);
  EXPECT_EQ(with(128, 0.0), Status::accepted);
  EXPECT_EQ(with(128, kInf), Status::accepted) << "no bound is stated";
  for (const auto& [total, first, count] : {std::array{16'777'216u, 16'777'132u, 84u},
                                            {149u, 148u, 1u},
                                            {296u, 148u, 148u},
                                            {297u, 148u, 148u},
                                            {148u, 0u, 148u}}) {
    base::Bytes part = patched(patched(values, 84, total), 88, first);
    part = patched(part, 82, static_cast<std::uint16_t>(count));
    part.resize(136 + 8 * std::size_t{count});
    EXPECT_EQ(reason_of(part), Status::accepted) << total << " from " << first;
  }
  for (std::size_t row = 0; row < 2; ++row) {
    for (const std::size_t at : {80u, 88u, 96u}) {
      const auto speed = [&](double v) { return reason_of(patched(command_example(), at + 32 * row, v)); };
      EXPECT_EQ(speed(1000.0), Status::accepted);
      EXPECT_EQ(speed(-1000.0), Status::accepted);
      EXPECT_EQ(speed(1000.1), Status::out_of_range);
      EXPECT_EQ(speed(-1000.1), Status::out_of_range);
      EXPECT_EQ(speed(kNaN), Status::not_finite);
    }
    const auto robot = [&](std::uint32_t id) { return reason_of(patched(command_example(), 104 + 32 * row, id)); };
    EXPECT_EQ(robot(65'535), Status::accepted);
    EXPECT_EQ(robot(65'536), Status::out_of_range);
  }
  for (const std::uint32_t count : {0u, 1u, 38u, 39u}) {
    base::Bytes command = patched(command_example(), 72, count);
    command.resize(80 + 32 * std::size_t{count});
    EXPECT_EQ(reason_of(command), count == 1 || count == 38 ? Status::accepted : Status::out_of_range) << count;
  }
}

/// The numbers of packet types and of refusals, as listed in docs/packets.md.
TEST(PacketsPage, NumbersMatchTheCode) {
  const std::pair<const char*, Type> types[] = {{"V2V", Type::v2v},
                                                {"TAG", Type::tag},
                                                {"SUBSCRIBE", Type::subscribe},
                                                {"START", Type::start},
                                                {"LEAVE", Type::leave},
                                                {"CHALLENGE", Type::challenge},
                                                {"COMMAND", Type::command},
                                                {"STEP", Type::step},
                                                {"FETCH", Type::fetch},
                                                {"V2I", Type::v2i},
                                                {"OBJECT", Type::object},
                                                {"REFUSAL", Type::refusal},
                                                {"STATE", Type::state},
                                                {"VALUES", Type::values},
                                                {"NEIGHBOURS", Type::neighbours},
                                                {"DRIVE", Type::drive},
                                                {"LANE", Type::lane},
                                                {"TEAM_MAP", Type::team_map},
                                                {"OWN_READINGS", Type::own_readings},
                                                {"DROPPED", Type::dropped}};
  std::ifstream file(SF_SOURCE_DIR "/docs/packets.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  const std::string row = page.substr(page.find("| 5 | u8 | type |"), 500);
  for (const auto& [name, type] : types) {
    const std::string number = std::to_string(static_cast<int>(type));
    EXPECT_NE(row.find(" " + number + " " + name), std::string::npos) << name;
    EXPECT_NE(page.find("## " + std::string(name) + " (type " + number), std::string::npos) << name;
  }
  const auto refused = [](std::uint32_t reason) {
    for (const base::Bytes& example : all_examples())
      if (Type{example[5]} == Type::refusal) return reason_of(patched(example, kHeaderBytes, reason));
    return PacketStatus::unknown_type;
  };
  const std::size_t at = page.find("| 64 | u32 | reason |");
  const std::string reasons = page.substr(at, page.find('\n', at) - at);
  for (std::uint32_t reason = 0; reason <= 6; ++reason) {
    const bool listed = reasons.find(" " + std::to_string(reason) + ": ") != std::string::npos;
    EXPECT_EQ(refused(reason), listed ? PacketStatus::accepted : PacketStatus::out_of_range) << reason;
  }
}

}  // namespace
}  // namespace sf::netio
