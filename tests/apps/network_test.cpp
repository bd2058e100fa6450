// `run --send` to `listen`, and `serve` to robots in other processes, over loopback.

#include <gtest/gtest.h>

#include <csignal>
#include <cstring>

#include "netio/outbox.h"
#include "netio/packets.h"
#include "record/recording.h"
#include "tests/apps/remote_robot.h"

namespace sf {

namespace {

struct Exchange {
  Outcome sent, received;
};

/// Runs `run` of a world for some seconds, and `listen` at the same time. @param ports as `listen` counts them
/// @param both additional arguments for both
Exchange exchange(const std::string& world, const std::string& ports, const std::string& seconds, const Words& both) {
  const Words words = with({world, "--json", "--laser-port", std::to_string(free_ports(60))}, both);
  Words listen{"listen", "--silence", "100"}, run{"run", "--send", "127.0.0.1", "--duration", seconds};
  for (Words* command : {&listen, &run}) command->insert(command->end(), words.begin(), words.end());
  Program listener(listen);
  EXPECT_TRUE(listener.prints("listening on " + ports)) << listener.err();
  const Outcome sent = run_successfully(run);
  return {sent, listener.stop()};
}

void run_to_listener(const std::string& wire) {
  const auto [sent, received] = exchange(our_world("cave.world"), "4 ports", "3", {"--robots", "4", "--wire", wire});
  EXPECT_EQ(received.code, 0) << received.err;
  const Json out(sent.out), in(received.out);
  EXPECT_EQ(out.number("/packets/sent"), 4 * 30);
  EXPECT_EQ(out.number("/packets/failed"), 0);
  EXPECT_EQ(in.number("/packets"), 4 * 30);
  EXPECT_EQ(in.number("/good"), 4 * 30);
  EXPECT_EQ(out.number("/readings"), 4 * 30);
  EXPECT_EQ(in.number("/rays"), out.number("/rays"));
  EXPECT_EQ(in.number("/lost"), 0);
}

}  // namespace

TEST(SendAndListen, EveryPacketArrivesAndIsGood) { run_to_listener("farm"); }
TEST(SendAndListen, EveryPacketArrivesInTheThesisLayout) { run_to_listener("thesis"); }

/// A sensor that is due more than once per tick, or between ticks, sends every reading.
TEST(SendAndListen, ReadingsBetweenTicksAreSent) {
  const Folder folder;
  const std::string world =
      folder.write("w.world",
                   "interval_sim 100\nmodel( size [6 4 1] boundary 1 noblocks 0 )\n"
                   "position( name \"roomba1\" laser( samples 9 rate 20 ) laser( samples 9 rate 7 ) )\n");
  const auto [sent, received] = exchange(world, "2 ports", "3", {});
  const Json in(received.out);
  EXPECT_EQ(Json(sent.out).number("/packets/sent"), 59 + 21) << "20 Hz and 7 Hz, from 0 to 2.9 s";
  EXPECT_EQ(in.number("/good"), 59 + 21);
  EXPECT_EQ(in.number("/lost"), 0);
}

/// Each is counted separately: 2 is duplicated, 3 is late, 4 to 6 are lost; then another farm sends.
TEST(SendAndListen, LostAndReorderedPacketsAreReported) {
  const Folder folder;
  const std::string world = folder.write("w.world", "position( name \"roomba1\" laser( samples 2 range_max 8 ) )\n");
  const unsigned base = free_ports(16);
  Program listener({"listen", world, "--json", "--laser-port", std::to_string(base), "--silence", "100"});
  ASSERT_TRUE(listener.prints("listening on 1 port")) << listener.err();
  netio::Outbox farm, other;
  const std::uint8_t scan[] = {2, 0, 0xe8, 3, 0xe8, 3};
  base::Bytes packet;
  const auto send = [&](netio::Outbox& from, std::uint32_t session, std::uint32_t sequence) {
    netio::encode_reading({.robot = 1, .sequence = sequence, .session = session}, 1, scan, packet);
    from.queue({netio::kLoopback, static_cast<std::uint16_t>(base + 8)}, packet);
    from.flush();
  };
  for (const std::uint32_t sequence : {0u, 1u, 2u, 2u, 7u, 3u}) send(farm, 5, sequence);
  send(other, 6, 100);
  send(farm, 6, 100);
  send(farm, 5, 1'000'000);  // rejected on its own
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const Outcome outcome = listener.stop();
  const Json in(outcome.out);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(in.number("/packets"), 9);
  EXPECT_EQ(in.number("/good"), 6);
  EXPECT_EQ(in.number("/lost"), 3);
  EXPECT_EQ(in.number("/duplicates"), 1);
  EXPECT_EQ(in.number("/reordered"), 1);
  EXPECT_EQ(in.number("/socket_drops"), 0);
  EXPECT_EQ(in.number("/by_reason/wrong source"), 2);
  EXPECT_EQ(in.number("/by_reason/out of range"), 1);
}

/// In real time, readings are sent when they are due, not all at the end of the tick: 5 at 50 Hz in a tick of 0.1 s. A
/// busy machine may deliver several at once, so there are several trials.
TEST(SendAndListen, InRealTimeReadingsArriveWhenTheyAreDue) {
  const Folder folder;
  const std::string world = folder.write("w.world", "position( name \"roomba1\" laser( samples 9 rate 50 ) )\n");
  std::size_t received = 0, times = 0;
  for (int trial = 0; trial < 8 && times < 30; ++trial) {
    const unsigned base = free_ports(16);
    const netio::Socket receiver = netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(base + 8)});
    Program run(
        {"run", world, "--duration", "2", "--real-time", "--send", "127.0.0.1", "--laser-port", std::to_string(base)});
    netio::ReceiveBatch batch(16);
    received = times = 0;
    until([&] {
      for (int i = 0; i < 20; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
        const std::size_t count = batch.fill(receiver);
        received += count;
        times += count > 0;
      }
      return received >= 96 || !run.running();
    });
    EXPECT_EQ(run.wait().code, 0);
    EXPECT_GE(received, 90u);
  }
  EXPECT_GE(times, 30u) << "20 if all were sent at the end of each tick";
}

