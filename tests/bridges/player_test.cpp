// The Player server as seen by its clients.

#include "bridges/player_bridge.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "sensors/bumper.h"
#include "sensors/encoder.h"
#include "sensors/fiducial.h"
#include "sensors/gps.h"
#include "sensors/infrared.h"
#include "sensors/laneedge.h"
#include "sensors/laser.h"
#include "sensors/magnetometer.h"
#include "sensors/sonar.h"
#include "tests/bridges/player_client.h"
#include "tests/refusal.h"
#include "tests/units.h"

namespace sf::bridges::player {

namespace {

/// Returns the device addresses of a list.
std::vector<Address> listed(TestClient& client) {
  const Message answer = client.request({}, server_request::device_list);
  XdrReader xdr(answer.payload);
  std::vector<Address> found(xdr.get());
  EXPECT_EQ(xdr.get(), found.size());
  for (Address& address : found) {
    xdr.get(), xdr.get();
    address.interf = static_cast<Interface>(xdr.get()), address.index = xdr.get();
  }
  EXPECT_TRUE(xdr.done());
  return found;
}

std::vector<double> floats(XdrReader& xdr) {
  std::vector<double> values(xdr.get());
  EXPECT_EQ(xdr.get(), values.size());
  for (double& value : values) value = std::bit_cast<float>(xdr.get());
  return values;
}

/// Ann with her position2d open.
struct PlayerTest : testing::Test {
  PlayerTest() { client.banner(), client.open(kPosition); }
  MessageType ask(const Address& to, std::uint32_t subtype, const base::Bytes& payload = {}) {
    return client.request(to, subtype, payload).header.type;
  }
  /// Waits until everything sent before has been processed.
  void settle() { EXPECT_EQ(ask(kPosition, 1), MessageType::ack); }
  void drive(double forward, double left, double turn) {
    client.send(MessageType::command, kPosition, 1, xdr_of(forward, left, turn, 1u));
    settle();
  }
  PlayerRun run;
  TestClient client{run.port()};
};

base::Bytes named_pose(const std::string& name, double x, double y, double yaw) {
  base::Bytes out;
  XdrWriter xdr(out);
  xdr.put_text(name);
  xdr.put_all({x, y, yaw});
  return out;
}

/// Returns the data message that follows `publish`.
template <class Publish>
Message data_after(TestClient& client, Publish&& publish) {
  publish();
  return client.receive();
}

}  // namespace

TEST_F(PlayerTest, GreetsWithThirtyTwoBytes) {
  TestClient other(run.port());
  EXPECT_EQ(other.banner().substr(0, 9), "Player v.");
}

TEST_F(PlayerTest, AllRobotsAreAtTheFirstPortAndEachHasItsOwn) {
  const std::vector<Address> all = listed(client);
  EXPECT_EQ(std::count(all.begin(), all.end(), Address{Interface::position2d, 1}), 1);
  EXPECT_EQ(std::count(all.begin(), all.end(), Address{Interface::laser, 1}), 1);
  EXPECT_EQ(std::count(all.begin(), all.end(), Address{Interface::ranger, 3}), 1) << "two lasers, a sonar, an infrared";
  EXPECT_EQ(all.size(), 14u);
  TestClient second(run.port(1));
  second.banner();
  EXPECT_EQ(listed(second), (std::vector<Address>{{Interface::position2d, 0},
                                                  {Interface::laser, 0},
                                                  {Interface::simulation, 0},
                                                  {Interface::map, 0},
                                                  {Interface::ranger, 0}}));
  const Message info = second.request({}, server_request::driver_info, xdr_of(0u, 0u, 6u, 0u, 0u, 0u));
  XdrReader xdr(info.payload);
  for (int i = 0; i < 4; ++i) xdr.get();
  EXPECT_EQ(xdr.get_text(100), "ben.front") << "of what it is shows in lists of devices";
}

TEST_F(PlayerTest, UnknownDevicesAreRefused) {
  const Message answer = client.open({Interface::laser, 9});
  EXPECT_EQ(answer.header.type, MessageType::nack);
  XdrReader xdr(answer.payload);
  for (int i = 0; i < 4; ++i) xdr.get();
  EXPECT_EQ(xdr.get(), 3u) << "no access";
  EXPECT_EQ(ask({Interface::laser, 9}, 1), MessageType::nack) << "no such device";
  EXPECT_EQ(ask({static_cast<Interface>(999), 0}, 1), MessageType::nack) << "no such interface";
  EXPECT_EQ(ask(kLaserDevice, 255), MessageType::nack) << "no such request";
  EXPECT_EQ(ask({}, 77), MessageType::nack) << "no such request of the server";
  EXPECT_EQ(client.access(kPosition, Access::error).header.type, MessageType::ack);
  EXPECT_EQ(client.access(kLaserDevice, Access::close).payload[19], 3) << "closed, though never opened";
  EXPECT_EQ(ask(kPosition, 0), MessageType::nack) << "0 is none, also where an interface has no configuration";
  EXPECT_EQ(ask(kPosition, 7, xdr_of(1u)), MessageType::nack);
  EXPECT_EQ(ask({Interface::map, 0}, 4), MessageType::nack);
}

TEST_F(PlayerTest, PushedStateIsThatOfTheOdometry) {
  run.reports[0].X_WM = {-1.0, 0.5, 0.0, M_PI / 2};  // half a metre ahead of the start
  run.reports[0].velocity = {0.3, 0.0, 0.1};
  run.contacts[0] = 1;
  run.tick();  // the odometry starts here
  client.receive();
  run.reports[0].X_WM.y = 1.5;
  const Message data = data_after(client, [&] { run.tick(); });
  EXPECT_EQ(data.header.type, MessageType::data);
  EXPECT_EQ(data.header.address, kPosition);
  EXPECT_NEAR(data.header.time, 0.2, 1e-12);
  EXPECT_EQ(data.header.robot, run.bridge.endpoint().port);
  XdrReader xdr(data.payload);
  for (const double value : {1.0, 0.0, 0.0, 0.3, 0.0, 0.1}) EXPECT_NEAR(xdr.get_double(), value, 1e-12);
  EXPECT_EQ(xdr.get(), 1u) << "stalled: it touches something";
  EXPECT_TRUE(xdr.done());
}

TEST_F(PlayerTest, PulledRoundsEndWithASync) {
  client.pull();
  EXPECT_EQ(ask({}, server_request::data), MessageType::ack);
  run.tick();  // the request was waiting for it
  EXPECT_EQ(client.receive().header.type, MessageType::data);
  const Message sync = client.receive();
  EXPECT_EQ(sync.header.type, MessageType::sync);
  EXPECT_EQ(sync.header.address, Address{});
  EXPECT_EQ(sync.header.host + sync.header.robot + sync.header.size, 0u);
  // The request has been consumed. The next message answers another request, and the newest data has replaced older
  // data.
  for (int i = 0; i < 3; ++i) run.tick();
  client.send(MessageType::request, kPosition, 1);
  EXPECT_EQ(client.receive().header.type, MessageType::ack);
  client.send(MessageType::request, {}, server_request::data);
  EXPECT_EQ(client.receive().header.type, MessageType::ack) << "first";
  EXPECT_NEAR(client.receive().header.time, 0.4, 1e-12) << "the newest";
  EXPECT_EQ(client.receive().header.type, MessageType::sync);
}

TEST_F(PlayerTest, ClosedDevicesAreSilent) {
  client.open(kLaserDevice);
  client.access(kPosition, Access::close);
  run.tick({run.reading(sensors::kLaser, {1.0, 2.0, 3.0})});
  EXPECT_EQ(client.receive().header.address, kLaserDevice);
  client.access(kLaserDevice, Access::close);
  run.tick({run.reading(sensors::kLaser, {1.0, 2.0, 3.0})});
  client.send(MessageType::request, kPosition, 1);
  EXPECT_EQ(client.receive().header.type, MessageType::ack) << "no message before it";
}

TEST_F(PlayerTest, ScansHaveNoNaNAndNoNegativeRange) {
  client.access(kPosition, Access::close);
  client.open(kLaserDevice);
  const Message data = data_after(client, [&] { run.tick({run.reading(sensors::kLaser, {kNaN, -1.0, kInf})}); });
  EXPECT_EQ(data.header.time, 1.5) << "of the measurement";
  XdrReader xdr(data.payload);
  for (const double value : {-M_PI / 2, M_PI / 2, M_PI / 2, 8.0})
    EXPECT_NEAR(std::bit_cast<float>(xdr.get()), value, 1e-6);
  EXPECT_EQ(floats(xdr), (std::vector<double>{8.0, 0.0, 8.0}));
  EXPECT_EQ(xdr.get(), 3u) << "intensities";
  xdr.get(), xdr.get();
  EXPECT_EQ(xdr.get(), 7u) << "sequence number";
  EXPECT_TRUE(xdr.done());
}

/// Sonars, infrared sensors and lasers: float32 represents 8 and 0.7, or the numbers next to 3.3.
TEST(PlayerRangers, AValidRangeIsSentBelowTheMaximum) {
  for (const double max : {8.0, 0.7, 3.3, 5.1}) {
    const sensors::SensorSpec sensor{.limit = max, .range_min = 0.3};
    const Device device{.interf = Interface::sonar, .sensor = &sensor, .type = sensors::kSonar};
    LastReading reading;
    reading.values = {std::nextafter(max, 0.0), max * (1.0 - 0x1p-26), max * (1.0 - 0x1p-22), max, kInf, 0.3, 0.1};
    base::Bytes bytes;
    XdrWriter writer(bytes);
    put_reading(device, reading, {}, false, writer);
    XdrReader xdr(bytes);
    const std::vector<double> sent = floats(xdr);
    const auto most = static_cast<double>(static_cast<float>(max)), least = static_cast<double>(0.3F);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT(sent[i], most) << max;
      EXPECT_NEAR(sent[i], reading.values[i], 0x1p-23 * max);
    }
    EXPECT_EQ(sent[3], most) << "no echo";
    EXPECT_EQ(sent[4], most);
    EXPECT_EQ(sent[5], least);
    EXPECT_EQ(sent[6], least) << "too near";
  }
}

