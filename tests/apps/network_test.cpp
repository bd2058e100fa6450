// `run --send` to `listen`, and `serve` to robots that live elsewhere, over loopback.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <thread>

#include "netio/outbox.h"
#include "netio/packets.h"
#include "netio/socket.h"
#include "sensors/laser_packets.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {

namespace {

// Two robots in a room; what they read is worked out by `sense`.
const char* const kRoom = R"(
model( name "room" size [6 4 1] boundary 1 noblocks 0 color "gray" )
define bot position( size [0.3 0.3 0.1] laser( samples 91 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] ) )
bot( name "roomba1" pose [-2 0 0 0] )
bot( name "roomba2" pose [2 1 0 0] )
)";

/// A robot elsewhere: one socket that it speaks from, one that it hears its sensor on.
class Robot {
 public:
  Robot(std::uint16_t id, unsigned service, unsigned hears)
      : id_(id),
        service_{netio::kLoopback, static_cast<std::uint16_t>(service)},
        ears_(netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(hears)})),
        batch_(16) {}

  base::Bytes state(const base::Pose& X_WR) {
    netio::Header header;
    header.robot = id_;
    header.sequence = sequence_++;
    netio::V2v state;
    state.X_WR = X_WR;
    base::Bytes bytes;
    netio::encode(header, state, bytes);
    return bytes;
  }
  void say(const base::Pose& X_WR) { send(state(X_WR)); }
  void send(const base::Bytes& bytes) {
    mouth_.queue(service_, bytes);
    mouth_.flush();
  }

  void leave() {
    base::Bytes bytes;
    netio::encode({.robot = id_}, netio::Leave{}, bytes);
    send(bytes);
  }

  /// Ranges of the newest scan that waits; empty when none does.
  std::vector<double> hear() {
    std::vector<double> ranges;
    while (const std::size_t count = batch_.fill(ears_)) {
      for (std::size_t i = 0; i < count; ++i) {
        netio::Packet packet;
        EXPECT_EQ(netio::decode(batch_.bytes(i), packet), netio::Reason::accepted);
        EXPECT_EQ(packet.header.robot, id_);
        EXPECT_EQ(packet.header.sensor, 0u);
        sensors::LaserPart scan;
        EXPECT_EQ(sensors::read_laser(std::get<netio::Reading>(packet.body).payload, false, scan),
                  sensors::Fault::none);
        ranges.clear();
        for (std::uint32_t k = 0; k < scan.count; ++k) ranges.push_back(sensors::range_of(scan, k));
      }
    }
    return ranges;
  }

 private:
  std::uint16_t id_;
  netio::Endpoint service_;
  netio::Socket ears_;
  netio::Outbox mouth_;
  netio::ReceiveBatch batch_;
  std::uint32_t sequence_ = 0;
};