TEST(SendAndListen, AListenerEndsWithoutPackets) {
  const Folder folder;
  const std::string world = folder.write("w.world", "position( name \"roomba1\" laser( ) )\n");
  const Outcome outcome =
      run_program({"listen", world, "--duration", "0.2", "--laser-port", std::to_string(free_ports(16))});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("listening on 1 port of"), std::string::npos) << outcome.err;
}

TEST(SendAndListen, ARobotsKindsOnOneBaseAreDistinguished) {
  expect_refused({"run", our_world("mapping/mapping.world"), "--send", "127.0.0.1", "--laser-port", "52000"},
                 "change --laser-port or --occupancy-port");
}

TEST(SendAndListen, CollidingPortsAreRejectedAtLoad) {
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
    EXPECT_NE(outcome.err.find("--ports-per-robot"), std::string::npos) << "names the remedy: " << outcome.err;
  }
}

TEST(SendAndListen, PortsBeyondTheLastAreRejectedAtLoad) {
  expect_refused({"serve", our_world("rooms.world"), "--port", "0", "--laser-port", "65535"}, "65535");
}

TEST(SendAndListen, ScansTooLargeForTheThesisFormatAreRejectedAtLoad) {
  const Folder folder;
  for (const std::string laser : {"laser( samples 362 )", "laser( range_max 65.6 )"}) {
    const std::string world = folder.write("w.world", "position( name \"roomba1\" " + laser + " )\n");
    expect_refused({"run", world, "--send", "127.0.0.1", "--wire", "thesis", "--duration", "0.1"});
  }
}

TEST(SendAndListen, ATakenPortIsReported) {
  const unsigned base = free_ports(16);
  const netio::Socket taken = netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(base + 9)});
  const Folder folder;
  const std::string world = folder.write("w.world", "position( name \"roomba1\" laser( ) laser( ) )\n");
  expect_refused({"listen", world, "--laser-port", std::to_string(base)}, std::to_string(base + 9));
}