TEST_F(PlayerTest, TheFirstRangesOfARangerIncludeItsConfiguration) {
  const Address ranger{Interface::ranger, 0};
  client.access(kPosition, Access::close);
  for (int opened = 0; opened < 2; ++opened) {  // and again after it is reopened
    client.open(ranger);
    const Message first = data_after(client, [&] { run.tick({run.reading(sensors::kLaser, {1.0, 2.0, 3.0})}); });
    EXPECT_EQ(first.header.subtype, 2u);
    EXPECT_EQ(first.payload.size(), 8 + 24 + 4 + (88 + 72) + 4 + 56u);
    const Message later = data_after(client, [&] { run.tick({run.reading(sensors::kLaser, {1.0, 2.0, 3.0})}); });
    EXPECT_EQ(later.header.subtype, 1u);
    EXPECT_EQ(later.payload.size(), 8 + 24u);
    client.access(ranger, Access::close);
  }
  const Message geometry = client.request(ranger, 1);
  XdrReader xdr(geometry.payload);
  EXPECT_EQ(xdr.get_double(), 0.1) << "the laser's place on the robot";
  const Message config = client.request(ranger, 5);
  XdrReader numbers(config.payload);
  for (const double value : {-M_PI / 2, M_PI / 2, M_PI / 2, 0.0, 8.0, 0.0, 5.0})
    EXPECT_NEAR(numbers.get_double(), value, 1e-12);
  EXPECT_EQ(ask(ranger, 4, config.payload), MessageType::ack) << "setting it has no effect";
}

