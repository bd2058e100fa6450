// A run as a ROS 2 node, seen by Fast DDS, another DDS implementation. Both are in this process and communicate over
// the loopback interface. Tests wait only for conditions.

#include <gtest/gtest.h>
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <map>
#include <thread>

#include "base/error.h"
#include "bridges/ros2_bridge.h"
#include "record/recorder.h"
#include "record/recording.h"
#include "record/ros_messages.h"
#include "scenarios/operator.h"
#include "scenarios/run_info.h"
#include "scenarios/simulation.h"
#include "tests/device.h"
#include "tests/ros2/cyclone_peer.h"
#include "tests/ros2/domain.h"
#include "tests/ros2/fast_peer.h"
#include "tests/sensors/scenes.h"

namespace sf::ros2 {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Two robots in the middle of four walls.
world::World room() {
  world::World world;
  world.name = "room";
  scenes::add_room(world, {0.0, 0.0}, 8.0);
  scenes::add_robot(world, {-1.0, 0.5, 0.0, 0.3}, scenes::laser());
  scenes::add_robot(world, {1.0, 0.0, 0.0, 0.0}, scenes::laser());
  world.movers[0].name = "scout";
  world.movers[1].name = "robot 2";
  return world;
}

/// Returns a domain for this process only, so that concurrent tests do not interfere.

record::RunInfo named(record::RunInfo info) {
  record::name_frames(info);
  return info;
}

/// A run of that world with the bridge, and its peer.
struct Ros2Test : testing::Test {
  Ros2Test() {
    auto made = std::make_unique<bridges::Ros2Bridge>(bridges::Ros2Options{own_domain(), true},
                                                      bridges::Scene{world, sensor_set, info});
    bridge = made.get();
    all.add(std::move(made));
  }

  /// Simulates the next tick, or restarts.
  /// @return false: asked to stop
  bool advance() {
    const auto next = users.wait(simulation, 0.1 * static_cast<double>(ticks));
    if (next == scenarios::Operator::Next::stop) return false;
    if (next == scenarios::Operator::Next::reset) return users.begin_again(), true;
    const base::TickRecord tick = simulation.step();
    users.publish(tick);
    if (recorder) recorder->write(tick);
    ++ticks;
    return true;
  }
  /// Simulates ticks until `condition` holds.
  /// @return false: it did not within a minute
  bool run_until(const std::function<bool()>& condition) {
    return peer.wait([&] { return condition() || (advance(), false); });
  }
  /// Does the same for a run that is paused, or will be, and that simulates requested ticks.
  bool run_paused_until(const std::function<bool()>& condition) {
    bool held = false;
    std::thread watch([&] {
      held = peer.wait(condition);
      stop = true;
    });
    while (advance()) {
    }
    watch.join();
    stop = false;
    return held;
  }

  record::RunInfo info_of_run() const {
    return named(scenarios::run_info(world, sensor_set, {1, true, false, "test"}));
  }

  world::World world = room();
  sensors::SensorSet sensor_set{world};
  record::RunInfo info = info_of_run();
  scenarios::Simulation simulation{world, device(), {.seed = 1}};
  bridges::Bridges all;
  bridges::Ros2Bridge* bridge = nullptr;
  std::atomic<bool> stop{false};
  scenarios::Operator users{all, stop, kNoLimit};
  std::optional<record::Recorder> recorder;
  FastPeer peer{own_domain()};
  CyclonePeer cyclone{own_domain()};
  int ticks = 0;
};

/// A client of a service, in the format of rmw_cyclonedds.
struct Client {
  Client(const FastPeer& clock, CyclonePeer& of, const std::string& name, const std::string& type)
      : waiting(clock),
        peer(of),
        requests(of.advertise("rq/" + name + "Request", type + "_Request_")),
        replies(of.subscribe("rr/" + name + "Reply", type + "_Response_")) {}
  bool known() const { return peer.matched_writer(requests); }
  /// Calls until an answer arrives, because a participant may discover the other before it is discovered itself. The
  /// run continues meanwhile.
  bool connect(const std::vector<std::uint8_t>& fields, const std::function<void()>& advance) {
    if (!waiting.wait([&] { return known(); })) return false;
    int looked = 0;
    return waiting.wait([&] {
      if (looked++ % 8 == 0) call(fields);  // a reset at each check would leave no tick after which to answer
      advance();
      return answers() > 0;
    });
  }
  std::size_t answers() const { return peer.messages(replies).size(); }
  void call(const std::vector<std::uint8_t>& fields) { peer.send(requests, encode_request(17, ++calls, fields)); }
  /// Returns the answer to the last call; nullopt: none yet.
  std::optional<Reply> reply() const {
    for (const base::Bytes& message : peer.messages(replies)) {
      const auto reply = decode_reply(message);
      if (reply && reply->client == 17 && reply->sequence == calls) return reply;
    }
    return std::nullopt;
  }