TEST(Serve, ReadingsAtReportedPosesMatchSense) {
  Service service(kRoom, {"--rate", "50", "--stale", "freeze"});  // the other robot is at its place, as in `sense`
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot one(1, service.port, service.laser_port(1)), two(2, service.port, service.laser_port(2));
  const std::vector<double> expected = sensed(service.world, "roomba1", "-1,0.5,30");
  // Its states are accepted from the first packet on, but the scan may still be from its pose at load.
  std::vector<double> ranges;
  const bool agreed = until([&] {
    one.send_state({-1.0, 0.5, 0.0, M_PI / 6});
    ranges = one.receive();
    bool same = ranges.size() == expected.size();
    for (std::size_t i = 0; same && i < ranges.size(); ++i) same = std::fabs(ranges[i] - expected[i]) <= 0.000501;
    return same;
  });
  EXPECT_TRUE(agreed) << testing::PrintToString(ranges);
  // The other robot has sent nothing, so nothing is sent to it.
  EXPECT_TRUE(two.receive().empty());
  const Outcome outcome = service.program.stop(SIGTERM);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_EQ(facts.number("/robots"), 2);
  EXPECT_GE(facts.number("/packets/sent"), 1);
  EXPECT_GE(facts.number("/received/accepted"), 1);
  EXPECT_EQ(facts.number("/rays"), 91 * (facts.number("/readings") - facts.number("/given_again")))
      << "one laser was computed, not two";
}

/// Faster than the ticks: many scans are closer in time than two ticks. Their number depends on the machine.
TEST(Serve, SensorsAreReadBetweenTicks) {
  Service service(fast_room(), {});
  ASSERT_NE(service.port, 0u) << service.program.err();
  EXPECT_EQ(service.program.err().find("--rate"), std::string::npos) << service.program.err();
  Robot one(1, service.port, service.laser_port(1));
  std::size_t near = 0;
  EXPECT_TRUE(until([&] {
    one.send_state({-1.0, 0.5, 0.0, 0.0});
    one.receive();
    near = 0;
    for (std::size_t i = 1; i < one.stamps().size(); ++i) near += one.stamps()[i] - one.stamps()[i - 1] < 60'000'000;
    return near >= 20;
  })) << near;
}

/// With --rate, sensors are read only at ticks, and the command names the faster ones.
TEST(Serve, ARateTooLowForASensorIsReported) {
  Service service(fast_room(), {"--rate", "10"});
  ASSERT_NE(service.port, 0u) << service.program.err();
  const std::string message = service.program.err();
  EXPECT_NE(message.find("--rate 10 is too low for 2 sensors (laser 50 Hz)"), std::string::npos) << message;
  EXPECT_NE(message.find("at least --rate 50"), std::string::npos) << message;
  Robot one(1, service.port, service.laser_port(1));
  ASSERT_TRUE(until([&] {
    one.send_state({-1.0, 0.5, 0.0, 0.0});
    one.receive();
    return one.stamps().size() >= 5;
  }));
  EXPECT_GE(Json(service.program.stop().out).number("/missed"), 4 * 4);
}

/// 200 states within at most two ticks.
TEST(Serve, FilteredStatesBeyondTheLimitPerTickAreCounted) {
  Service service(kRoom, {"--rate", "0.1", "--filter"});
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot one(1, service.port, service.laser_port(1));
  ASSERT_TRUE(prove(one));
  for (int i = 0; i < 200; ++i) one.send_state({-1.0, 0.5, 0.0, 0.0});
  EXPECT_GE(Json(service.program.stop().out).number("/states/beyond_limit"), 200 - 2 * 64);
}

/// The tag is mounted half a metre ahead of a box of 0.2 x 0.4 m, 0.1 m above its origin, and rotated by 90 degrees.
/// Its height lifts the box, above the laser or onto the floor, unless heights are kept. The robot's own packets, with
/// the same id, state its origin.
TEST(Serve, ATagIsAtItsMount) {
  struct Case {
    double z;  // [m] of the tag
    bool seen;
    std::vector<std::string> options;
  };
  for (const Case& each : {Case{0.1, true, {}}, Case{3.0, false, {}}, Case{3.0, true, {"--keep-heights"}}}) {
    Service service(
        std::string(kRoom) + "model( name \"tag1\" pose [-2 1.5 0 0] size [0.2 0.4 0.2] tag_pose [0.5 0 0.1 90] )\n",
        each.options);
    ASSERT_NE(service.port, 0u) << service.program.err();
    Robot one(1, service.port, service.laser_port(1));
    std::uint32_t sequence = 0;
    std::vector<double> ranges;
    const bool seen = until([&] {
      base::Bytes tag;
      netio::encode({.robot = 1, .sequence = sequence++},
                    netio::Tag{.position = {1.5, 0.5, each.z}, .orientation = {0, 0, 1, 0}}, tag);
      one.send_state({0.0, 0.0, 0.0, 0.0});
      one.send(tag);
      ranges = one.receive();
      return ranges.size() == 91 && sequence > 20 && (std::fabs(ranges[45] - 1.2) <= 0.000501) == each.seen;
    });
    EXPECT_TRUE(seen) << each.z << ' ' << testing::PrintToString(ranges);
  }
}