/// Clients compute the bearing of range i of an element as its minimum angle plus i times the resolution.
TEST(PlayerRangers, TheBearingOfASingleRangeIsZero) {
  const PlayerRun run(R"(
model( name "wall" pose [9 0 0 0] size [1 1 1] )
position(
  name "ann" size [0.3 0.3 0.3]
  ranger( sensor( range [0 8] fov 180 samples 1 ) )
  ranger( sensor( range [0 8] fov 180 samples 2 ) )
  sonar( scount 2 spose[0] [0.1 0 0] spose[1] [0 0.1 90] range [0.1 4] fov 20 )
  infrared( range [0 0.5] fov 30 )
)
)");
  const Devices devices(run.world, run.sensor_set);
  std::vector<std::pair<double, double>> angles;
  for (const Device& device : devices.rows()) {
    if (device.interf != Interface::ranger) continue;
    XdrReader config(device.config);
    angles.emplace_back(config.get_double(), 0.0);
    angles.back().second = config.get_double();
  }
  ASSERT_EQ(angles.size(), 4u);
  const std::pair zero{0.0, 0.0};
  EXPECT_EQ(angles[0], zero) << "a scan of one beam";
  EXPECT_NEAR(angles[1].first, -M_PI / 2, 1e-12) << "a scan of two beams";
  EXPECT_NEAR(angles[1].second, M_PI / 2, 1e-12);
  EXPECT_EQ(angles[2], zero) << "a sonar's transducer, which its geometry turns";
  EXPECT_EQ(angles[3], zero) << "an infrared sensor's element";
}

TEST_F(PlayerTest, ArraysHaveRangesVoltagesAndGeometry) {
  client.access(kPosition, Access::close);
  client.open({Interface::sonar, 0});
  const Message sonar = data_after(client, [&] { run.tick({run.reading(sensors::kSonar, {0.5, 9.0})}); });
  XdrReader ranges(sonar.payload);
  EXPECT_EQ(floats(ranges), (std::vector<double>{0.5, 4.0}));
  client.access({Interface::sonar, 0}, Access::close);
  client.open({Interface::ir, 0});
  const Message infrared = data_after(client, [&] {
    run.tick({run.reading(sensors::kInfrared, {0.25, 1023.0, 0.5, 0.0})});
  });
  XdrReader both(infrared.payload);
  EXPECT_EQ(floats(both), (std::vector<double>{5.0, 0.0})) << "volts";
  EXPECT_EQ(floats(both), (std::vector<double>{0.25, 0.5})) << "metres";
  const Message poses = client.request({Interface::sonar, 0}, 1);
  XdrReader geometry(poses.payload);
  EXPECT_EQ(geometry.get(), 2u);
  geometry.get();
  for (const double value : {0.1, 0.05}) EXPECT_NEAR(geometry.get_double(), value, 1e-12);
  for (int i = 0; i < 3; ++i) geometry.get_double();
  EXPECT_NEAR(geometry.get_double(), M_PI / 4, 1e-12);
  EXPECT_EQ(client.request({Interface::ir, 0}, 1).payload.size(), 8 + 2 * 48u);
}

TEST_F(PlayerTest, BumpersArePressedAndLieOnTheBody) {
  client.access(kPosition, Access::close);
  client.open({Interface::bumper, 0});
  const Message data = data_after(client, [&] { run.tick({run.reading(sensors::kBumper, {0.0, 1.0})}); });
  EXPECT_EQ(data.payload, (base::Bytes{0, 0, 0, 2, 0, 0, 0, 2, 0, 1, 0, 0}));
  const Message answer = client.request({Interface::bumper, 0}, 1);
  XdrReader xdr(answer.payload);
  EXPECT_EQ(xdr.get(), 2u);
  xdr.get();
  const double radius = std::hypot(0.2, 0.15);  // corner of the body
  for (const double value : {radius * std::sqrt(0.5), radius * std::sqrt(0.5), 0.0, 0.0, 0.0, M_PI / 4})
    EXPECT_NEAR(xdr.get_double(), value, 1e-9) << "the left switch is in the middle of 0 and 90 degrees";
  EXPECT_NEAR(std::bit_cast<float>(xdr.get()), radius * M_PI / 2, 1e-6);
}