  const FastPeer& waiting;
  CyclonePeer& peer;
  const std::size_t requests, replies;
  std::int64_t calls = 0;
};

constexpr const char* kScan = "sensor_msgs::msg::dds_::LaserScan_";
constexpr const char* kOdometry = "nav_msgs::msg::dds_::Odometry_";
constexpr const char* kTransforms = "tf2_msgs::msg::dds_::TFMessage_";
constexpr const char* kClock = "rosgraph_msgs::msg::dds_::Clock_";
constexpr const char* kDiscovery = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

TEST_F(Ros2Test, EndpointsAreNamedAsInRos2Nodes) {
  const auto find = [&](const std::string& topic, const std::string& type) -> std::optional<Endpoint> {
    for (const Endpoint& one : peer.endpoints())
      if (one.topic == topic && one.type == type) return one;
    return std::nullopt;
  };
  ASSERT_TRUE(peer.wait([&] { return find("ros_discovery_info", kDiscovery).has_value(); })) << "created last";
  ASSERT_TRUE(peer.wait([&] {
    return find("rt/scout/scan", kScan) && find("rt/robot_2/cmd_vel", "geometry_msgs::msg::dds_::Twist_") &&
           find("rt/robot_2/cmd_vel", "geometry_msgs::msg::dds_::TwistStamped_") &&
           find("rq/set_simulation_stateRequest", "simulation_interfaces::srv::dds_::SetSimulationState_Request_");
  }));
  const Endpoint scan = *find("rt/scout/scan", kScan);
  EXPECT_EQ(scan.user_data, "typehash=RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828;");
  EXPECT_TRUE(scan.writes && scan.reliable && !scan.latched);
  ASSERT_TRUE(peer.wait([&] { return find("rt/tf_static", kTransforms).has_value(); }));
  EXPECT_TRUE(find("rt/tf_static", kTransforms)->latched);
  const Endpoint command = *find("rt/robot_2/cmd_vel", "geometry_msgs::msg::dds_::Twist_");
  EXPECT_TRUE(!command.writes && !command.reliable) << "writers of any reliability are accepted";
  EXPECT_TRUE(find("rt/robot_2/cmd_vel", "geometry_msgs::msg::dds_::TwistStamped_"));
  ASSERT_FALSE(peer.participants().empty());
  EXPECT_EQ(peer.participants().front(), "enclave=/;");
}

TEST_F(Ros2Test, OneServiceHasOneIdentifier) {
  const auto id = [&](const std::string& topic) {
    for (const Endpoint& one : peer.endpoints())
      if (one.topic == topic && one.user_data.starts_with("serviceid="))
        return one.user_data.substr(0, one.user_data.find(';'));
    return std::string();
  };
  const char* const names[] = {"rq/step_simulationRequest", "rr/step_simulationReply", "rq/get_entitiesRequest",
                               "rr/get_entitiesReply"};
  for (const char* name : names) ASSERT_TRUE(peer.wait([&] { return !id(name).empty(); })) << name;
  EXPECT_EQ(id(names[0]).rfind("serviceid=", 0), 0u) << id(names[0]);
  EXPECT_EQ(id(names[0]), id(names[1]));
  EXPECT_EQ(id(names[2]), id(names[3]));
  EXPECT_NE(id(names[0]), id(names[2]));
}

TEST_F(Ros2Test, TheNodeIsAnnouncedToLateReaders) {
  for (int i = 0; i < 3; ++i) advance();
  const std::size_t reader = peer.subscribe("ros_discovery_info", kDiscovery, true);
  ASSERT_TRUE(peer.wait([&] { return !peer.messages(reader).empty(); }));
  const auto nodes = decode_nodes(peer.messages(reader).front());
  ASSERT_TRUE(nodes);
  ASSERT_EQ(nodes->size(), 1u);
  EXPECT_EQ(nodes->front().space, "/");
  EXPECT_EQ(nodes->front().name, "sensorfarm");
  const auto count = [&] {
    const auto known = peer.endpoints();
    return std::count_if(known.begin(), known.end(), [](const Endpoint& one) {
      const bool is_of_service = one.topic.starts_with("rq/") || one.topic.starts_with("rr/");
      const bool is_again = is_of_service && !one.user_data.starts_with("serviceid=");  // of Fast DDS
      return one.topic != "ros_discovery_info" && !is_again;
    });
  };
  EXPECT_TRUE(peer.wait([&] { return count() == static_cast<long>(nodes->front().readers + nodes->front().writers); }))
      << count() << " of " << nodes->front().readers << " + " << nodes->front().writers;
}

TEST_F(Ros2Test, LateReadersReceiveTheFramesOfSensors) {
  for (int i = 0; i < 3; ++i) advance();
  const std::size_t reader = peer.subscribe("rt/tf_static", kTransforms, true);
  ASSERT_TRUE(peer.wait([&] { return !peer.messages(reader).empty(); }));
  const auto frames = decode_transforms(peer.messages(reader).front());
  ASSERT_TRUE(frames);
  std::map<std::string, std::string> parents;
  for (const Transform& frame : *frames) parents[frame.child] = frame.frame;
  EXPECT_EQ(parents, (std::map<std::string, std::string>{{"world", "map"},
                                                         {"scout/base_footprint", "scout/base_link"},
                                                         {"scout/laser", "scout/base_link"},
                                                         {"robot_2/base_footprint", "robot_2/base_link"},
                                                         {"robot_2/laser", "robot_2/base_link"}}));
}

/// One reader of each topic, and a recording of the same ticks.
struct Ros2Readings : Ros2Test {
  static constexpr std::size_t kTicks = 12;