/// A robot that no file names: a subscription alone does not place it, its first state does, under each policy. It gets
/// readings, and leaves without a trace, so that a subscription after that does not bring it back.
TEST(Serve, RobotsOfAPatternMayJoinAndLeave) {
  for (const std::vector<std::string>& policy : {std::vector<std::string>{}, {"--raw"}, {"--filter"}}) {
    std::vector<std::string> options{"--join", "roomba1=50-51"};
    options.insert(options.end(), policy.begin(), policy.end());
    Service service(kRoom, options);
    ASSERT_NE(service.port, 0u) << service.program.err();
    Robot one(1, service.port, service.laser_port(1)), guest(50, service.port, service.laser_port(50));
    std::vector<double> ranges, of_guest;
    bool drives = false;
    const auto sees = [&](double range) {
      return until([&] {
        one.send_state({-1.0, 0.5, 0.0, 0.0});
        one.ask(), guest.ask();
        if (drives) guest.send_state({0.5, 0.5, 0.0, 0.0});
        if (const auto own = guest.receive(); !own.empty()) of_guest = own;
        ranges = one.receive();
        return ranges.size() == 91 && std::fabs(ranges[45] - range) <= 0.000501;
      });
    };
    const std::vector<double> alone = sensed(service.world, "roomba1", "-1,0.5,0");
    EXPECT_TRUE(sees(alone[45])) << testing::PrintToString(ranges);
    EXPECT_TRUE(of_guest.empty()) << "it has no pose yet";
    drives = true;
    EXPECT_TRUE(sees(1.25)) << "1.5 m less the mount and half a body: " << testing::PrintToString(ranges);
    EXPECT_TRUE(until([&] { return sees(1.25) && of_guest.size() == 91; }));
    drives = false;
    EXPECT_TRUE(until([&] {
      guest.leave();
      one.send_state({-1.0, 0.5, 0.0, 0.0});
      one.ask();
      ranges = one.receive();
      return ranges.size() == 91 && std::fabs(ranges[45] - alone[45]) <= 0.000501;
    }));
    EXPECT_TRUE(sees(alone[45])) << "it subscribes again";
  }
}

TEST(Serve, StatesAreRelayedWithinRadioRange) {
  Service service(kRoom, {"--rate", "50", "--radio", "3"});
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot one(1, service.port, service.laser_port(1)), two(2, service.port, service.laser_port(2));
  const auto turn = [&](double x) {
    one.ask();
    one.send_state({-1.0, 0.0, 0.0, 0.0});
    two.send_state({x, 0.0, 0.0, 0.0});
    one.receive(), two.receive();
  };
  ASSERT_TRUE(until([&] { return turn(2.5), one.stamps().size() >= 5 && two.stamps().size() >= 5; }));
  EXPECT_EQ(one.states(), 0u) << "3.5 m apart";
  EXPECT_TRUE(until([&] { return turn(1.5), one.states() > 0; }));
  EXPECT_EQ(two.states(), 0u) << "it did not ask";
  const Json facts(service.program.stop().out);
  EXPECT_GE(facts.number("/relayed/states"), 1);
  EXPECT_EQ(facts.number("/relayed/datagrams"), facts.number("/relayed/states"));
  EXPECT_EQ(facts.number("/relayed/waited"), 0);
}