TEST_F(PlayerTest, ReceiversUseMetresAndAMissingFixHasNoNaN) {
  client.access(kPosition, Access::close);
  client.open({Interface::gps, 0});
  const auto read = [&](double x, double y, double hdop) {
    return data_after(client, [&] { run.tick({run.reading(sensors::kGps, {x, y, hdop, 6.0})}); }).payload;
  };
  const base::Bytes there = read(111.3195, -110.5743, 1.26);
  XdrReader xdr(there);
  EXPECT_EQ(xdr.get(), 1u);
  EXPECT_EQ(xdr.get(), 500'000u);
  EXPECT_EQ(static_cast<std::int32_t>(xdr.get()), -10'000) << "a thousandth of a degree south";
  EXPECT_EQ(static_cast<std::int32_t>(xdr.get()), 10'000);
  xdr.get(), xdr.get_double(), xdr.get_double();
  EXPECT_EQ(xdr.get_double(), 11'132.0) << "centimetres, as clients read them";
  EXPECT_EQ(xdr.get_double(), -11'057.0);
  for (const std::uint32_t value : {1u, 6u, 13u}) EXPECT_EQ(xdr.get(), value) << "fix, satellites, 10 HDOP";
  EXPECT_EQ(xdr.get(), 0u) << "no VDOP";
  EXPECT_EQ(xdr.get_double(), 0.0) << "no error along x";
  EXPECT_EQ(xdr.get_double(), 0.0) << "nor along y";
  EXPECT_TRUE(xdr.done());
  const base::Bytes lost = read(kNaN, kNaN, kNaN);
  XdrReader none(std::span<const std::uint8_t>(lost).subspan(8 + 12 + 16 + 16));
  EXPECT_EQ(none.get(), 0u) << "no fix";
  EXPECT_EQ(none.get(), 6u) << "satellites";
  EXPECT_EQ(none.get(), 0u) << "no number";
}

/// A robot with two lane edges, a magnetometer of two elements and a cliff sensor: types without an interface in
/// Player.
const char* const kOpaque = R"(
name "opaque"
position( name "ann" size [0.4 0.3 0.2]
  cliff( )
  magnetometer( name "coils" scount 2 spose[0] [0.1 0.1 0] spose[1] [0.1 -0.1 0] )
  laneedge( name "left" )
  laneedge( name "right" )
  occupancy( )
  laser( samples 3 fov 180 range_max 8 )
)
)";

struct PlayerOpaque : testing::Test {
  PlayerOpaque() { client.banner(); }
  /// Returns the numbers of the opaque data, and checks its layout with a decoder of its own.
  std::vector<double> values(const Message& data, std::array<std::uint32_t, 4> head) {
    const base::Bytes& b = data.payload;
    const auto word = [&](std::size_t at) {
      return std::uint32_t{b[at]} | std::uint32_t{b[at + 1]} << 8 | std::uint32_t{b[at + 2]} << 16 |
             std::uint32_t{b[at + 3]} << 24;
    };
    const std::size_t size = 16 + std::size_t{8} * head[2] * head[3];
    EXPECT_EQ(b.size(), 8 + size);
    EXPECT_EQ(b[7], size & 0xFF) << "the count twice, in XDR";
    EXPECT_EQ(b[3], size & 0xFF);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(word(8 + 4 * i), head[i]) << i;
    std::vector<double> numbers;
    for (std::size_t at = 24; at + 8 <= b.size(); at += 8)
      numbers.push_back(std::bit_cast<double>(std::uint64_t{word(at + 4)} << 32 | word(at)));
    return numbers;
  }
  Message next(std::uint8_t type, std::uint32_t sensor, const std::vector<double>& read) {
    base::ReadingBlock reading = run.reading(type, read);
    reading.sensor = sensor;
    return data_after(client, [&] { run.tick({reading}); });
  }
  PlayerRun run{kOpaque};
  TestClient client{run.port()};
};

TEST_F(PlayerOpaque, DevicesAreOrderedByType) {
  const std::vector<Address> all = listed(client);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const Address& a) { return a.interf == Interface::opaque; }), 4)
      << "no map";
  const char* const names[] = {"ann.left", "ann.right", "ann.coils", "ann.cliff"};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Message info = client.request({}, server_request::driver_info, xdr_of(0u, 0u, 51u, i, 0u, 0u));
    XdrReader xdr(info.payload);
    for (int k = 0; k < 4; ++k) xdr.get();
    EXPECT_EQ(xdr.get_text(100).substr(0, 9), std::string(names[i]).substr(0, 9));
  }
}

TEST_F(PlayerOpaque, LaneEdgesHaveFourColumns) {
  client.open({Interface::opaque, 1});
  const Message data = next(sensors::kLaneEdge, 1, {0.25, 12.0, 0.001, 0.002});
  EXPECT_EQ(data.header.address, (Address{Interface::opaque, 1}));
  EXPECT_EQ(data.header.subtype, 1u);
  EXPECT_NEAR(data.header.time, 1.5, 1e-12) << "of the measurement";
  EXPECT_EQ(values(data, {2, 7, 1, 4}), (std::vector<double>{0.25, 12.0, 0.001, 0.002}));
  EXPECT_TRUE(std::isnan(values(next(sensors::kLaneEdge, 1, {kNaN, 0.0, kNaN, kNaN}), {2, 7, 1, 4})[0]))
      << "no edge in sight";
}

TEST_F(PlayerOpaque, MagnetometersHaveARowForEachElement) {
  client.open({Interface::opaque, 2});
  const std::vector<double> fields{5e-5, 3e-5, -4e-5, 0.0, 1e-4, 0.0, 0.0, -1e-4};
  EXPECT_EQ(values(next(sensors::kMagnetometer, 0, fields), {3, 7, 2, 4}), fields);
}

TEST(PlayerFiducial, ScansHavePosesInTheFindersFrame) {
  PlayerRun run(R"(name "finder"
position( name "ann" size [0.4 0.3 0.2] fiducial( detections 3 ) ))");
  TestClient client(run.port());
  client.banner();
  client.open({Interface::fiducial, 0});
  const std::vector<double> seen{7.0, 2.0, 2.0, M_PI / 2, 0.25, 0.0, 1.0, 5.0, 0.0, 0.0, kNaN, kNaN, kNaN, kNaN, kNaN};
  const Message data = data_after(client, [&] { run.tick({run.reading(sensors::kFiducial, seen)}); });
  EXPECT_EQ(data.header.subtype, 1);
  XdrReader xdr(data.payload);
  EXPECT_EQ(xdr.get(), 2u);
  EXPECT_EQ(xdr.get(), 2u) << "the count twice";
  EXPECT_EQ(xdr.get(), 7u);
  EXPECT_NEAR(xdr.get_double(), 0.0, 1e-12);
  EXPECT_NEAR(xdr.get_double(), 2.0, 1e-12) << "to the left";
  for (int i = 0; i < 3; ++i) EXPECT_EQ(xdr.get_double(), 0.0);
  EXPECT_EQ(xdr.get_double(), 0.25);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(xdr.get_double(), 0.0) << "no uncertainty";
  EXPECT_EQ(xdr.get(), 0xFFFFFFFFu) << "too far for its id";
  EXPECT_EQ(xdr.get_double(), 5.0);
}

