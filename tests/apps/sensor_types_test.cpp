// Every sensor type with every command: with the same arguments, files and packets.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "netio/packets.h"
#include "netio/socket.h"
#include "netio/v2v_socket.h"
#include "record/recording.h"
#include "sensors/sensor_type.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/netio/documented.h"
#include "tests/refusal.h"
#include "viz/series_figure.h"

namespace sf {

namespace {

constexpr std::uint8_t kLaneEdge = 2;
constexpr std::uint8_t kMagnetometer = 3;

// A magnet of 1 A m^2, and robots with a laser and two elements 0.5 m and 1 m ahead, at the height of the magnet.
const char* const kTypesWorld = R"(
define bot position
(
  size [0.3 0.3 0.1]
  laser( samples 3 fov 90 range_max 8 size [0 0 0.04] pose [0 0 -0.06 0] )
  magnetometer( name "array" pose [0.5 0 -0.1 0] size [0.02 0.3 0.1] scount 2 spose[0] [0 0 0] spose[1] [0.5 0 0] )
)
bot( name "one" pose [0 0 0 0] )
bot( name "two" pose [0 50 0 0] )
position( name "blind" pose [0 80 0 0] )
model( name "magnet" pose [1.5 0 0 0] size [0.1 0.1 0.1] magnetic_moment 10000 )
)";

struct SensorTypes : testing::Test {
  Folder folder;
  std::string world = folder.write("types.world", kTypesWorld);
};

/// Runs `command` with its world and `words`, and the options that all of these tests need.
Outcome run(const std::string& command, const std::string& world, const Words& more) {
  return run_program(with({command, world}, more));
}

/// Two free port bases.
Words free_bases(unsigned& base) {
  base = free_ports(80);
  return {"--laser-port", std::to_string(base), "--magnetometer-port", std::to_string(base + 40)};
}

}  // namespace

