// The program with --ros2 in its own process, and Fast DDS in this one.

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "record/cdr.h"
#include "record/ros_messages.h"
#include "tests/apps/program.h"
#include "tests/bridges/raw_client.h"
#include "tests/ros2/cyclone_peer.h"
#include "tests/ros2/domain.h"
#include "tests/ros2/fast_peer.h"

namespace sf::ros2 {
namespace {

const Environment kHere{{"ROS_LOCALHOST_ONLY", "1"}};

TEST(Ros2Program, ARunIsVisibleDrivableAndPausable) {
  const std::string domain = std::to_string(own_domain());
  Program run({"run", our_world("rooms.world"), "--ros2", domain}, kHere);
  ASSERT_TRUE(run.prints("node /sensorfarm in domain " + domain + ", on this machine")) << run.err();
  FastPeer peer(static_cast<std::uint32_t>(std::stoul(domain)));
  ASSERT_TRUE(peer.wait([&] { return !peer.endpoints().empty(); }));
  const auto topic = [&](const std::string& ending) {
    for (const Endpoint& one : peer.endpoints())
      if (one.topic.ends_with(ending)) return one.topic;
    return std::string();
  };
  ASSERT_TRUE(peer.wait([&] { return !topic("/scan").empty() && !topic("/cmd_vel").empty(); }));
  const std::size_t scans = peer.subscribe(topic("/scan"), "sensor_msgs::msg::dds_::LaserScan_", false, false);
  const std::size_t clock = peer.subscribe("rt/clock", "rosgraph_msgs::msg::dds_::Clock_", false, false);
  const std::string commands = topic("/cmd_vel");
  const std::size_t odometry =
      peer.subscribe(commands.substr(0, commands.rfind('/')) + "/odom", "nav_msgs::msg::dds_::Odometry_", false, false);
  const std::size_t drive = peer.advertise(commands, "geometry_msgs::msg::dds_::Twist_");
  EXPECT_TRUE(peer.wait([&] { return !peer.messages(scans).empty() && !peer.messages(clock).empty(); }));
  EXPECT_TRUE(decode_scan(peer.messages(scans).front()));
  EXPECT_TRUE(peer.wait([&] {
    peer.send(drive, encode_twist(0.0, 0.0, 0.125));
    const auto messages = peer.messages(odometry);
    const auto last = messages.empty() ? std::nullopt : decode_odometry(messages.back());
    return last && std::abs(last->velocity[5] - 0.125) < 1e-9;
  }));
  EXPECT_EQ(run.stop().code, 0);
}

/// A robot joins the run, then another world replaces it. Files outside the run's folders cannot be named.
TEST(Ros2Program, ARunAcceptsRobotsAndWorlds) {
  const std::string domain = std::to_string(own_domain());
  Program run({"run", our_world("rooms.world"), "--ros2", domain, "--view", "127.0.0.1:0", "--player", "127.0.0.1:0"},
              kHere);
  const std::string before_port = "view on http://127.0.0.1:";
  ASSERT_TRUE(run.prints(before_port)) << run.err();
  const int port = std::atoi(run.err().c_str() + run.err().find(before_port) + before_port.size());
  /// Returns the topics advertised by the live view.
  const auto greeting = [port] {
    bridges::RawClient client(static_cast<std::uint16_t>(port));
    EXPECT_EQ(client.upgrade("foxglove.websocket.v1").substr(9, 3), "101");
    return client.settle();
  };
  FastPeer peer(static_cast<std::uint32_t>(std::stoul(domain)));
  CyclonePeer cyclone(static_cast<std::uint32_t>(std::stoul(domain)));
  std::int64_t calls = 0;
  /// Returns the code of the answer, 0 without one.
  const auto call = [&](const std::string& name, const std::string& type, const auto& put) {
    base::Bytes fields;
    record::CdrWriter cdr(fields);
    put(cdr);
    const std::size_t ask =
        cyclone.advertise("rq/" + name + "Request", "simulation_interfaces::srv::dds_::" + type + "_Request_");
    const std::size_t answers =
        cyclone.subscribe("rr/" + name + "Reply", "simulation_interfaces::srv::dds_::" + type + "_Response_");
    int code = 0;
    peer.wait([&] { return cyclone.matched_writer(ask); });
    // Repeat the call: a participant may discover the other before it is discovered itself.
    const std::int64_t first = calls + 1;
    int looked = 0;
    EXPECT_TRUE(peer.wait([&] {
      if (looked++ % 50 == 0) cyclone.send(ask, encode_request(17, ++calls, {fields.begin() + 4, fields.end()}));
      for (const base::Bytes& message : cyclone.messages(answers))
        if (const auto reply = decode_reply(message); reply && reply->sequence >= first)
          return code = reply->code, true;
      return false;
    })) << name;
    return code;
  };
  const auto load = [&](const char* uri) {
    return [uri](record::CdrWriter& cdr) {
      cdr.put(uri);
      cdr.put("");
      cdr.put(false);
      cdr.put(false);
    };
  };
  const auto seen = [&](const std::string& topic) {
    return peer.wait([&] {
      const auto known = peer.endpoints();
      return std::any_of(known.begin(), known.end(), [&](const Endpoint& one) { return one.topic == topic; });
    });
  };
  const int spawned = call("spawn_entity", "SpawnEntity", [](record::CdrWriter& cdr) {
    cdr.put("late");
    cdr.put(false);
    cdr.put("roomba1");
    cdr.put("");
    cdr.put("");
    record::put_header(cdr, 0, "");
    for (const double value : {1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0}) cdr.put(value);
  });
  EXPECT_TRUE(spawned == 1 || spawned == 101) << spawned << ": accepted by an earlier call whose answer was missed";
  EXPECT_TRUE(seen("rt/late/odom"));
  EXPECT_NE(greeting().find("\"/late/odom\""), std::string::npos) << "on the same port";
  EXPECT_EQ(call("load_world", "LoadWorld", load("cave.world")), 1);
  EXPECT_EQ(call("unload_world", "UnloadWorld", [](record::CdrWriter& cdr) { cdr.put(std::uint8_t{0}); }), 1);
  EXPECT_EQ(greeting().find("/odom\""), std::string::npos) << "no world, so no robots";
  EXPECT_EQ(run.stop().code, 0) << run.err();
}

/// Cyclone DDS crashes if it cannot open more descriptors. Below 8, other parts report the error.
TEST(Ros2Program, TooFewDescriptorsAreReported) {
  for (const char* most : {"8", "9", "10", "11", "12", "13", "16", "20"}) {
    const Outcome outcome =
        Program({"-c", std::string("ulimit -n ") + most + "; exec \"$0\" \"$@\"", SF_PROGRAM, "run",
                 our_world("rooms.world"), "--duration", "0.1", "--ros2", std::to_string(own_domain())},
                kHere, "", "", "sh")
            .wait();
    EXPECT_EQ(outcome.signal, 0) << most << outcome.err;
    if (outcome.code != 0) {
      EXPECT_NE(outcome.err.find("ulimit -n"), std::string::npos) << most << outcome.err;
    }
  }
}

TEST(Ros2Program, AServiceAnswersQueries) {
  const std::string domain = std::to_string(own_domain());
  Program serve({"serve", our_world("rooms.world"), "--port", "0", "--ros2", domain}, kHere);
  ASSERT_TRUE(serve.prints("node /sensorfarm")) << serve.err();
  FastPeer peer(static_cast<std::uint32_t>(std::stoul(domain)));
  const std::size_t ask =
      peer.advertise("rq/get_simulation_stateRequest", "simulation_interfaces::srv::dds_::GetSimulationState_Request_");
  const std::size_t answers =
      peer.subscribe("rr/get_simulation_stateReply", "simulation_interfaces::srv::dds_::GetSimulationState_Response_");
  ASSERT_TRUE(peer.wait([&] { return peer.matched_writer(ask) && peer.matched_reader(answers); }));
  EXPECT_TRUE(peer.wait([&] {
    peer.call(ask, answers, encode_fields({0}));
    return !peer.replies(answers).empty();
  }));
  for (const Endpoint& one : peer.endpoints())
    EXPECT_EQ(one.topic.find("cmd_vel"), std::string::npos) << "robots of a service live elsewhere";
  EXPECT_EQ(serve.stop().code, 0);
}

TEST(Ros2Program, ReportsTheErrorInOneLine) {
  const std::string world = our_world("rooms.world");
  const auto refusal = [&](const Words& words, const Environment& environment) {
    const Outcome outcome = run_program(with({"run", world, "--duration", "0.1"}, words), environment);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
    return outcome.err;
  };
  EXPECT_NE(refusal({"--ros2", "--topics", "plain"}, {}).find("has 2 robots"), std::string::npos);
  EXPECT_NE(refusal({"--ros2", "--topics", "sensor", "--external", "filter"}, {}).find("no frame odom"),
            std::string::npos);
  EXPECT_NE(refusal({"--ros2", "--external", "mapper,amcl"}, {}).find("'amcl'"), std::string::npos);
  EXPECT_NE(refusal({"--ros2", "233"}, {}).find("from 0 to 232"), std::string::npos);
  EXPECT_NE(refusal({"--ros2"}, {{"ROS_DOMAIN_ID", "home"}}).find("ROS_DOMAIN_ID 'home'"), std::string::npos);
}

TEST(Ros2Program, WithoutThePlugInReportsTheMissingFile) {
  const Folder folder;
  std::filesystem::copy_file(SF_PROGRAM, folder.path("alone"));
  setenv("SENSORFARM_PROGRAM", folder.path("alone").c_str(), 1);
  const Outcome outcome = run_program({"run", our_world("rooms.world"), "--ros2", "--duration", "0.1"});
  unsetenv("SENSORFARM_PROGRAM");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
  EXPECT_NE(outcome.err.find("it requires Cyclone DDS 0.10"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace sf::ros2