TEST_F(PlayerOpaque, HasNoRequests) {
  for (const std::uint32_t subtype : {0u, 1u, 2u, 255u})
    EXPECT_EQ(client.request({Interface::opaque, 0}, subtype).header.type, MessageType::nack) << subtype;
  client.open({Interface::opaque, 0});
  client.send(MessageType::command, {Interface::opaque, 0}, 1, xdr_of(0u, 0u));
  EXPECT_EQ(client.request({Interface::opaque, 0}, 1).header.type, MessageType::nack) << "commands are ignored";
}

TEST_F(PlayerTest, VelocitiesBecomeCommands) {
  drive(0.2, 0.1, -0.3);
  const Requests asked = run.asked();
  ASSERT_EQ(asked.commands.size(), 1u);
  EXPECT_EQ(asked.commands[0].mover, 0u);
  EXPECT_EQ(asked.commands[0].twist.left, 0.1);
  EXPECT_EQ(asked.commands[0].twist.turn, -0.3);
  EXPECT_TRUE(run.asked().commands.empty()) << "requested once";
  drive(0.1, 0.0, 0.0), drive(0.5, 0.0, 0.0);
  EXPECT_EQ(run.asked().commands.size(), 1u) << "the newest";
}

TEST_F(PlayerTest, InvalidAndUnsubscribedCommandsAreIgnored) {
  drive(kNaN, 0.0, 0.0), drive(kInf, 0.0, 0.0), drive(std::nextafter(1e6, 1e7), 0.0, 0.0);
  for (const std::uint32_t unknown : {0u, 5u}) client.send(MessageType::command, kPosition, unknown);
  settle();
  TestClient stranger(run.port());
  stranger.banner();
  stranger.send(MessageType::command, kPosition, 1, xdr_of(1.0, 0.0, 0.0, 1u));
  stranger.request(kPosition, 1);
  EXPECT_TRUE(run.asked().commands.empty());
  drive(1e6, 0.0, 0.0);
  EXPECT_EQ(run.asked().commands.size(), 1u) << "at the limit";
}

TEST_F(PlayerTest, ModesAreAcknowledgedAndStopNoRobot) {
  drive(0.2, 0.0, 0.0);
  for (const std::uint32_t mode : {3u, 4u}) EXPECT_EQ(ask(kPosition, mode, xdr_of(0u)), MessageType::ack);
  EXPECT_EQ(run.asked().commands.at(0).twist.forward, 0.2);
}

TEST_F(PlayerTest, RobotsStopWithoutMotorsAndUsers) {
  drive(0.2, 0.0, 0.0);
  EXPECT_EQ(ask(kPosition, 2, xdr_of(0u)), MessageType::ack);
  drive(0.3, 0.0, 0.0);
  ASSERT_EQ(run.asked().commands.size(), 1u);
  EXPECT_EQ(ask(kPosition, 2, xdr_of(1u)), MessageType::ack);
  drive(0.3, 0.0, 0.0);
  EXPECT_EQ(run.asked().commands.at(0).twist.forward, 0.3);
  client.access(kPosition, Access::close);
  EXPECT_EQ(run.asked().commands.at(0).twist.forward, 0.0) << "its last user has left";
}

TEST_F(PlayerTest, CarsSteerByTheAngleOfTheirWheels) {
  client.send(MessageType::command, kPosition, 3, xdr_of(0.4, 0.5));
  settle();
  EXPECT_EQ(run.asked().commands.at(0).twist.turn, 0.5) << "a rate, for robots other than cars";
  PlayerRun cars("name \"c\"\nposition( name \"car\" drive \"car\" wheelbase 0.5 size [0.6 0.3 0.2] )\n");
  TestClient driver(cars.port());
  driver.banner(), driver.open(kPosition);
  driver.send(MessageType::command, kPosition, 3, xdr_of(0.4, 0.5));
  driver.request(kPosition, 1);
  EXPECT_NEAR(cars.asked().commands.at(0).twist.turn, 0.4 * std::tan(0.5) / 0.5, 1e-12);
}

TEST_F(PlayerTest, RobotsDriveTowardsGoalsInEachTick) {
  run.tick();
  client.send(MessageType::command, kPosition, 2, xdr_of(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1u));
  settle();
  for (int i = 0; i < 3; ++i) {
    run.tick();
    EXPECT_EQ(run.asked().commands.at(0).twist.forward, 0.5) << "its largest speed";
  }
  client.send(MessageType::command, kPosition, 4, xdr_of(-0.2, 1.0));  // backwards, to the left
  settle();
  run.tick();
  const base::Twist twist = run.asked().commands.at(0).twist;
  EXPECT_EQ(twist.forward, -0.2);
  EXPECT_GT(twist.turn, 0.5);
  drive(0.1, 0.0, 0.0);
  EXPECT_EQ(run.asked().commands.at(0).twist.forward, 0.1);
  run.tick();
  EXPECT_TRUE(run.asked().commands.empty()) << "a velocity replaces a goal";
}

TEST_F(PlayerTest, GoalSpeedsAreLimitedByTheRobot) {
  run.tick();
  for (const auto& [asked, driven] : {std::pair{0.2, 0.2}, {0.5, 0.5}, {9.0, 0.5}, {-0.2, 0.5}}) {
    client.send(MessageType::command, kPosition, 2, xdr_of(3.0, 0.0, 0.0, asked, 0.0, 0.0, 1u));
    settle();
    run.tick();
    EXPECT_EQ(run.asked().commands.at(0).twist.forward, driven) << asked;
  }
}

