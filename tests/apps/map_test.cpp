// Maps from a run to a terminal and a picture, over loopback; and from a recording.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "maps/map_packets.h"
#include "netio/outbox.h"
#include "netio/packets.h"
#include "sensors/occupancy.h"
#include "tests/apps/program.h"
#include "tests/bridges/raw_client.h"
#include "tests/netio/documented.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"

namespace sf {
namespace {

const char* const kMapWorld = R"(
define bot position
(
  size [0.3 0.3 0.1]
  laser( samples 61 fov 180 range_max 1 rate 10 )
  occupancy( cell 0.1 words [5 4] )
)
define box model( size [0.2 0.2 0.5] )
bot( name "roomba0" pose [0 0 0 0] )
bot( name "roomba1" pose [3 0 0 90] )
box( pose [0.7 0 0 0] )
box( pose [3 0.7 0 0] )
)";

Words listen(unsigned port, const Words& more) {
  return with({"map", "--listen", std::to_string(port), "--silence", "0.5"}, more);
}

Words run(const std::string& world, unsigned port, const std::string& wire) {
  return {"run",
          world,
          "--duration",
          "3",
          "--send",
          "127.0.0.1",
          "--wire",
          wire,
          "--occupancy-port",
          std::to_string(port),
          "--laser-port",
          std::to_string(port + 100)};
}

void expect_map(const std::string& text, std::size_t columns, std::size_t rows) {
  ASSERT_EQ(text.size(), rows * (columns + 1)) << text;
  EXPECT_GT(std::count(text.begin(), text.end(), '1'), 0) << text;
  EXPECT_GT(std::count(text.begin(), text.end(), ' '), 20) << text;
  EXPECT_GT(std::count(text.begin(), text.end(), '0'), 20) << text;
}

TEST(Map, ReceivesBothWireFormatsFromARun) {
  const Folder folder;
  const std::string world = folder.write("a.world", kMapWorld);
  for (const std::string wire : {"farm", "thesis"}) {
    const unsigned port = free_ports(120);
    Program map(listen(port, {"--wire", wire, "-o", folder.path(wire + ".png")}));
    ASSERT_TRUE(map.prints("listening for maps on 1 port"));
    EXPECT_EQ(run_program(run(world, port, wire)).code, 0);
    const Outcome outcome = map.wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    expect_map(outcome.out, 20, 16);
    EXPECT_NE(outcome.err.find("3 complete maps, 0 incomplete"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("true poses") != std::string::npos, wire == "farm") << outcome.err;
    scenes::expect_painted(folder.path(wire + ".png"), {{0xFF000000u, 16}, {0xFFCDCDCDu, 300}, {0xFFFEFEFEu, 300}});
  }
}

TEST(Map, MergesSeveralAndIgnoresInvalidPackets) {
  const Folder folder;
  const std::string world = folder.write("a.world", kMapWorld);
  const unsigned port = free_ports(120);
  Program map({"map", "--listen", std::to_string(port), "--listen", std::to_string(port + 8), "--silence", "3",
               "--merge", "-o", folder.path("both.png")});
  ASSERT_TRUE(map.prints("listening for maps on 2 ports"));
  netio::Outbox outbox;
  for (std::size_t n = 0; n < 64; ++n)
    outbox.queue({netio::kLoopback, static_cast<std::uint16_t>(port)}, base::Bytes(31 * n, std::uint8_t(n)));
  outbox.flush();
  EXPECT_EQ(run_program(run(world, port, "farm")).code, 0);
  const Outcome outcome = map.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  // The second map is 3 m east of the first: 30 cells, rounded up to whole words of four.
  expect_map(outcome.out, 52, 16);
  EXPECT_NE(outcome.err.find("64 ignored"), std::string::npos) << outcome.err;
}

TEST(Map, PacketsAreAsDocumented) {
  sensors::SensorSpec row;
  row.elements = row.across = 2;
  row.pitch = 0.5;
  const double words[] = {1.0, 0x8A000000};
  base::ReadingBlock reading;
  reading.X_WS = {1.0, -2.0, 0.0, 0.0};
  reading.values = words;
  reading.flags = maps::kTruePoses;
  const sensors::SensorType& type = sensors::occupancy_type;
  base::Bytes payload, packet, first, second;
  type.encode(row, reading, sensors::WireFormat::farm, 0, payload);
  netio::encode_reading({.robot = 7, .sequence = 30, .time = 3'000'000'000}, type.id, payload, packet);
  EXPECT_EQ(packet, test::documented("occupancy"));
  type.encode(row, reading, sensors::WireFormat::thesis, 0, first);
  type.encode(row, reading, sensors::WireFormat::thesis, 1, second);
  EXPECT_EQ(first, test::documented("thesis_occupancy"));
  EXPECT_EQ(second, test::documented("thesis_occupancy_rest"));
}

/// Sends a map of one word whose cells are all in `state`.
void send_map(netio::Outbox& farm, unsigned port, std::uint32_t sequence, std::uint32_t state) {
  base::Bytes payload, packet;
  maps::put_part(
      {.left = 0, .top = 0, .cell = 1, .word_columns = 1, .word_rows = 1}, 0, 0,
      [&](std::uint32_t) { return state * 0x55555555u; }, payload);
  netio::encode_reading({.robot = 7, .sequence = sequence}, sensors::kOccupancy, payload, packet);
  farm.queue({netio::kLoopback, static_cast<std::uint16_t>(port)}, packet);
  farm.flush();
}

/// The picture shows the newest map while the program runs; no reader sees half of it.
TEST(Map, PicturesAreReplacedWhileMapsArrive) {
  const Folder folder;
  const unsigned port = free_ports(1);
  const std::string picture = folder.path("map.png");
  Program map({"map", "--listen", std::to_string(port), "--interval", "0.01", "-o", picture, "--view", "0"});
  ASSERT_TRUE(map.prints("listening for maps on 1 port"));
  const std::string before = "view on http://127.0.0.1:", said = map.err();
  bridges::RawClient client(static_cast<std::uint16_t>(std::stoi(said.substr(said.find(before) + before.size()))));
  client.upgrade("foxglove.websocket.v1");
  client.text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})");
  netio::Outbox farm;
  std::uint32_t sequence = 0;
  // Free, then occupied. The legend has as much of both colours.
  for (const std::uint32_t state : {2u, 1u}) {
    send_map(farm, port, sequence++, state);
    EXPECT_TRUE(until([&] {
      if (!std::filesystem::exists(picture)) return false;
      const scenes::Picture drawn = scenes::read_png(picture);
      const int free = drawn.count(0xFFFEFEFEu), occupied = drawn.count(0xFF000000u);
      return std::abs(free - occupied) > 300 && (free > occupied) == (state == 2u);
    })) << state;
  }
  std::string image;
  while (image.find("\x89PNG") == std::string::npos && !(image = client.receive_binary(1)).empty()) {
  }
  EXPECT_NE(image.find("port-" + std::to_string(port)), std::string::npos);
  EXPECT_EQ(map.stop().code, 0);
  EXPECT_FALSE(std::filesystem::exists(picture + ".part"));
}

/// Boundary: 0 writes one picture, at the end.
TEST(Map, WithoutAnIntervalThePictureIsWrittenAtTheEnd) {
  const Folder folder;
  const unsigned port = free_ports(1);
  const std::string picture = folder.path("map.png");
  Program map(listen(port, {"--interval", "0", "-o", picture}));
  ASSERT_TRUE(map.prints("listening for maps on 1 port"));
  netio::Outbox farm;
  send_map(farm, port, 0, 2);
  EXPECT_EQ(map.wait().code, 0);
  EXPECT_TRUE(std::filesystem::exists(picture));
}

/// A sequence number far ahead of the farm's neither shows its map nor makes the genuine ones after it late; it is
/// accepted if the next one continues it.
TEST(Map, SequencesThatJumpAreDropped) {
  for (const bool followed : {false, true}) {
    const unsigned port = free_ports(1);
    Program map(listen(port, {}));
    ASSERT_TRUE(map.prints("listening for maps on 1 port"));
    netio::Outbox farm;
    for (const std::uint32_t sequence : {0u, 1u}) send_map(farm, port, sequence, 2);
    send_map(farm, port, 1'000'000, 1);
    if (followed) send_map(farm, port, 1'000'001, 1);
    send_map(farm, port, 2, 2);
    const Outcome outcome = map.wait();
    EXPECT_EQ(outcome.out.find('1') != std::string::npos, followed) << outcome.out;
    expect_in(followed ? "3 datagrams used and 2 ignored" : "3 datagrams used and 1 ignored", outcome.err);
    EXPECT_EQ(outcome.err.find("dropped by the operating system"), std::string::npos) << outcome.err;
  }
}

/// More than the port's buffer holds while no one reads it.
TEST(Map, DatagramsDroppedByTheKernelAreReported) {
  const unsigned port = free_ports(1);
  Program map(listen(port, {}));
  ASSERT_TRUE(map.prints("listening for maps on 1 port"));
  map.signal(SIGSTOP);
  netio::Outbox farm;
  for (int i = 0; i < 30'000; ++i) farm.queue({netio::kLoopback, static_cast<std::uint16_t>(port)}, base::Bytes(1'000));
  farm.flush();
  map.signal(SIGCONT);
  const Outcome outcome = map.wait();
  EXPECT_NE(outcome.err.find("datagrams dropped by the operating system"), std::string::npos) << outcome.err;
}

TEST(Map, DuplicatePortsAreRejected) {
  const unsigned port = free_ports(4);
  const std::string range = std::to_string(port) + "-" + std::to_string(port + 3);
  const std::string last = std::to_string(port + 3);
  expect_refused({"map"});
  expect_refused({"map", "--listen", last, "--listen", range}, "--listen: port " + last + " is given twice");
}

/// Ports in the given order, each with the packets it received.
TEST(Map, PortsMayBeGivenInAnyOrder) {
  const unsigned port = free_ports(2);
  Program map({"map", "--listen", std::to_string(port + 1), "--listen", std::to_string(port), "--silence", "0.3"});
  ASSERT_TRUE(map.prints("listening for maps on 2 ports"));
  netio::Outbox outbox;
  for (const unsigned to : {port, port, port + 1})
    outbox.queue({netio::kLoopback, static_cast<std::uint16_t>(to)}, base::Bytes(3));
  outbox.flush();
  const std::string err = map.wait().err;
  for (const auto& [to, count] : {std::pair{port, "2"}, {port + 1, "1"}})
    expect_in(
        "port " + std::to_string(to) + ": 0 complete maps, 0 incomplete, 0 datagrams used and " + count + " ignored",
        err);
}

TEST(Map, SupportsMorePortsThanTheFileLimit) {
  const unsigned port = free_ports(200);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit few = before;
  few.rlim_cur = 100;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  const std::string range = std::to_string(port) + "-" + std::to_string(port + 199);
  const Outcome outcome = run_program({"map", "--listen", range, "--duration", "0.1"});
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(outcome.code, 1) << outcome.err;  // nothing was received
  EXPECT_NE(outcome.err.find("on 200 ports"), std::string::npos) << outcome.err;
}

TEST(Map, IsDrawnFromARecording) {
  const Folder folder;
  const std::string world = folder.write("a.world", kMapWorld);
  ASSERT_EQ(run_program({"run", world, "--duration", "3", "--record", folder.path("r"), "--record-readings"}).code, 0);
  const Outcome outcome = run_successfully({"plot", folder.path("r")});
  EXPECT_NE(outcome.err.find("map.png"), std::string::npos) << outcome.err;
  scenes::expect_painted(folder.path("r/map.png"), {{0xFF000000u, 16}, {0xFFCDCDCDu, 300}, {0xFFFEFEFEu, 300}});
  ASSERT_EQ(run_program({"run", world, "--duration", "1", "--record", folder.path("q")}).code, 0);
  EXPECT_EQ(run_program({"plot", folder.path("q")}).err.find("map.png"), std::string::npos) << "no readings, no map";
}

}  // namespace
}  // namespace sf