  void run() {
    const std::string folder = testing::TempDir() + "ros2_readings";
    recorder.emplace(folder, info);
    ASSERT_TRUE(peer.wait([&] {
      return peer.matched_reader(scans) && peer.matched_reader(odometry) && peer.matched_reader(clock) &&
             peer.matched_reader(transforms);
    }));
    ASSERT_TRUE(run_until([&] { return peer.messages(scans).size() >= kTicks; }));
    ASSERT_TRUE(peer.wait([&] { return !peer.messages(odometry).empty() && !peer.messages(transforms).empty(); }));
    recorder.reset();
    recording = record::open_recording(folder);
  }
  /// @return null: that tick is not in the recording
  const record::StateSample* state_at(std::size_t mover, std::int64_t time) const {
    for (const record::StateSample& state : recording.states[mover])
      if (state.time == time) return &state;
    return nullptr;
  }

  const std::size_t scans = peer.subscribe("rt/scout/scan", kScan);
  const std::size_t odometry = peer.subscribe("rt/robot_2/ground_truth/odom", kOdometry, false, false);
  const std::size_t clock = peer.subscribe("rt/clock", kClock, false, false);
  const std::size_t transforms = peer.subscribe("rt/tf", kTransforms);
  record::Recording recording;
};

TEST_F(Ros2Readings, MatchTheRecording) {
  ASSERT_NO_FATAL_FAILURE(run());
  std::map<std::int64_t, const record::ReadingSample*> recorded;
  for (const record::ReadingSample& sample : recording.readings)
    if (sample.mover == 0) recorded[sample.time] = &sample;
  for (const base::Bytes& message : peer.messages(scans)) {
    const auto scan = decode_scan(message);
    ASSERT_TRUE(scan);
    ASSERT_TRUE(recorded.contains(scan->time)) << scan->time;
    const auto& values = recorded[scan->time]->values;
    ASSERT_EQ(scan->ranges.size(), 361u);
    EXPECT_TRUE(std::equal(scan->ranges.begin(), scan->ranges.end(), values.begin(), values.end()));
    EXPECT_EQ(scan->frame, "scout/laser");
    EXPECT_FLOAT_EQ(scan->angle_min, static_cast<float>(-M_PI / 2));
    EXPECT_FLOAT_EQ(scan->angle_increment, static_cast<float>(M_PI / 360));
    EXPECT_EQ(scan->range_max, 8.0F);
  }
  for (const base::Bytes& message : peer.messages(odometry)) {
    const auto pose = decode_odometry(message);
    ASSERT_TRUE(pose);
    const auto* const state = state_at(1, pose->pose.time);
    ASSERT_NE(state, nullptr) << pose->pose.time;
    EXPECT_EQ(pose->pose.position[0], state->X_WM.x);
    EXPECT_EQ(pose->pose.position[1], state->X_WM.y);
    EXPECT_NEAR(2.0 * std::atan2(pose->pose.rotation[2], pose->pose.rotation[3]), state->X_WM.yaw, 1e-12);
    EXPECT_EQ(pose->velocity[0], state->velocity.forward);
    EXPECT_EQ(pose->velocity[5], state->velocity.turn);
  }
  for (const base::Bytes& message : peer.messages(transforms)) {
    const auto poses = decode_transforms(message);
    ASSERT_TRUE(poses);
    ASSERT_EQ(poses->size(), 4u);
    for (std::size_t mover = 0; mover < 2; ++mover) {
      const Transform &odom = (*poses)[2 * mover], &robot = (*poses)[2 * mover + 1];
      const auto* const state = state_at(mover, robot.time);
      ASSERT_NE(state, nullptr);
      EXPECT_EQ(odom.frame, "map");
      EXPECT_EQ(odom.child, robot.frame);
      EXPECT_EQ(odom.time, robot.time);
      const double yaw = 2.0 * std::atan2(odom.rotation[2], odom.rotation[3]);
      const glm::dvec2 p = base::rotate(yaw, {robot.position[0], robot.position[1]});
      EXPECT_NEAR(odom.position[0] + p.x, state->X_WM.x, 1e-9);
      EXPECT_NEAR(odom.position[1] + p.y, state->X_WM.y, 1e-9);
    }
  }
}

TEST_F(Ros2Readings, TheClockPublishesEveryTick) {
  ASSERT_NO_FATAL_FAILURE(run());
  ASSERT_TRUE(peer.wait([&] { return !peer.messages(clock).empty(); }));
  std::int64_t last = -1;
  for (const base::Bytes& message : peer.messages(clock)) {
    const auto time = decode_clock(message);
    ASSERT_TRUE(time);
    EXPECT_GT(*time, last);
    EXPECT_NE(state_at(0, *time), nullptr);
    last = *time;
  }
}

/// A publisher of commands for a robot, and its odometry.
struct Ros2Commands : Ros2Test {
  /// Sends `command` before every tick, as nodes do, until the robot turns at that rate.
  bool turns(std::size_t writer, const base::Bytes& command, double turn) {
    return peer.wait([&] {
      peer.send(writer, command);
      advance();
      const auto messages = peer.messages(odometry);
      const auto last = messages.empty() ? std::nullopt : decode_odometry(messages.back());
      return last && std::abs(last->velocity[5] - turn) < 1e-9 && std::abs(last->velocity[0]) < 1e-9;
    });
  }
  const std::size_t plain = peer.advertise("rt/scout/cmd_vel", "geometry_msgs::msg::dds_::Twist_", false);
  const std::size_t odometry = peer.subscribe("rt/scout/odom", kOdometry);
};

TEST_F(Ros2Commands, DriveTheRobot) { EXPECT_TRUE(turns(plain, encode_twist(0.0, 0.0, 0.5), 0.5)); }

TEST_F(Ros2Commands, MayBeStamped) {
  FastPeer other(own_domain());  // a participant has only one type per topic
  const std::size_t stamped = other.advertise("rt/scout/cmd_vel", "geometry_msgs::msg::dds_::TwistStamped_");
  EXPECT_TRUE(peer.wait([&] {
    other.send(stamped, encode_twist_stamped(0.0, 0.0, -0.25));
    advance();
    const auto messages = peer.messages(odometry);
    const auto last = messages.empty() ? std::nullopt : decode_odometry(messages.back());
    return last && std::abs(last->velocity[5] + 0.25) < 1e-9;
  }));
}

TEST_F(Ros2Commands, UnreadableOnesAreCountedAndDropped) {
  const base::Bytes whole = encode_twist(1.0, 0.0, 0.0);
  const std::vector<base::Bytes> faulty{
      {whole.begin(), whole.begin() + 4},             // no field
      {whole.begin(), whole.end() - 4},               // the last field is truncated
      {2, 0, 0, 0, 0, 0, 0, 0},                       // another encapsulation
      encode_twist(NAN, 0.0, 0.0),                    // not a number
      encode_twist(0.0, 0.0, INFINITY),               // not finite
      base::Bytes(bridges::kDdsMaxReceived + 1, 0)};  // longer than any accepted message
  ASSERT_TRUE(turns(plain, encode_twist(0.0, 0.0, 0.5), 0.5)) << "from here on, the writer is known";
  const std::size_t reliable = peer.advertise("rt/robot_2/cmd_vel", "geometry_msgs::msg::dds_::Twist_");
  for (std::size_t i = 0; i < faulty.size(); ++i)
    EXPECT_TRUE(peer.wait([&] {
      const std::uint64_t before = bridge->counts().malformed;
      peer.send(reliable, faulty[i]);
      advance();
      return bridge->counts().malformed > before;
    })) << i;
  EXPECT_TRUE(turns(plain, encode_twist(0.0, 0.0, 0.25), 0.25)) << "commands to others still arrive";
}

TEST_F(Ros2Test, APausedRunSimulatesTheStepsRequestedByAService) {
  Client set(peer, cyclone, "set_simulation_state", "simulation_interfaces::srv::dds_::SetSimulationState");
  Client step(peer, cyclone, "step_simulation", "simulation_interfaces::srv::dds_::StepSimulation");
  ASSERT_TRUE(set.connect({9}, [&] { advance(); })) << "an unknown state, which is refused";
  ASSERT_TRUE(step.connect({1, 0, 0, 0, 0, 0, 0, 0}, [&] { advance(); })) << "not paused, which is refused";

  set.call({2});
  ASSERT_TRUE(run_paused_until([&] { return set.reply().has_value(); }));
  EXPECT_EQ(set.reply()->code, 1) << set.reply()->message;

  const int before = ticks;
  step.call({3, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_TRUE(run_paused_until([&] { return step.reply().has_value(); }));
  EXPECT_EQ(step.reply()->code, 1) << step.reply()->message;
  EXPECT_EQ(ticks, before + 3);

  set.call({2});
  ASSERT_TRUE(run_paused_until([&] { return set.reply().has_value(); }));
  EXPECT_EQ(set.reply()->code, 101) << "paused already";
}

TEST_F(Ros2Test, StandardServicesPauseAndRestart) {
  Client pause(peer, cyclone, "sensorfarm/pause", "std_srvs::srv::dds_::SetBool");
  Client reset(peer, cyclone, "sensorfarm/reset", "std_srvs::srv::dds_::Trigger");
  ASSERT_TRUE(pause.connect({0}, [&] { advance(); }));
  ASSERT_TRUE(reset.connect({0}, [&] { advance(); }));
  ASSERT_TRUE(run_until([&] { return reset.reply().has_value(); })) << "all those of before, too";
  EXPECT_EQ(reset.reply()->code, 1);
  EXPECT_GE(users.resets(), 1u);

  pause.call({1});
  ASSERT_TRUE(run_paused_until([&] { return pause.reply().has_value(); }));
  EXPECT_EQ(pause.reply()->code, 1);
  const std::uint32_t resets = users.resets();
  reset.call({0});
  ASSERT_TRUE(run_paused_until([&] { return reset.reply().has_value(); }));
  EXPECT_EQ(users.resets(), resets + 1);
}

TEST_F(Ros2Test, AServicePlacesARobot) {
  const std::size_t odometry = peer.subscribe("rt/scout/ground_truth/odom", kOdometry);
  Client place(peer, cyclone, "set_entity_state", "simulation_interfaces::srv::dds_::SetEntityState");
  ASSERT_TRUE(peer.wait([&] { return place.known() && peer.matched_reader(odometry); }));
  EXPECT_TRUE(peer.wait([&] {
    cyclone.send(place.requests, encode_set_pose(17, ++place.calls, "scout", 2.5, -3.0, 1.0));
    advance();
    for (const base::Bytes& message : peer.messages(odometry)) {
      const auto pose = decode_odometry(message);
      if (pose && std::hypot(pose->pose.position[0] - 2.5, pose->pose.position[1] + 3.0) < 0.2) return true;
    }
    return false;
  }));
  ASSERT_TRUE(run_until([&] { return place.reply().has_value(); }));
  EXPECT_EQ(place.reply()->code, 1) << place.reply()->message;
}

/// Returns fields of a request, of which the first ones are the caller's two numbers.
std::vector<std::uint8_t> fields_of(const std::function<void(record::CdrWriter&)>& put) {
  base::Bytes bytes;
  record::CdrWriter cdr(bytes);
  put(cdr);
  return {bytes.begin() + 4, bytes.end()};
}

/// A robot that joins has its own topics and accepts commands; one that leaves is silent.
TEST_F(Ros2Test, ServicesAddAndRemoveRobots) {
  users.on_fleet_changes([&](const auto& joining, const auto& leaving) {
    for (const bridges::Leaving& each : leaving) simulation.remove_robot(each.mover), each.outcome->done = true;
    for (const bridges::Joining& each : joining) try {
        each.outcome->done = true;
        simulation.add_robot(world, {.name = each.name, .like = each.like, .X_WM = each.X_WM});
      } catch (const base::InputError& error) {  // it was requested more than once before it joined
        each.outcome->fault = bridges::Outcome::Fault::failed;
      }
    sensor_set = sensors::SensorSet(world);
    info = info_of_run();
    all.show_scene(false);
  });
  Client spawn(peer, cyclone, "spawn_entity", "simulation_interfaces::srv::dds_::SpawnEntity");
  const auto request = fields_of([](record::CdrWriter& cdr) {
    cdr.put("late");
    cdr.put(false);
    cdr.put("scout");
    cdr.put("");
    cdr.put("");
    record::put_header(cdr, 0, "world");
    for (const double value : {2.0, -2.0, 0.0, 0.0, 0.0, 0.0, 1.0}) cdr.put(value);
  });
  ASSERT_TRUE(spawn.connect(request, [&] { advance(); }));
  ASSERT_TRUE(run_until([&] { return spawn.reply().has_value(); }));
  EXPECT_EQ(world.movers.size(), 3u);
  const std::size_t scans = peer.subscribe("rt/late/scan", kScan);
  const std::size_t odometry = peer.subscribe("rt/late/odom", kOdometry);
  const std::size_t drive = peer.advertise("rt/late/cmd_vel", "geometry_msgs::msg::dds_::Twist_");
  EXPECT_TRUE(run_until([&] { return !peer.messages(scans).empty(); }));
  EXPECT_TRUE(peer.wait([&] {
    peer.send(drive, encode_twist(0.0, 0.0, 0.5));
    advance();
    const auto messages = peer.messages(odometry);
    const auto last = messages.empty() ? std::nullopt : decode_odometry(messages.back());
    return last && std::abs(last->velocity[5] - 0.5) < 1e-9;
  }));

  Client remove(peer, cyclone, "delete_entity", "simulation_interfaces::srv::dds_::DeleteEntity");
  ASSERT_TRUE(remove.connect(fields_of([](record::CdrWriter& cdr) { cdr.put("late"); }), [&] { advance(); }));
  EXPECT_TRUE(simulation.is_absent(2));
}

/// Feedback after each step, then the result.
TEST_F(Ros2Test, AnActionSimulatesSteps) {
  Client set(peer, cyclone, "set_simulation_state", "simulation_interfaces::srv::dds_::SetSimulationState");
  Client send(peer, cyclone, "simulate_steps/_action/send_goal",
              "simulation_interfaces::action::dds_::SimulateSteps_SendGoal");
  Client get(peer, cyclone, "simulate_steps/_action/get_result",
             "simulation_interfaces::action::dds_::SimulateSteps_GetResult");
  const std::size_t feedback = peer.subscribe("rt/simulate_steps/_action/feedback",
                                              "simulation_interfaces::action::dds_::SimulateSteps_FeedbackMessage_");
  ASSERT_TRUE(set.connect({9}, [&] { advance(); }));
  ASSERT_TRUE(peer.wait([&] { return send.known() && get.known() && peer.matched_reader(feedback); }));
  set.call({2});
  ASSERT_TRUE(run_paused_until([&] { return set.reply().has_value(); }));
  const int before = ticks;
  std::vector<std::uint8_t> goal(16, 7);
  get.call(goal);  // not discovered yet: answered immediately, or after the goal
  goal.insert(goal.end(), {3, 0, 0, 0, 0, 0, 0, 0});
  send.call(goal);
  ASSERT_TRUE(run_paused_until([&] { return peer.messages(feedback).size() >= 3; }));
  EXPECT_EQ(ticks, before + 3);
  get.call(std::vector<std::uint8_t>(16, 7));
  ASSERT_TRUE(run_paused_until([&] { return get.reply().has_value(); }));
  EXPECT_EQ(get.reply()->code, 4) << "succeeded";
}

}  // namespace
}  // namespace sf::ros2