TEST(PlayerGoals, CarsRejectThem) {
  PlayerRun cars("name \"c\"\nposition( name \"car\" drive \"car\" wheelbase 0.5 size [0.6 0.3 0.2] )\n");
  TestClient driver(cars.port());
  driver.banner(), driver.open(kPosition);
  driver.send(MessageType::command, kPosition, 2, xdr_of(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1u));
  driver.request(kPosition, 1);
  cars.tick();
  EXPECT_TRUE(cars.asked().commands.empty());
}

TEST_F(PlayerTest, AGoalAtTheRobotIsAHeading) {
  run.tick();
  for (const double yaw : {1.0, -1.0}) {
    client.send(MessageType::command, kPosition, 2, xdr_of(0.0, 0.0, yaw, 0.0, 0.0, 0.0, 1u));
    settle();
    run.tick();
    const base::Twist twist = run.asked().commands.at(0).twist;
    EXPECT_EQ(twist.forward, 0.0) << yaw;
    EXPECT_GT(twist.turn * yaw, 0.1) << yaw;
  }
}

TEST_F(PlayerTest, OdometryIsSetAndReset) {
  const auto position = [&] {
    const Message data = data_after(client, [&] { run.tick(); });
    XdrReader xdr(data.payload);
    return base::Pose{xdr.get_double(), xdr.get_double(), 0.0, xdr.get_double()};
  };
  position();
  EXPECT_EQ(ask(kPosition, 5, xdr_of(5.0, 6.0, 0.0)), MessageType::ack);
  run.reports[0].X_WM.y += 1.0;  // ahead
  EXPECT_NEAR(position().x, 6.0, 1e-12);
  EXPECT_NEAR(position().y, 6.0, 1e-12);
  EXPECT_EQ(ask(kPosition, 6), MessageType::ack);
  EXPECT_NEAR(position().x, 0.0, 1e-12);
  EXPECT_EQ(ask(kPosition, 5, xdr_of(kNaN, 6.0, 0.0)), MessageType::nack);
  run.reports[0].X_WM.y += 1.0;
  ++run.state.runs;  // the run restarts
  EXPECT_NEAR(position().x, 0.0, 1e-12);
  run.reports[0].X_WM.y += 1.0;
  ++run.state.runs;
  run.bridge.publish(run.state);  // and again, paused
  EXPECT_NEAR(position().x, 0.0, 1e-12);
}

TEST_F(PlayerTest, RobotsArePlacedByName) {
  run.tick();
  const Message answer = client.request(kSimulation, 1, named_pose("ben", kNaN, 0.0, 0.0));  // its pose is ignored
  EXPECT_EQ(answer.payload, named_pose("ben", 1.0, 1.0, 0.0));
  EXPECT_EQ(ask(kSimulation, 2, named_pose("ben", 2.0, -1.0, 0.5)), MessageType::ack);
  EXPECT_EQ(client.request(kSimulation, 1, named_pose("ben", 0.0, 0.0, 0.0)).payload, named_pose("ben", 2.0, -1.0, 0.5))
      << "before the next tick";
  const Requests asked = run.asked();
  ASSERT_EQ(asked.placements.size(), 1u);
  EXPECT_EQ(asked.placements[0].mover, 1u);
  run.reports[1].X_WM = {2.5, -1.0, 0.0, 0.5};
  run.tick();
  EXPECT_EQ(client.request(kSimulation, 1, named_pose("ben", 0.0, 0.0, 0.0)).payload,
            named_pose("ben", 2.5, -1.0, 0.5));
  EXPECT_EQ(ask(kSimulation, 1, named_pose("west", 0.0, 0.0, 0.0)), MessageType::ack) << "walls have poses";
  EXPECT_EQ(ask(kSimulation, 2, named_pose("west", 0.0, 0.0, 0.0)), MessageType::nack) << "and stay where they are";
  EXPECT_EQ(ask(kSimulation, 2, named_pose("eve", 0.0, 0.0, 0.0)), MessageType::nack);
  EXPECT_EQ(ask(kSimulation, 2, named_pose("ben", kInf, 0.0, 0.0)), MessageType::nack);
  base::Bytes deep = named_pose("ben", 3.0, 2.0, 9.0);  // x, y, z
  for (const double value : {0.0, 0.0, 0.25, 0.0}) XdrWriter(deep).put(value);
  EXPECT_EQ(ask(kSimulation, 4, deep), MessageType::ack);
  const base::Pose X_WM = run.asked().placements.at(0).X_WM;
  EXPECT_EQ(X_WM.y, 2.0);
  EXPECT_EQ(X_WM.yaw, 0.25);
  EXPECT_EQ(X_WM.z, 9.0);
}

TEST_F(PlayerTest, PosesIn3DIncludeTheTime) {
  run.reports[1].X_WM = {1.0, 2.0, 0.25, 0.5};
  run.tick();
  base::Bytes expected;
  XdrWriter xdr(expected);
  xdr.put_text("ben");
  xdr.put_all({1.0, 2.0, 0.25, 0.0, 0.0, 0.5, 0.1});
  EXPECT_EQ(client.request(kSimulation, 3, named_pose("ben", 0.0, 0.0, 0.0)).payload, expected);
  for (const std::uint32_t unknown : {0u, 5u})
    EXPECT_EQ(ask(kSimulation, unknown, named_pose("ben", 0.0, 0.0, 0.0)), MessageType::nack) << unknown;
  EXPECT_TRUE(run.asked().placements.empty());
}