TEST_F(SensorTypes, AMagnetometerReadsTheComputedField) {
  const Outcome outcome = run("sense", world, {"--type", "magnetometer", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json reading(outcome.out);
  EXPECT_EQ(reading.text("/robot"), "one");
  EXPECT_EQ(reading.text("/type"), "magnetometer");
  EXPECT_EQ(reading.text("/sensor_name"), "array");
  EXPECT_EQ(reading.size("/sensor_pose"), 3u);
  ASSERT_EQ(reading.size("/sensors"), 2u);
  ASSERT_EQ(reading.size("/sensors/0/vector_T"), 3u);
  // In the plane of a dipole, the field is mu0 / (4 pi) m / r^3, opposite to the moment: 1 m and 0.5 m away.
  EXPECT_NEAR(reading.number("/sensors/0/field_T"), 1e-7, 1e-13);
  EXPECT_NEAR(reading.number("/sensors/0/vector_T/2"), -1e-7, 1e-13);
  EXPECT_NEAR(reading.number("/sensors/1/field_T"), 8e-7, 1e-12);
  EXPECT_NEAR(reading.number("/sensors/1/vector_T/0"), 0.0, 1e-12);
}

TEST_F(SensorTypes, WithoutATypeTheFirstKindIsUsed) {
  EXPECT_EQ(Json(run("sense", world, {"--json"}).out).text("/type"), "laser");
  const std::string only = folder.write("only.world", "position( name \"a\" magnetometer( ) )\n");
  EXPECT_EQ(Json(run("sense", only, {"--json"}).out).text("/type"), "magnetometer");
}

TEST_F(SensorTypes, WithoutATypeNumbersCountAllKinds) {
  const Json second(run("sense", world, {"--sensor", "1", "--json"}).out);
  EXPECT_EQ(second.text("/type"), "magnetometer");
  EXPECT_EQ(second.number("/sensor"), 0) << "the first of its type";
  const std::string twice =
      folder.write("twice.world", "position( name \"a\" laser( ) laser( ) magnetometer( ) magnetometer( ) )\n");
  const Json last(run("sense", twice, {"--sensor", "3", "--json"}).out);
  EXPECT_EQ(last.text("/type"), "magnetometer") << "after the ports of all lasers";
  EXPECT_EQ(last.number("/sensor"), 1);
}

TEST_F(SensorTypes, AMissingSensorIsRejectedWithTheAvailableOnes) {
  struct Wrong {
    Words arguments;
    std::string message;
  };
  const std::string lasers = folder.write("lasers.world", "position( name \"a\" laser( ) laser( ) )\n");
  const std::string none = folder.write("none.world", "position( name \"a\" )\n");
  for (const auto& [arguments, message] : std::vector<Wrong>{
           {{world, "--sensor", "2"}, "one has no sensor 2; it has laser 0, magnetometer 0"},
           {{world, "--type", "laser", "--sensor", "1"}, "one has no laser 1; it has laser 0, magnetometer 0"},
           {{world, "--type", "magnetometer", "--sensor", "1"}, "one has no magnetometer 1; it has laser 0"},
           {{world, "--robot", "blind"}, "blind has no sensor"},
           {{lasers, "--type", "magnetometer"}, "no robot has such a sensor; give one a magnetometer( )"},
           {{lasers, "--type", "magnetometer", "--robot", "a"}, "a has no magnetometer 0; it has laser 0 to 1"},
           {{lasers, "--type", "magnetometer", "--robot", "b"}, "no robot 'b'; robots with sensors: none"},
           {{none}, "no robot has such a sensor; give one a laser( )"},
       }) {
    expect_refused(with({"sense"}, arguments), message);
  }
}

TEST_F(SensorTypes, CheckReportsTheEffectOfACutoff) {
  const std::string cut = folder.write("cut.world", "magnet_cutoff 2\n" + std::string(kTypesWorld));
  const Json facts(run("check", cut, {"--json"}).out);
  EXPECT_EQ(facts.number("/magnet_cutoff_m"), 2);
  // 1 A m^2 at 2 m, at the height of the elements: 1e-7 / 2^3 T plus a rounding margin, so the text rounds up.
  EXPECT_NEAR(facts.number("/field_truncation_T"), 1.25e-8, 1e-12);
  EXPECT_GT(facts.number("/field_truncation_T"), 1.25e-8);
  EXPECT_NE(run("check", cut, {}).out.find("the omitted field is at most 1.26e-08 T"), std::string::npos);
}

TEST_F(SensorTypes, CheckReportsTheEarthsFieldAndLamps) {
  const std::string lit =
      folder.write("lit.world", "earth_field [0.3 0 -0.4]\nmodel( size [1 1 1] pose [9 9 0 0] lamp_intensity 5 )\n" +
                                    std::string(kTypesWorld));
  const Json facts(run("check", lit, {"--json"}).out);
  EXPECT_EQ(facts.number("/earth_field_T/2"), -4e-5);
  EXPECT_EQ(facts.number("/lamps"), 1);
  expect_in("[0.3 0 -0.4] Gauss, of 0.5 Gauss", run("check", lit, {}).out);
}

TEST_F(SensorTypes, EveryCommandReportsTheLineOfInvalidSettings) {
  const std::string bad = folder.write("bad.world", "position\n(\n  magnetometer( scount 99 )\n)\n");
  for (const std::string command : {"check", "sense", "run", "serve", "listen"}) {
    expect_refused({command, bad}, "bad.world:3: ");
  }
}

TEST_F(SensorTypes, EveryPacketArrivesOnEitherWire) {
  for (const std::string wire : {"farm", "thesis"}) {
    unsigned base = 0;
    const Words bases = free_bases(base);
    const Words listen = with({"listen", world, "--json", "--wire", wire, "--silence", "100"}, bases);
    Program listener(listen);
    ASSERT_TRUE(listener.prints("listening on 4 ports")) << listener.err();
    const Words words = with({"--duration", "2", "--send", "127.0.0.1", "--json", "--wire", wire}, bases);
    const Outcome sent = run("run", world, words);
    ASSERT_EQ(sent.code, 0) << sent.err;
    const Outcome received = listener.stop();
    const Json out(sent.out), in(received.out);
    EXPECT_EQ(out.number("/packets/sent"), 2 * 20 * 2);
    EXPECT_EQ(out.number("/packets/not_numbers"), 0);
    EXPECT_EQ(in.number("/good"), 2 * 20 * 2) << received.out;
    EXPECT_EQ(in.number("/lost"), 0);
    EXPECT_EQ(in.number("/silent_ports"), 0);
    EXPECT_EQ(in.number("/rays"), 2 * 20 * 3);
    EXPECT_EQ(in.number("/sensors/magnetometer/good"), 2 * 20);
    EXPECT_EQ(in.number("/sensors/magnetometer/elements"), 2 * 20 * 2);
    // Each element is paired with the magnet; a run counts the pairs.
    EXPECT_EQ(out.number("/dipoles"), 2 * 20 * 2);
  }
}

TEST_F(SensorTypes, KindsOnOnePortAreDistinguished) {
  const Outcome outcome =
      run("serve", world, {"--port", "0", "--magnetometer-port", "10008", "--ports-per-robot", "8"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
  for (const std::string message : {"laser 0", "magnetometer 0", "share port 10008", "--magnetometer-port"})
    EXPECT_NE(outcome.err.find(message), std::string::npos) << message << " is not in: " << outcome.err;
}

TEST_F(SensorTypes, ARobotGetsTheRequestedKinds) {
  unsigned base = 0;
  Words words{"serve", world, "--port", "0", "--rate", "50", "--json"};
  const Words bases = free_bases(base);
  words.insert(words.end(), bases.begin(), bases.end());
  Program program(words);
  ASSERT_TRUE(program.prints("; press Ctrl-C to stop")) << program.err();
  const std::string message = program.err();
  const auto service = static_cast<std::uint16_t>(std::atoi(message.c_str() + message.find("127.0.0.1:") + 10));

  const std::uint16_t id = 1;  // the first robot of the file
  const netio::Socket lasers = netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(base + 8)});
  const netio::Socket arrays = netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(base + 48)});
  netio::V2vSocket v2v_socket({.farm = {netio::kLoopback, service}, .robot = id, .others = {}});
  netio::ReceiveBatch batch(16);
  std::size_t received = 0;
  for (std::uint32_t sequence = 0; sequence < 3000 && received < 3; ++sequence) {
    base::Bytes request;
    netio::encode({.robot = id, .sequence = sequence}, netio::Subscribe{1u << kMagnetometer}, request);
    v2v_socket.send(request);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    netio::Packet answer;
    v2v_socket.receive([&](std::span<const std::uint8_t> bytes) { v2v_socket.accept(bytes, 0, answer); });
    const std::size_t count = batch.fill(arrays);
    for (std::size_t i = 0; i < count; ++i) {
      netio::Packet packet;
      ASSERT_EQ(netio::decode(batch.bytes(i), packet), netio::PacketStatus::accepted);
      EXPECT_EQ(netio::sensor_type_of(packet.header.type), kMagnetometer);
      EXPECT_EQ(batch.bytes(i).size(), 64u + 4u + 2u * 16u);
    }
    received += count;
  }
  EXPECT_GE(received, 3u);
  EXPECT_EQ(batch.fill(lasers), 0u) << "scans were not requested";
  const Json facts(program.stop().out);
  EXPECT_EQ(facts.number("/rays"), 0);
  EXPECT_GT(facts.number("/dipoles"), 0);
}