/// A robot receives the follow relations of others: it halves its speed for a follower that has fallen behind.
TEST(Serve, AFollowedRobotWaitsForItsFollower) {
  const std::string car = "position( size [0.33 0.33 0.1] name \"roomba";
  Service service("road( rndf \"" + our_world("simville/simville.rndf") + "\" )\n" + car +
                  "1\" pose [3.9 0.75 0 0] )\n" + car + "2\" pose [2.4 0.75 0 0] )\n");
  ASSERT_NE(service.port, 0u) << service.program.err();
  const std::string port = std::to_string(service.port);
  Robot two(2, service.port, service.laser_port(2));
  Program one({"robot", service.world, "--name", "roomba1", "--port", port, "--json", "--controller", "route", "--set",
               "tour=true", "--wait-for-start", "--duration", "3"});
  const auto turn = [&] { two.ask(), two.send_state({2.4, 0.75, 0.0, 0.0}, 1); };
  ASSERT_TRUE(until([&] { return turn(), two.states() >= 3; })) << "from then on each receives the other's states";
  EXPECT_EQ(run_program({"start", "--port", port, "--robot", "1"}).code, 0);
  ASSERT_TRUE(until([&] { return turn(), !one.running(); }));
  const Json facts(one.wait().out);
  EXPECT_GT(facts.number("/distance_m"), 0.05);
  EXPECT_LT(facts.number("/distance_m"), 0.6 * 0.2 * facts.number("/wall_s")) << "0.2 m/s is its speed";
}

TEST(Serve, StrangersAreCountedAndDropped) {
  Service service;
  ASSERT_NE(service.port, 0u) << service.program.err();
  const unsigned spare = service.lasers + 1;
  Robot one(1, service.port, service.laser_port(1)), impostor(1, service.port, spare),
      unknown(99, service.port, spare + 1);
  ASSERT_TRUE(until([&] {
    one.send_state({-1.0, 0.5, 0.0, 0.0});
    return !one.receive().empty();
  }));
  ASSERT_TRUE(prove(impostor));
  // On a busy machine, a robot may have been silent for two seconds: it sends again before every try.
  ASSERT_TRUE(until([&] {
    one.send_state({-1.0, 0.5, 0.0, 0.0});
    impostor.send_state({2.0, 0.0, 0.0, 0.0});
    return service.program.err().find("are dropped until") != std::string::npos;
  }));
  unknown.send_state({0.0, 0.0, 0.0, 0.0});
  netio::Outbox outbox;
  outbox.queue({netio::kLoopback, static_cast<std::uint16_t>(service.port)}, base::Bytes{1, 2, 3});
  outbox.flush();
  base::Bytes no_number = one.state({});
  const double nan = std::nan("");
  std::memcpy(no_number.data() + netio::kHeaderBytes, &nan, sizeof nan);
  one.send(no_number);
  service.program.signal(SIGINT);  // packets that are pending then are still counted
  const Outcome outcome = service.program.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_GE(facts.number("/received/wrong source"), 1);
  EXPECT_EQ(facts.number("/received/unknown robot"), 1);
  EXPECT_EQ(facts.number("/received/too short"), 1);
  EXPECT_EQ(facts.number("/received/not finite"), 1);
}