/// Beyond a million metres distances lose millimetre resolution.
TEST_F(PlayerTest, PosesAreAcceptedUpToAMillionMetres) {
  const double most = 1e6, more = std::nextafter(most, 2 * most);
  const auto set = [&](double x, double y, double yaw) {
    const MessageType answer = ask(kSimulation, 2, named_pose("ben", x, y, yaw));
    EXPECT_EQ(ask(kPosition, 5, xdr_of(x, y, yaw)), answer) << "the same limits for odometry";
    return answer;
  };
  EXPECT_EQ(set(most, -most, 9.0), MessageType::ack);
  EXPECT_EQ(set(more, 0.0, 0.0), MessageType::nack);
  EXPECT_EQ(set(0.0, -more, 0.0), MessageType::nack);
  for (const double yaw : {kNaN, kInf}) EXPECT_EQ(set(0.0, 0.0, yaw), MessageType::nack) << yaw;
}

TEST_F(PlayerTest, RunsArePausedAndRestarted) {
  client.open(kSimulation);
  client.send(MessageType::command, kSimulation, 1);
  settle();
  EXPECT_EQ(run.asked().paused, std::optional(true));
  run.state.paused = true;
  run.bridge.publish(run.state);
  client.send(MessageType::command, kSimulation, 1);
  client.send(MessageType::command, kSimulation, 2);
  settle();
  const Requests asked = run.asked();
  EXPECT_EQ(asked.paused, std::optional(false));
  EXPECT_TRUE(asked.reset);
}

TEST_F(PlayerTest, ServicesAreReadOnly) {
  PlayerRun service(kTwoRobots, false);
  TestClient user(service.port());
  user.banner(), user.open(kPosition), user.open(kSimulation);
  user.send(MessageType::command, kPosition, 1, xdr_of(1.0, 0.0, 0.0, 1u));
  user.send(MessageType::command, kSimulation, 2);
  EXPECT_EQ(user.request(kSimulation, 2, named_pose("ben", 0.0, 0.0, 0.0)).header.type, MessageType::nack);
  EXPECT_EQ(user.request(kPosition, 2, xdr_of(0u)).header.type, MessageType::nack);
  const Requests asked = service.asked();
  EXPECT_TRUE(asked.commands.empty() && asked.placements.empty() && !asked.reset);
  service.tick();
  EXPECT_EQ(user.receive().header.type, MessageType::data);
}

TEST_F(PlayerTest, DevicesAreTurnedOffAndOn) {
  client.access(kPosition, Access::close);
  client.open(kLaserDevice);
  EXPECT_EQ(ask(kLaserDevice, 4, xdr_of(0u)), MessageType::ack);
  run.tick({run.reading(sensors::kLaser, {1.0, 1.0, 1.0}, 1)});
  EXPECT_EQ(ask(kLaserDevice, 4, xdr_of(1u)), MessageType::ack);
  run.tick({run.reading(sensors::kLaser, {1.0, 1.0, 1.0}, 2)});
  const Message data = client.receive();
  EXPECT_EQ(data.payload.back(), 2) << "sequence number of the first that is sent";
}

TEST_F(PlayerTest, AbsentRobotsAreSilent) {
  run.reports[0].X_WM = base::kAbsent;
  run.tick();
  client.send(MessageType::request, kSimulation, 1, named_pose("ann", 0.0, 0.0, 0.0));
  EXPECT_EQ(client.receive().header.type, MessageType::nack);
}

TEST_F(PlayerTest, MapsAreTilesAndSegments) {
  const Address map{Interface::map, 0};
  EXPECT_EQ(client.request(map, 1).payload, xdr_of(0.5f, 3u, 2u, -4.0, -3.0, 0.0));
  const Message tile = client.request(map, 2, xdr_of(1u, 0u, 10u, 100u, 0u, 0u, 0u));
  XdrReader cells(tile.payload);
  for (const std::uint32_t value : {1u, 0u, 2u, 2u}) EXPECT_EQ(cells.get(), value) << "clipped to the map";
  uLongf size = 9;
  base::Bytes plain(size);
  ASSERT_EQ(uncompress(plain.data(), &size, tile.payload.data() + 28, tile.payload.size() - 28), Z_OK);
  plain.resize(size);
  EXPECT_EQ(plain, (base::Bytes{0xFF, 0xFF, 0xFF, 1})) << "the last row has the wall";
  EXPECT_EQ(ask(map, 2, xdr_of(3u, 0u, 1u, 1u, 0u, 0u, 0u)), MessageType::nack) << "beyond the map";
  EXPECT_EQ(ask(map, 2, xdr_of(0u, 0u, 0u, 1u, 0u, 0u, 0u)), MessageType::nack) << "of no cells";
  EXPECT_EQ(client.request(map, 3).payload.size(), 16 + 8 + 8 * 32u) << "two walls of four sides";
}