/// Builds the figure of two magnetometers with two elements each, in Gauss: one panel each, and the difference of the
/// last and the first element.
viz::SeriesOptions fields_of(const record::Recording& recording) {
  viz::SeriesOptions options{"Magnetic field", recording.info.world + ": 2 sensors", {}};
  viz::Panel difference{"last element minus first", "difference of |B| [G]", {}};
  for (std::uint32_t mover = 0; mover < 2; ++mover) {
    const std::string& name = recording.info.movers[mover].name;
    viz::Series first{"element 0", {}, {}}, last{"element 1", {}, {}}, more{name, {}, {}};
    for (const record::ReadingSample& reading : recording.readings) {
      if (reading.mover != mover || reading.type != kMagnetometer) continue;
      for (viz::Series* series : {&first, &last, &more}) series->times.push_back(1e-9 * double(reading.time));
      first.values.push_back(1e4 * reading.values[0]);
      last.values.push_back(1e4 * reading.values[4]);
      more.values.push_back(1e4 * (reading.values[4] - reading.values[0]));
    }
    options.panels.push_back({name, "|B| [G]", {first, last}});
    difference.series.push_back(more);
  }
  options.panels.push_back(difference);
  return options;
}

TEST_F(SensorTypes, ReadingsAreRecordedToTheBitAndDrawn) {
  const Words record{"--duration", "2", "--json", "--record", folder.path("r")};
  Words with_readings = record;
  with_readings.push_back("--record-readings");
  ASSERT_EQ(run("run", world, with_readings).code, 0);
  const record::Recording recording = record::open_recording(folder.path("r"));
  EXPECT_TRUE(recording.damage.empty());
  const auto is_field = [](const record::ReadingSample& r) { return r.type == kMagnetometer; };
  const auto& all = recording.readings;
  EXPECT_EQ(all.size(), 4u * 20u) << "scans and fields";
  ASSERT_EQ(std::count_if(all.begin(), all.end(), is_field), 2 * 20);
  ASSERT_EQ(recording.info.movers[0].sensors.size(), 2u);
  EXPECT_EQ(recording.info.movers[0].sensors[1].topic, "/one/magnetometer");
  EXPECT_EQ(recording.info.movers[2].sensors.size(), 0u);
  const record::ReadingSample& first = *std::find_if(all.begin(), all.end(), is_field);
  ASSERT_EQ(first.values.size(), 8u);
  const Json now(run("sense", world, {"--type", "magnetometer", "--json"}).out);
  EXPECT_EQ(first.values[0], now.number("/sensors/0/field_T"));
  EXPECT_EQ(first.values[7], now.number("/sensors/1/vector_T/2"));

  const Outcome plot = run_successfully({"plot", folder.path("r"), "-o", folder.path("p")});
  viz::draw_series(fields_of(recording), folder.path("expected.png"));
  EXPECT_TRUE(read_file(folder.path("p/magnetometer.png")) == read_file(folder.path("expected.png")));
  EXPECT_FALSE(std::filesystem::exists(folder.path("p/lane_edge.png"))) << "no robot has one";

  ASSERT_EQ(run("run", world, record).code, 0);
  EXPECT_EQ(run_program({"plot", folder.path("r"), "-o", folder.path("q")}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.path("q/magnetometer.png"))) << "no recorded readings to draw";
}