TEST(Serve, StrangersAreReportedOncePerBindingUntilALeave) {
  Service service;
  ASSERT_NE(service.port, 0u) << service.program.err();
  Robot one(1, service.port, service.laser_port(1)), again(1, service.port, service.lasers + 1);
  ASSERT_TRUE(until([&] {
    one.send_state({-1.0, 0.5, 0.0, 0.0});
    return !one.receive().empty();
  }));
  ASSERT_TRUE(prove(again));
  for (int i = 0; i < 5; ++i) again.send_state({2.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(service.program.prints("are dropped"));
  one.leave();
  // It owns the id from here on, though less than two seconds have passed.
  for (int i = 0; i < 5; ++i) again.send_state({2.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(until([&] { return one.receives_for(again); }));
  const Outcome outcome = service.program.stop();
  EXPECT_EQ(count_lines(outcome.err), 2u) << outcome.err;  // the service's address, and the stranger
  EXPECT_NE(outcome.err.find("roomba1 (id 1) is at 127.0.0.1:"), std::string::npos) << outcome.err;
  EXPECT_EQ(Json(outcome.out).number("/received/wrong source"), 5);
}

TEST(Serve, AddressesBeyondThisMachineCauseAWarning) {
  const Folder folder;
  const std::string world = folder.write("room.world", kRoom);
  const std::string base = std::to_string(free_ports(24));
  const Words listen{"listen", world, "--duration", "0.1", "--laser-port", base};
  const Outcome warned = run_program(with(listen, {"--bind", "0.0.0.0"}));
  EXPECT_NE(warned.err.find("warning: --bind 0.0.0.0 opens the port to "), std::string::npos) << warned.err;
  EXPECT_NE(warned.err.find("use --bind 127.0.0.1 to allow this machine only"), std::string::npos) << warned.err;
  EXPECT_EQ(run_program(listen).err.find("warning"), std::string::npos);
  const Outcome served = run_program({"serve", world, "--port", "0", "--duration", "0.1", "--bind", "0.0.0.0"});
  EXPECT_NE(served.err.find("anyone there can report robot states"), std::string::npos) << served.err;
  EXPECT_NE(served.err.find("since packets are not signed (sign them with --peers)"), std::string::npos) << served.err;
}

/// A table with only some keys: the command names the senders that may be unsigned. With all keys, there is no warning.
TEST(Serve, TheWarningNamesSendersWithoutAKey) {
  const Folder folder;
  const std::string world = folder.write("room.world", kRoom);
  const auto key = [](char digit) { return "\nkey = \"" + std::string(64, digit) + "\"\n"; };
  const std::string some = "[[peer]]\nrobot = 1" + key('1');
  const auto err_with = [&](const std::string& peers, const Words& more = {}) {
    return run_program(with({"serve", world, "--port", "0", "--duration", "0.1", "--bind", "0.0.0.0", "--peers",
                             folder.write("peers.toml", peers)},
                            more))
        .err;
  };
  const std::string err = err_with(some + "[[peer]]\nrobot = 2" + key('2'));
  EXPECT_NE(err.find("peers.toml has no key for START; use --bind 127.0.0.1 to allow"), std::string::npos) << err;
  EXPECT_NE(err_with(some).find("has no key for roomba2, START;"), std::string::npos) << err_with(some);
  const std::string all = some + "[[peer]]\nrobot = 2" + key('2') + "[[peer]]\nstart = true" + key('3');
  EXPECT_EQ(err_with(all).find("opens the port to"), std::string::npos) << err_with(all);
  EXPECT_NE(err_with(all, {"--spat", std::to_string(free_ports(1))}).find("has no key for SPaT (--spat);"),
            std::string::npos);
}

TEST(Serve, APlayerServerBeyondThisMachineCausesAWarning) {
  const Folder folder;
  const std::string world = folder.write("room.world", kRoom);
  const auto err_at = [&](const std::string& place) {
    return run_program({"run", world, "--duration", "0.1", "--player", place}).err;
  };
  const std::string err = err_at("0.0.0.0:0");
  EXPECT_NE(err.find("warning: --player 0.0.0.0 opens the port to "), std::string::npos) << err;
  EXPECT_NE(err.find("read sensors and drive robots, since Player has no passwords"), std::string::npos) << err;
  EXPECT_EQ(err_at("0").find("opens the port to"), std::string::npos);
}

/// The default stride is 8 if that fits; otherwise the command prints the stride.
TEST(SendAndListen, PortsPerRobotFitTheSensors) {
  const Folder folder;
  std::string robots;
  for (const std::string name : {"roomba1", "roomba2"}) {
    robots += "position( name \"" + name + "\" pose [" + (name == "roomba1" ? "0" : "2") + " 0 0 0]";
    for (int i = 0; i < 17; ++i) robots += " laser( samples 2 )";
    robots += " )\n";
  }
  const std::string world = folder.write("w.world", robots);
  const Outcome received = exchange(world, "34 ports", "0.3", {}).received;
  EXPECT_NE(received.err.find("ports per robot: 17, the minimum"), std::string::npos) << received.err;
  const Json in(received.out);
  EXPECT_EQ(in.number("/good"), 34 * 3);
  EXPECT_EQ(in.number("/silent_ports"), 0);
  expect_refused({"serve", world, "--port", "0", "--ports-per-robot", "8"}, "raise the stride to at least 17");
}

TEST(SendAndListen, TheThesisFormatOmitsUnsupportedSensors) {
  const Folder folder;
  const std::string world =
      folder.write("w.world",
                   "position( name \"roomba1\" laser( samples 2 ) infrared( scount 1 spose[0] [0 0 0] ) )\n"
                   "position( name \"roomba2\" pose [2 0 0 0] laser( samples 2 ) laser( samples 400 ) )\n");
  const auto [sent, received] = exchange(world, "2 ports", "0.3", {"--wire", "thesis"});
  EXPECT_NE(sent.err.find("left out: roomba1.infrared"), std::string::npos) << sent.err;
  EXPECT_NE(sent.err.find("left out: roomba2.laser:1: 400 samples"), std::string::npos) << sent.err;
  EXPECT_EQ(count_lines(sent.err), 2u) << sent.err;
  const Json in(received.out);
  EXPECT_EQ(in.number("/good"), 2 * 3);
  EXPECT_EQ(in.number("/packets"), 2 * 3);
  EXPECT_EQ(Json(sent.out).number("/packets/sent"), 2 * 3);
}

TEST(Serve, ATakenPortIsReported) {
  const unsigned port = free_ports(1);
  const netio::Socket taken = netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(port)});
  expect_refused({"serve", our_world("rooms.world"), "--port", std::to_string(port)}, std::to_string(port), "--port 0");
}

/// Packets of two commands arrive in order: when the second is refused, the first has been applied.
TEST(Serve, ObjectsChangeTheirShapes) {
  const Folder folder;
  const std::string world =
      folder.write("w.world",
                   "shape( name \"crate\" size [1 1 1] )\nposition( name \"roomba1\" laser( samples 9 ) )\n"
                   "model( name \"tag3\" pose [2 0 0 0] size [0.2 0.2 0.5] )\nmodel( name \"tag4\" pose [4 0 0 0] )\n");
  const std::string port = std::to_string(free_ports(1)), record = folder.path("r");
  Program service({"serve", world, "--port", port, "--record", record});
  ASSERT_TRUE(service.prints("serving 1 robot")) << service.err();
  const auto object = [&](const std::string& tag, const std::string& shape) {
    run_successfully({"object", "present", "--tag", tag, "--shape", shape, "--color", "red", "--port", port});
  };
  object("3", "crate");
  object("4", "crat");
  EXPECT_TRUE(service.prints("has no shape 'crat'; did you mean 'crate'?")) << service.err();
  run_successfully({"object", "present", "--tag", "3", "--color", "blue", "--port", port});  // soon after the first
  run_successfully({"object", "present", "--tag", "4", "--shape", "crats", "--port", port});
  EXPECT_TRUE(service.prints("has no shape 'crats'")) << service.err();
  const Outcome served = service.stop();
  EXPECT_EQ(served.code, 0);
  EXPECT_EQ(served.err.find("no shape 'crat';"), served.err.rfind("no shape 'crat';")) << "once: " << served.err;
  EXPECT_EQ(served.err.find("another"), std::string::npos) << served.err;
  const record::Recording recording = record::open_recording(record);
  ASSERT_EQ(recording.shapes.size(), 2u);
  ASSERT_EQ(recording.shapes[0].shapes.size(), 1u);
  EXPECT_EQ(recording.shapes[0].shapes[0].color, 0xFFFF0000u);
  ASSERT_EQ(recording.shapes[1].shapes.size(), 1u);
  EXPECT_EQ(recording.shapes[1].shapes[0].color, 0xFF0000FFu) << "the second command is not from a wrong source";
  EXPECT_EQ(recording.shapes[0].shapes[0].shape, 0u);
  run_successfully({"verify", record});
  expect_refused({"object", "present", "--tag", "3", "--shape", "a b"}, "'a b' is no name of a shape");
  expect_refused({"object", "present", "--tag", "3", "--size", "1,2,0"}, "--size: expected X,Y,Z above 0");
}

TEST(Serve, LanesChangeTheirUse) {
  const std::string port = std::to_string(free_ports(1));
  Program service({"serve", our_world("simville/simville.world"), "--port", port});
  ASSERT_TRUE(service.prints("serving ")) << service.err();
  run_successfully({"lane", "3.1", "closed", "--port", port});
  EXPECT_TRUE(service.prints("lane 3.1 is closed")) << service.err();
  run_successfully({"lane", "3.1", "open", "--port", port});
  EXPECT_TRUE(service.prints("lane 3.1 is open")) << service.err();
  run_successfully({"lane", "99.1", "closed", "--port", port});
  EXPECT_TRUE(service.prints("LANE 99.1: 'closed' is refused: ")) << service.err();
  EXPECT_EQ(service.stop().code, 0);
  expect_refused({"lane", "3", "closed", "--port", port}, "'3' is no lane; expected segment.lane");
}

}  // namespace sf