/// For each interface, the requests without a payload that are granted. All other numbers are refused, including 0.
TEST_F(PlayerTest, OtherRequestsOfEachInterfaceAreRefused) {
  run.tick();
  const struct {
    Interface interf;
    std::vector<std::uint32_t> granted, with_payload;
  } rows[] = {{Interface::position2d, {1, 6}, {2, 3, 4, 5}},
              {Interface::laser, {1, 3}, {2, 4}},
              {Interface::ranger, {1, 5}, {2, 4}},
              {Interface::sonar, {1}, {2}},
              {Interface::ir, {1}, {2}},
              {Interface::bumper, {1}, {}},
              {Interface::gps, {}, {}},
              {Interface::simulation, {}, {1, 2, 3, 4}},
              {Interface::map, {1, 3}, {2}}};
  for (const auto& row : rows)
    for (const std::uint32_t subtype : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 255u}) {
      if (std::count(row.with_payload.begin(), row.with_payload.end(), subtype) > 0) continue;
      const bool granted = std::count(row.granted.begin(), row.granted.end(), subtype) > 0;
      EXPECT_EQ(ask({row.interf, 0}, subtype), granted ? MessageType::ack : MessageType::nack)
          << interface_name(row.interf) << " " << subtype;
    }
  for (const std::uint32_t subtype : {0u, 6u, 7u, 8u, 9u, 11u})
    EXPECT_EQ(ask({}, subtype), MessageType::nack) << subtype;
  EXPECT_EQ(ask({}, 10, xdr_of(0u, 0u, 0u, 0u, 0u)), MessageType::ack) << "a rule for newer data";
  for (const Address& unknown : {Address{Interface::laser, 2}, {Interface::gps, 1}, {Interface::player, 1}})
    EXPECT_EQ(client.request({}, 2, xdr_of(0u, 0u, static_cast<std::uint32_t>(unknown.interf), unknown.index, 0u, 0u))
                  .header.type,
              MessageType::nack);
  EXPECT_EQ(run.bridge.counts().malformed, 0u);
  // Names without a pose, and tiles at the map's edges.
  EXPECT_EQ(ask(kSimulation, 1, named_pose("eve", 0.0, 0.0, 0.0)), MessageType::nack);
  EXPECT_EQ(ask(kSimulation, 3, named_pose("eve", 0.0, 0.0, 0.0)), MessageType::nack);
  const Address map{Interface::map, 0};
  EXPECT_EQ(ask(map, 2, xdr_of(2u, 1u, 1u, 1u, 0u, 0u, 0u)), MessageType::ack) << "the last cell";
  EXPECT_EQ(ask(map, 2, xdr_of(2u, 2u, 1u, 1u, 0u, 0u, 0u)), MessageType::nack);
  EXPECT_EQ(ask(map, 2, xdr_of(2u, 1u, 1u, 0u, 0u, 0u, 0u)), MessageType::nack);
}

TEST_F(PlayerTest, PortsInUseAreNamed) {
  const std::string refusal = refusal_of([&] { PlayerBridge(run.scene, run.bridge.endpoint()); });
  expect_in(std::to_string(run.bridge.endpoint().port), refusal);
  expect_in("another program uses this port", refusal);
  expect_in("beyond 65535", refusal_of([&] { PlayerBridge(run.scene, {netio::kLoopback, 65535}); }));
}

TEST_F(PlayerTest, DescribesWhichRobotIsOnWhichPort) {
  const auto described = [](const PlayerRun& of) {
    const std::string line = of.bridge.describe(), port = std::to_string(of.bridge.endpoint().port);
    return line.substr(line.find(port) + port.size());
  };
  const auto port = [](const PlayerRun& of, int more) { return std::to_string(of.bridge.endpoint().port + more); };
  const PlayerRun one("name \"e\"\nposition( )\n"), two("name \"e\"\nposition( ) position( )\n"),
      four("name \"e\"\nposition( ) position( ) position( ) position( )\n");
  EXPECT_EQ(described(one), "");
  EXPECT_EQ(described(two), " for all robots, port " + port(two, 1) + " for robot 2 alone");
  EXPECT_EQ(described(four),
            " for all robots, ports " + port(four, 1) + " to " + port(four, 3) + " for robots 2 to 4 alone");
}

TEST(PlayerOdometry, IsThatOfTheEncoders) {
  PlayerRun run("name \"e\"\nposition( name \"ann\" pose [3 4 0 0] size [0.4 0.3 0.2] encoder( track 0.5 ) )\n");
  TestClient client(run.port());
  client.banner(), client.open(kPosition);
  run.reports[0].X_WM.x += 9.0;  // without wheel motion
  run.tick({run.reading(sensors::kEncoder, {1.0, 1.0, 1000.0, 1000.0})});
  client.receive();
  run.tick({run.reading(sensors::kEncoder, {1.0, 1.0 + 0.25 * M_PI, 1000.0, 1785.0})});
  const Message data = client.receive();
  XdrReader xdr(data.payload);
  EXPECT_NEAR(xdr.get_double(), 1.25, 1e-12) << "a quarter of a circle about the left wheel";
  EXPECT_NEAR(xdr.get_double(), 0.25, 1e-12);
  EXPECT_NEAR(xdr.get_double(), M_PI / 2, 1e-12);
}

TEST(PlayerGoals, AreReachedFromAnywhere) {
  world::Mover robot;
  for (const double yaw : {-3.0, -1.0, 0.0, 2.0, 3.1})
    for (const glm::dvec2& to : {glm::dvec2{1.0, 0.0}, glm::dvec2{-2.0, 0.5}, glm::dvec2{0.0, 0.0}}) {
      base::Pose X_OM{0.0, 0.0, 0.0, yaw};
      const Goal goal{{to.x, to.y, 0.0, 1.5}, 0.5};
      for (int tick = 0; tick < 200; ++tick) {
        const base::Twist twist = steer(robot, X_OM, goal);
        EXPECT_LE(std::abs(twist.forward), 0.5);
        EXPECT_LE(std::abs(twist.turn), robot.max_turn);
        X_OM = {X_OM.x + 0.1 * twist.forward * std::cos(X_OM.yaw), X_OM.y + 0.1 * twist.forward * std::sin(X_OM.yaw),
                0.0, X_OM.yaw + 0.1 * twist.turn};
      }
      EXPECT_NEAR(X_OM.x, to.x, 0.02) << yaw;
      EXPECT_NEAR(X_OM.y, to.y, 0.02) << yaw;
      EXPECT_NEAR(base::wrap_angle(X_OM.yaw - 1.5), 0.0, 0.01) << yaw;
    }
}

}  // namespace sf::bridges::player