/// Polls for up to a minute.
bool until(const std::function<bool()>& done) {
  for (int i = 0; i < 3000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

struct Service {
  Folder folder;
  std::string world = folder.write("room.world", kRoom);
  unsigned lasers = free_ports(24);
  Program program;
  unsigned port = 0;

  static Words words(const std::string& world, unsigned lasers, const Words& more) {
    Words all{"serve", world, "--port", "0", "--rate", "50", "--json", "--laser-port", std::to_string(lasers)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  explicit Service(const Words& more = {}) : program(words(world, lasers, more)) {
    if (!program.says("; Ctrl-C ends it")) return;
    const std::string said = program.err();
    port = static_cast<unsigned>(std::atoi(said.c_str() + said.find("127.0.0.1:") + 10));
  }
  unsigned hears(unsigned robot) const { return lasers + 8 * robot; }
};

std::vector<double> sensed(const std::string& world, const std::string& robot, const std::string& pose) {
  const Json scan(run_program({"sense", world, "--robot", robot, "--pose", pose, "--json"}).out);
  std::vector<double> ranges;
  for (std::size_t i = 0; i < scan.size("/beams"); ++i)
    ranges.push_back(scan.number("/beams/" + std::to_string(i) + "/range_m"));
  return ranges;
}

void run_to_listener(const std::string& wire) {
  const std::string base = std::to_string(free_ports(40));
  const Words both{our_world("cave.world"), "--robots", "4", "--json", "--wire", wire, "--laser-port", base};
  Words listen{"listen"}, run{"run"};
  listen.insert(listen.end(), both.begin(), both.end());
  run.insert(run.end(), both.begin(), both.end());
  listen.insert(listen.end(), {"--silence", "100"});
  run.insert(run.end(), {"--duration", "3", "--send", "127.0.0.1"});
  Program listener(listen);
  ASSERT_TRUE(listener.says("listening on 4 ports")) << listener.err();
  const Outcome sent = run_program(run);
  ASSERT_EQ(sent.code, 0) << sent.err;
  listener.signal(SIGINT);
  const Outcome received = listener.wait();
  EXPECT_EQ(received.code, 0) << received.err;
  const Json out(sent.out), in(received.out);
  EXPECT_EQ(out.number("/packets/sent"), 4 * 30);
  EXPECT_EQ(out.number("/packets/failed"), 0);
  EXPECT_EQ(in.number("/packets"), 4 * 30);
  EXPECT_EQ(in.number("/good"), 4 * 30);
  EXPECT_EQ(in.number("/rays"), out.number("/rays"));
  EXPECT_EQ(in.number("/lost"), 0);
}

}  // namespace

TEST(SendAndListen, EveryPacketArrivesAndIsGood) { run_to_listener("farm"); }
TEST(SendAndListen, EveryPacketArrivesInTheThesisLayout) { run_to_listener("thesis"); }

/// A sensor that is due twice a tick sends every other reading: none of these was lost.
TEST(SendAndListen, ReadingsBetweenTicksAreNoLoss) {
  const Folder folder;
  const std::string world =
      folder.write("w.world",
                   "interval_sim 100\nmodel( size [6 4 1] boundary 1 noblocks 0 )\n"
                   "position( name \"roomba1\" laser( samples 9 rate 20 ) laser( samples 9 rate 7 ) )\n");
  const std::string base = std::to_string(free_ports(16));
  Program listener({"listen", world, "--json", "--laser-port", base, "--silence", "100"});
  ASSERT_TRUE(listener.says("listening on 2 ports")) << listener.err();
  const Outcome sent =
      run_program({"run", world, "--duration", "3", "--send", "127.0.0.1", "--json", "--laser-port", base});
  ASSERT_EQ(sent.code, 0) << sent.err;
  listener.signal(SIGINT);
  const Json in(listener.wait().out);
  EXPECT_GE(in.number("/good"), 30 + 15);
  EXPECT_EQ(in.number("/good"), Json(sent.out).number("/packets/sent"));
  EXPECT_EQ(in.number("/lost"), 0);
}

TEST(SendAndListen, AListenerEndsThoughNothingComes) {
  const Folder folder;
  const std::string world = folder.write("w.world", "position( name \"roomba1\" laser( ) )\n");
  const Outcome outcome =
      run_program({"listen", world, "--duration", "0.2", "--laser-port", std::to_string(free_ports(16))});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("listening on 1 port of"), std::string::npos) << outcome.err;
}

TEST(SendAndListen, OneRobotsKindsOnOneBaseAreToldApart) {
  const Outcome outcome =
      run_program({"run", our_world("mapping/mapping.world"), "--send", "127.0.0.1", "--laser-port", "52000"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("change --laser-port or --occupancy-port"), std::string::npos) << outcome.err;
}

TEST(SendAndListen, PortsThatCollideAreRefusedAtLoad) {
  const Folder folder;
  const std::string world = folder.write("w.world",
                                         "position( name \"roomba1\" laser( ) laser( ) )\n"
                                         "position( name \"roomba2\" pose [2 0 0 0] laser( ) )\n");
  for (const Words& words : std::vector<Words>{{"run", world, "--send", "127.0.0.1", "--ports-per-robot", "1"},
                                               {"serve", world, "--port", "0", "--ports-per-robot", "1"},
                                               {"listen", world, "--ports-per-robot", "1"}}) {
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(count_lines(outcome.err), 1u);
    EXPECT_NE(outcome.err.find("roomba1"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("roomba2"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("--ports-per-robot"), std::string::npos) << "says what to do: " << outcome.err;
  }
}

TEST(SendAndListen, PortsPastTheLastAreRefusedAtLoad) {
  const Outcome outcome = run_program({"serve", our_world("rooms.world"), "--port", "0", "--laser-port", "65530"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("65535"), std::string::npos) << outcome.err;
}

TEST(SendAndListen, WhatTheThesisCannotCarryIsRefusedAtLoad) {
  const Folder folder;
  for (const std::string laser : {"laser( samples 362 )", "laser( range_max 65.6 )"}) {
    const std::string world = folder.write("w.world", "position( name \"roomba1\" " + laser + " )\n");
    const Outcome outcome = run_program({"run", world, "--send", "127.0.0.1", "--wire", "thesis", "--duration", "0.1"});
    EXPECT_EQ(outcome.code, 2) << laser;
    EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
  }
}

TEST(SendAndListen, APortThatIsTakenIsNamed) {
  const unsigned base = free_ports(16);
  const netio::Socket taken = netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(base + 9)});
  const Folder folder;
  const std::string world = folder.write("w.world", "position( name \"roomba1\" laser( ) laser( ) )\n");
  const Outcome outcome = run_program({"listen", world, "--laser-port", std::to_string(base)});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find(std::to_string(base + 9)), std::string::npos) << outcome.err;
}

TEST(Serve, RobotsReadWhatSenseReadsWhereTheySayTheyAre) {
  Service service;
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot one(1, service.port, service.hears(1)), two(2, service.port, service.hears(2));
  const std::vector<double> expected = sensed(service.world, "roomba1", "-1,0.5,30");
  // It is heard from its first packet on; the scan may still be of the place at load.
  std::vector<double> ranges;
  const bool agreed = until([&] {
    one.say({-1.0, 0.5, 0.0, M_PI / 6});
    ranges = one.hear();
    bool same = ranges.size() == expected.size();
    for (std::size_t i = 0; same && i < ranges.size(); ++i) same = std::fabs(ranges[i] - expected[i]) <= 0.000501;
    return same;
  });
  EXPECT_TRUE(agreed) << testing::PrintToString(ranges);
  // The other never spoke: nothing is sent to it.
  EXPECT_TRUE(two.hear().empty());
  service.program.signal(SIGTERM);
  const Outcome outcome = service.program.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_EQ(facts.number("/robots"), 2);
  EXPECT_GE(facts.number("/packets/sent"), 1);
  EXPECT_GE(facts.number("/received/accepted"), 1);
  EXPECT_EQ(facts.number("/rays"), 91 * (facts.number("/readings") - facts.number("/given_again")))
      << "one laser was computed, not two";
}

TEST(Serve, RobotsSeeEachOther) {
  Service service;
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot one(1, service.port, service.hears(1)), two(2, service.port, service.hears(2));
  // One at the origin looks along x, where the other stands with its near side 1 m from the laser.
  std::vector<double> ranges;
  const bool seen = until([&] {
    one.say({0.0, 0.0, 0.0, 0.0});
    two.say({1.25, 0.0, 0.0, 0.0});
    ranges = one.hear();
    return ranges.size() == 91 && std::fabs(ranges[45] - 1.0) <= 0.000501;
  });
  EXPECT_TRUE(seen) << testing::PrintToString(ranges);
}

/// The other spoke once; the wall behind it is seen once it is forgotten.
TEST(Serve, ARobotThatFallsSilentIsGone) {
  Service service({"--forget", "2"});
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot one(1, service.port, service.hears(1)), two(2, service.port, service.hears(2));
  const double wall = sensed(service.world, "roomba1", "0,-0.5,0").at(45);
  std::vector<double> ranges;
  const auto reads = [&](double expected) {
    one.say({0.0, -0.5, 0.0, 0.0});
    ranges = one.hear();
    return ranges.size() == 91 && std::fabs(ranges[45] - expected) <= 0.000501;
  };
  ASSERT_TRUE(until([&] {
    two.say({1.25, -0.5, 0.0, 0.0});
    return reads(1.0);
  })) << testing::PrintToString(ranges);
  EXPECT_TRUE(until([&] { return reads(wall); })) << testing::PrintToString(ranges);
  EXPECT_GT(wall, 2.0);
}

TEST(Serve, StrangersAreCountedAndDropped) {
  Service service;
  ASSERT_NE(service.port, 0u) << service.program.err();
  const unsigned spare = service.lasers + 1;
  Robot one(1, service.port, service.hears(1)), impostor(1, service.port, spare), nobody(99, service.port, spare + 1);
  ASSERT_TRUE(until([&] {
    one.say({-1.0, 0.5, 0.0, 0.0});
    return !one.hear().empty();
  }));
  // On a busy machine one may have been silent for two seconds by now: it speaks again before every try.
  ASSERT_TRUE(until([&] {
    one.say({-1.0, 0.5, 0.0, 0.0});
    impostor.say({2.0, 0.0, 0.0, 0.0});
    return service.program.err().find("is dropped until") != std::string::npos;
  }));
  nobody.say({0.0, 0.0, 0.0, 0.0});
  nobody.send({1, 2, 3});
  base::Bytes no_number = one.state({});
  const double nan = std::nan("");
  std::memcpy(no_number.data() + netio::kHeaderBytes, &nan, sizeof nan);
  one.send(no_number);
  service.program.signal(SIGINT);  // what waits then is still counted
  const Outcome outcome = service.program.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_GE(facts.number("/received/wrong source"), 1);
  EXPECT_EQ(facts.number("/received/unknown robot"), 1);
  EXPECT_EQ(facts.number("/received/too short"), 1);
  EXPECT_EQ(facts.number("/received/not finite"), 1);
}

/// Its standard error is a pipe that nobody reads, and full: what it would say of a stranger holds up no reading.
TEST(Serve, AnUnreadStandardErrorHoldsUpNothing) {
  const Folder folder;
  const std::string world = folder.write("room.world", kRoom), fifo = folder.path("err");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int pipe = open(fifo.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(pipe, 0);
  const unsigned lasers = free_ports(24);
  Program program({"serve", world, "--port", "0", "--rate", "50", "--json", "--laser-port", std::to_string(lasers)}, {},
                  "", fifo);
  std::string said;
  ASSERT_TRUE(until([&] {
    char bytes[512];
    const ssize_t n = read(pipe, bytes, sizeof bytes);
    if (n > 0) said.append(bytes, static_cast<std::size_t>(n));
    return said.find("; Ctrl-C ends it") != std::string::npos;
  }));
  const auto port = static_cast<unsigned>(std::atoi(said.c_str() + said.find("127.0.0.1:") + 10));
  for (char junk[4096] = {}; write(pipe, junk, sizeof junk) > 0;) {
  }
  Robot one(1, port, lasers + 8), impostor(1, port, lasers + 1);
  for (int heard = 0; heard < 5;) {
    ASSERT_TRUE(until([&] {
      one.say({-1.0, 0.5, 0.0, 0.0});
      impostor.say({2.0, 0.0, 0.0, 0.0});
      return !one.hear().empty();
    }));
    ++heard;
  }
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.code, 0);
  const Json facts(outcome.out);
  EXPECT_GE(facts.number("/received/wrong source"), 1);
  EXPECT_GE(facts.number("/log_lines_left_out"), 1);
  close(pipe);
}

TEST(Serve, StrangersAreNamedOncePerBindingAndALeaveEndsIt) {
  Service service;
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot one(1, service.port, service.hears(1)), again(1, service.port, service.lasers + 1);
  ASSERT_TRUE(until([&] {
    one.say({-1.0, 0.5, 0.0, 0.0});
    return !one.hear().empty();
  }));
  const auto spoke = std::chrono::steady_clock::now();
  one.say({-1.0, 0.5, 0.0, 0.0});
  for (int i = 0; i < 5; ++i) again.say({2.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(service.program.says("says as the same is dropped"));
  if (std::chrono::steady_clock::now() - spoke > std::chrono::seconds(1))
    GTEST_SKIP() << "the machine is too busy: the two seconds after which an id is free may have passed";
  one.leave();
  // It speaks for the id from here on, though not two seconds have passed.
  for (int i = 0; i < 5; ++i) again.say({2.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(until([&] { return !one.hear().empty(); }));
  service.program.signal(SIGINT);
  const Outcome outcome = service.program.wait();
  EXPECT_EQ(count_lines(outcome.err), 2u) << outcome.err;  // where it serves, and the stranger
  EXPECT_NE(outcome.err.find("roomba1 (id 1) is heard from 127.0.0.1:"), std::string::npos) << outcome.err;
  EXPECT_EQ(Json(outcome.out).number("/received/wrong source"), 5);
}

TEST(Serve, APortThatIsTakenIsNamed) {
  const unsigned port = free_ports(1);
  const netio::Socket taken = netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(port)});
  const Outcome outcome = run_program({"serve", our_world("rooms.world"), "--port", std::to_string(port)});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find(std::to_string(port)), std::string::npos) << outcome.err;
}

}  // namespace sf