TEST(WireFormat, MagnetometersSendTheDocumentedBytes) {
  const sensors::SensorType* type = sensors::find_sensor_type(kMagnetometer);
  const std::vector<double> values{1.3e-4, 0, -0.5e-4, 1.2e-4, 0.25e-4, 0, 0, -0.25e-4};
  sensors::SensorSpec row;
  row.elements = 2;
  row.limit = 1.0;
  base::Bytes payload, packet, plain;
  const std::uint8_t packet_type =
      type->encode(row, {.type = type->id, .values = values}, sensors::WireFormat::farm, 0, payload);
  netio::encode_reading({.robot = 7, .sequence = 30, .time = 3'000'000'000}, packet_type, payload, packet);
  EXPECT_EQ(packet, test::documented("magnetometer"));
  EXPECT_NE(type->encode(row, {.type = type->id, .values = values}, sensors::WireFormat::thesis, 0, plain), 0);
  EXPECT_EQ(plain, test::documented("thesis_magnetometer"));
}

TEST(WireFormat, LaneEdgesSendTheDocumentedBytes) {
  const sensors::SensorType* type = sensors::find_sensor_type(kLaneEdge);
  const std::vector<double> values{0.25, 61, 12e-6, 1.5e-3};
  base::Bytes payload, packet, plain;
  const std::uint8_t packet_type =
      type->encode({}, {.type = type->id, .values = values}, sensors::WireFormat::farm, 0, payload);
  netio::encode_reading({.robot = 7, .sequence = 30, .time = 3'000'000'000}, packet_type, payload, packet);
  EXPECT_EQ(packet, test::documented("lane_edge"));
  EXPECT_NE(type->encode({}, {.type = type->id, .values = values}, sensors::WireFormat::thesis, 0, plain), 0);
  EXPECT_EQ(plain, test::documented("thesis_lane_edge"));
  // No edge in range.
  const std::vector<double> none{NAN, 0, NAN, NAN};
  plain.clear();
  type->encode({}, {.type = type->id, .values = none}, sensors::WireFormat::thesis, 0, plain);
  EXPECT_EQ(plain, (base::Bytes{0xff, 0xff}));
}

/// The thesis' listing: its robot faces -y, its `laser` looks along its own +x, and the road is a thin model. The other
/// robot faces +x and looks to its left. Both are 0.25 m from the face of the paint.
TEST(LaneEdge, TheThesisListingGivesEqualReadings) {
  const Folder folder;
  const std::string thesis = folder.write("thesis.world", R"(
define roombalaneedge laser( range_max 0.5 fov 30.0 samples 61 size [0.06 0.03 0.01] name "laneedge" )
position( name "roomba0" size [0.33 0.33 0.1]
  roombalaneedge( pose [0 -0.225 -0.1 0] color "blue" laser_color "blue" ) )
model( name "paint" pose [0.26 0 0 0] size [0.02 4 0.01] color "white" )
)");
  const std::string own = folder.write("own.world", R"(
position( name "roomba0" size [0.33 0.33 0.1]
  laneedge( pose [0.225 0 -0.1 90] size [0.03 0.06 0.01] range_max 0.5 fov 30 samples 61 ) )
path( pose [-2 0 0 0] pieces 1 straight[0] [4 0.5] left "solid_white" paint_width 0.02 )
)");
  for (const std::string& world : {thesis, own}) {
    const Json reading(run("sense", world, {"--json"}).out);
    EXPECT_EQ(reading.text("/type"), "laneedge");
    EXPECT_NEAR(reading.number("/distance_m"), 0.25, 1e-9) << world;
    EXPECT_EQ(reading.number("/points"), 61) << world;
    EXPECT_LT(reading.number("/residual_m"), 1e-9) << world;
  }
}

/// The road as a picture, as in the thesis: 5 mm per pixel, read as drawn.
TEST(LaneEdge, ARoadMayBeAPicture) {
  const Folder folder;
  std::string picture = "P5\n200 200\n255\n";
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column) picture += row >= 48 && row < 52 ? '\0' : '\xff';
  folder.write("road.pgm", picture);
  const std::string world = folder.write("road.world", R"(old_shapes 1
position( name "a" laneedge( pose [0 0 -0.1 90] size [0.03 0.03 0.01] ) size [0.1 0.1 0.1] )
model( name "road" bitmap "road.pgm" size [1 1 0.01] )
)");
  const Json reading(run("sense", world, {"--json"}).out);
  EXPECT_NEAR(reading.number("/distance_m"), 0.24, 1e-9) << "row 52 of 200 begins 0.24 m above the middle";
  EXPECT_GE(reading.number("/points"), 59);
}

/// On the straight, a reading states a bound and satisfies it; in the bend, it states that none holds.
TEST(LaneEdge, ABoundHoldsOrIsFlagged) {
  const std::string lane = our_world("testpath/testpath.world");
  const auto sense = [&](const std::string& pose) {
    return Json(run("sense", lane, {"--type", "laneedge", "--json", "--pose", pose}).out);
  };
  const Json bend = sense("3.3,0.4,50");
  EXPECT_EQ(bend.text("/unsure"), "not straight");
  EXPECT_TRUE(bend.is_null("/bound"));
  const Json straight = sense("1,0,0");
  EXPECT_FALSE(straight.has("/unsure"));
  EXPECT_LT(straight.number("/bound"), 1.1e-8);
  EXPECT_EQ(sense("1,0,100").has("/unsure"), !sense("1,0,100").is_null("/distance_m")) << "looks along the lane";
  expect_in("laneedge exact, within 10.1 nm: one straight edge, visible", run("check", lane, {}).out);
}

TEST(LaneEdge, WorksWithEveryCommand) {
  const std::string lane = our_world("testpath/testpath.world");
  // Far from the lane there is no edge.
  EXPECT_TRUE(
      Json(run("sense", lane, {"--type", "laneedge", "--json", "--pose", "50,50,0"}).out).is_null("/distance_m"));
  const std::string csv = run("sense", lane, {"--type", "laneedge", "--pose", "50,50,0"}).out;
  EXPECT_EQ(csv.rfind("distance_m,points,residual_m,sigma_m\n,0,", 0), 0u) << csv;

  const Folder folder;
  ASSERT_EQ(run("run", lane, {"--duration", "2", "--record", folder.path("r"), "--record-readings"}).code, 0);
  EXPECT_EQ(run_program({"plot", folder.path("r")}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path("r/lane_edge.png")));
  EXPECT_TRUE(std::filesystem::exists(folder.path("r/magnetometer.png")));
}

}  // namespace sf
