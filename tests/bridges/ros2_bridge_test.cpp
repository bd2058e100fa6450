// The ROS 2 node without a network: a participant that stores written messages and delivers messages of the test.

#include "bridges/ros2_bridge.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdlib>
#include <random>
#include <set>

#include "base/error.h"
#include "record/cdr.h"

namespace sf::bridges {
namespace {

/// Data exchanged with the participant of a bridge. One bridge at a time.
struct Network {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<DdsEndpoint> writers, readers;
  std::vector<std::pair<std::size_t, base::Bytes>> written;
  std::function<void(DdsMessage&&)> receive;
  std::set<std::size_t> read;  ///< writers that have readers
  bool blocked = false;        ///< writes block until it is false
  bool behind = false;         ///< readers are behind

  std::size_t writer(const std::string& topic) const {
    for (std::size_t i = 0; i < writers.size(); ++i)
      if (writers[i].topic == topic) return i;
    return writers.size();
  }
  std::size_t reader(const std::string& topic) const {
    for (std::size_t i = 0; i < readers.size(); ++i)
      if (readers[i].topic == topic) return i;
    return readers.size();
  }
  /// Returns the messages of a writer, once there are `count`.
  std::vector<base::Bytes> wait(std::size_t of, std::size_t count) {
    std::vector<base::Bytes> found;
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::minutes(1), [&] {
      found.clear();
      for (const auto& [writer, bytes] : written)
        if (writer == of) found.push_back(bytes);
      return found.size() >= count;
    });
    return found;
  }
};

struct FakeParticipant : DdsParticipant {
  explicit FakeParticipant(Network& of) : network(of) {}
  DdsGuid guid() const override { return {1, 2, 3}; }
  std::size_t add_writer(const DdsEndpoint& endpoint, DdsGuid&) override {
    network.writers.push_back(endpoint);
    return network.writers.size() - 1;
  }
  std::size_t add_reader(const DdsEndpoint& endpoint, DdsGuid&) override {
    network.readers.push_back(endpoint);
    return network.readers.size() - 1;
  }
  bool write(std::size_t writer, const base::Bytes& message) override {
    std::unique_lock lock(network.mutex);
    network.changed.wait(lock, [&] { return !network.blocked; });
    if (network.behind) return false;
    network.written.emplace_back(writer, message);
    network.changed.notify_all();
    return true;
  }
  std::size_t count_readers(std::size_t writer) const override { return network.read.count(writer); }
  bool can_answer(std::size_t, std::size_t, std::uint64_t sender) const override { return sender != 404; }
  Network& network;
};

Network* network_of_test = nullptr;
const DdsLibrary kFake{[](const DdsOptions& options) -> std::unique_ptr<DdsParticipant> {
  network_of_test->receive = options.receive;
  return std::make_unique<FakeParticipant>(*network_of_test);
}};

/// The process with Fast DDS; null: it is not installed.
struct FakeFast {
  FastOptions options;
  std::vector<DdsReply> replies;
};
FakeFast* fast_of_test = nullptr;

struct FakeFastServices : FastServices {
  explicit FakeFastServices(FakeFast& of) : fast(of) {}
  void add(DdsReply&& reply) override { fast.replies.push_back(std::move(reply)); }
  DdsOutbox::Counts counts() const override { return {}; }
  FakeFast& fast;
};
std::unique_ptr<FastServices> fake_fast(const FastOptions& options) {
  if (fast_of_test == nullptr) throw std::runtime_error("it is not installed");
  fast_of_test->options = options;
  return std::make_unique<FakeFastServices>(*fast_of_test);
}

world::World two_robots() {
  world::World world;
  world.movers.resize(3);
  world.movers[0].X_WM = {1.0, 2.0, 0.1, 0.5};
  world.movers[1].X_WM = base::kAbsent;
  world.movers[2].is_tag = true;
  return world;
}

record::RunInfo info_of_two() {
  record::RunInfo info;
  info.record_readings = true;
  info.odometry_rate = 10.0;
  info.movers = {{"scout", "", 1, {}, {}}, {"robot 2", "", 2, {}, {}}, {"tag", "", 3, {}, {}}};
  record::name_frames(info);
  return info;
}

struct Ros2BridgeTest : testing::Test {
  Ros2BridgeTest() { network_of_test = &network; }
  /// Publishes the tick of an action expected from a test's bridge.
  void publish(bool paused = false, std::uint32_t runs = 0) {
    std::vector<base::Report> reports;
    for (std::uint32_t mover = 0; mover < 3; ++mover) reports.push_back({mover, time, world.movers[mover].X_WM, {}});
    base::TickRecord tick;
    tick.time = time += 100'000'000;
    tick.reports = reports;
    tick.commands = commands;
    bridge->publish(tick, {.paused = paused, .runs = runs});
  }
  void open(bool simulated = true) {
    bridge.emplace(Ros2Options{7, true}, Scene{world, sensor_set, info, simulated}, kFake, fake_fast);
  }
  /// Returns a request in the format of rmw_cyclonedds.
  /// @param body appends the request's fields
  base::Bytes request(std::int64_t sequence, const std::function<void(record::CdrWriter&)>& body) {
    base::Bytes bytes;
    record::CdrWriter cdr(bytes);
    cdr.put(std::uint64_t{17});
    cdr.put(sequence);
    body(cdr);
    return bytes;
  }
  void send(const std::string& topic, base::Bytes bytes, std::uint64_t sender = 1) {
    network.receive({network.reader(topic), sender, std::move(bytes)});
  }
  Requests take() {
    Requests requests;
    bridge->take(requests);
    return requests;
  }
  /// Returns code and text of a service's answers so far, once there are `count`.
  std::vector<std::pair<int, std::string>> answers(const std::string& name, std::size_t count) {
    std::vector<std::pair<int, std::string>> all;
    for (const base::Bytes& bytes : network.wait(network.writer("rr/" + name + "Reply"), count)) {
      record::CdrReader cdr(bytes);
      EXPECT_EQ(cdr.get<std::uint64_t>(), 17u);
      cdr.get<std::int64_t>();
      const int code = cdr.get<std::uint8_t>();
      all.emplace_back(code, cdr.get_string());
      EXPECT_TRUE(cdr.good());
    }
    return all;
  }

  Network network;
  const world::World world = two_robots();
  const sensors::SensorSet sensor_set{world};
  const record::RunInfo info = info_of_two();
  const std::vector<base::Twist> commands{3};
  std::optional<Ros2Bridge> bridge;
  std::int64_t time = 0;
};

const auto kNothing = [](record::CdrWriter&) {};

TEST_F(Ros2BridgeTest, NamesTopicsAsRos2Does) {
  open();
  EXPECT_LT(network.writer("rt/robot_2/odom"), network.writers.size());
  EXPECT_TRUE(network.writers[network.writer("rt/tf_static")].latched);
  EXPECT_FALSE(network.writers[network.writer("rt/clock")].latched);
  EXPECT_EQ(network.writer("rt/scout/cmd_vel"), network.writers.size()) << "commands are received there";
  EXPECT_LT(network.reader("rt/scout/cmd_vel"), network.readers.size());
  EXPECT_EQ(network.reader("rt/tag/cmd_vel"), network.readers.size()) << "tags are not driven";
  EXPECT_EQ(bridge->describe(),
            "ROS 2: node /sensorfarm in domain 7, on this machine; services do not answer rmw_fastrtps clients: it is "
            "not installed");
}

TEST_F(Ros2BridgeTest, AServiceIsReadOnly) {
  open(false);
  EXPECT_EQ(network.reader("rt/scout/cmd_vel"), network.readers.size());
  EXPECT_EQ(network.reader("rq/step_simulationRequest"), network.readers.size());
  send("rq/get_simulation_stateRequest", request(1, kNothing));
  take();
  EXPECT_EQ(answers("get_simulation_state", 1).size(), 1u);
}

TEST_F(Ros2BridgeTest, OnlyTopicsWithReadersAreWritten) {
  open();
  const std::size_t clock = network.writer("rt/clock"), odometry = network.writer("rt/scout/odom");
  network.read = {clock};
  publish();
  ASSERT_EQ(network.wait(clock, 1).size(), 1u);
  network.read = {clock, odometry};
  publish();
  EXPECT_EQ(network.wait(clock, 2).size(), 2u);
  EXPECT_EQ(network.wait(odometry, 1).size(), 1u);
}

/// A latched topic is written once.
TEST_F(Ros2BridgeTest, CommandsAreWrittenToNoTopic) {
  open();
  const std::size_t clock = network.writer("rt/clock");
  for (std::size_t writer = 0; writer < network.writers.size(); ++writer) network.read.insert(writer);
  for (int i = 0; i < 2; ++i) publish();
  ASSERT_EQ(network.wait(clock, 2).size(), 2u) << "the tick before is written";
  const std::size_t run = network.writer("rt/run");
  ASSERT_TRUE(network.writers[run].latched);
  EXPECT_EQ(network.wait(run, 1).size(), 1u);
}

TEST_F(Ros2BridgeTest, AStuckReaderDelaysNoTick) {
  open();
  const std::size_t clock = network.writer("rt/clock");
  network.wait(network.writer("rt/tf_static"), 1);
  network.read = {clock};
  {
    const std::lock_guard lock(network.mutex);
    network.blocked = true;
  }
  for (int i = 0; i < 100; ++i) publish();  // would never end if one of them blocked
  EXPECT_GE(bridge->counts().sent.ticks_left_out, 100 - DdsOutbox::kMaxTicks - 1);
  {
    const std::lock_guard lock(network.mutex);
    network.blocked = false;
  }
  network.changed.notify_all();
  const auto clocks = network.wait(clock, DdsOutbox::kMaxTicks);
  record::CdrReader last(clocks.back());
  EXPECT_EQ(last.get<std::int32_t>(), 10) << "the newest tick, of 10 s, is there";
}

TEST_F(Ros2BridgeTest, ReadersThatAreBehindAreSkipped) {
  open();
  network.wait(network.writer("rt/tf_static"), 1);
  network.behind = true;
  network.read = {network.writer("rt/clock")};
  publish();
  while (bridge->counts().sent.left_out == 0) std::this_thread::yield();
  EXPECT_EQ(bridge->counts().sent.ticks_left_out, 0u);
}

TEST_F(Ros2BridgeTest, CommandsNameTheirRobot) {
  open();
  base::Bytes bytes;
  record::encode_twist(5, "base_link", {0.5, 0.25, -1.0}, bytes);
  const std::size_t stamped = network.reader("rt/robot_2/cmd_vel") + 1;
  EXPECT_EQ(network.readers[stamped].type, "geometry_msgs::msg::dds_::TwistStamped_");
  network.receive({stamped, 1, bytes});
  const Requests requests = take();
  ASSERT_EQ(requests.commands.size(), 1u);
  EXPECT_EQ(requests.commands[0].mover, 1u);
  EXPECT_EQ(requests.commands[0].twist.forward, 0.5);
  EXPECT_EQ(requests.commands[0].twist.left, 0.25);
  EXPECT_EQ(requests.commands[0].twist.turn, -1.0);
}

TEST_F(Ros2BridgeTest, APauseIsAnsweredOnceTheRunIsPaused) {
  open();
  publish();
  send("rq/sensorfarm/pauseRequest", request(1, [](record::CdrWriter& cdr) { cdr.put(true); }));
  const Requests requests = take();
  ASSERT_TRUE(requests.paused && *requests.paused);
  bridge->publish(RunState{.paused = true});
  const auto done = answers("sensorfarm/pause", 1);
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].first, 1);
}

TEST_F(Ros2BridgeTest, StepsAreAnsweredOnceTheyAreDone) {
  open();
  publish(true);
  for (std::int64_t call = 1; call <= 2; ++call)
    send("rq/step_simulationRequest", request(call, [](record::CdrWriter& cdr) { cdr.put(std::uint64_t{2}); }));
  EXPECT_EQ(take().steps, 4u);
  publish(true);
  bridge->publish(RunState{.paused = true});  // an update of a paused run is not a tick
  EXPECT_EQ(take().steps, 0u);
  publish(true);
  ASSERT_EQ(answers("step_simulation", 1).size(), 1u) << "the second call's ticks come after the first one's";
  publish(true);
  publish(true);
  EXPECT_EQ(answers("step_simulation", 2).size(), 2u);
}

TEST_F(Ros2BridgeTest, StepsOfAnUnpausedRunAreRefused) {
  open();
  publish(false);
  send("rq/step_simulationRequest", request(1, [](record::CdrWriter& cdr) { cdr.put(std::uint64_t{1}); }));
  EXPECT_EQ(take().steps, 0u);
  publish(true);
  for (const std::uint64_t steps : {std::uint64_t{0}, std::uint64_t{RosServices::kMaxSteps} + 1, ~std::uint64_t{0}})
    send("rq/step_simulationRequest", request(2, [&](record::CdrWriter& cdr) { cdr.put(steps); }));
  EXPECT_EQ(take().steps, 0u);
  for (const auto& [code, text] : answers("step_simulation", 4)) EXPECT_EQ(code, 4) << text;
}

TEST_F(Ros2BridgeTest, AResetIsAnsweredOnceTheRunHasRestarted) {
  open();
  publish();
  const auto resets = [&](int scope) {
    send("rq/reset_simulationRequest",
         request(1, [&](record::CdrWriter& cdr) { cdr.put(static_cast<std::uint8_t>(scope)); }));
    return take().reset;
  };
  for (const int scope : {1, 4}) EXPECT_FALSE(resets(scope)) << "time alone, and spawned robots alone";
  for (const int scope : {0, 3, 7, 255}) EXPECT_TRUE(resets(scope)) << scope;
  EXPECT_EQ(answers("reset_simulation", 2),
            (std::vector<std::pair<int, std::string>>(
                2, {0, "time and state can only be reset together: scope 0, 3, 7 or 255"})));
  time = -100'000'000;
  publish(false, 1);
  EXPECT_EQ(answers("reset_simulation", 6).size(), 6u);
}

TEST_F(Ros2BridgeTest, AStoppedRunIsPausedAtItsStart) {
  open();
  publish();
  const auto state = [&](std::uint8_t wanted) {
    send("rq/set_simulation_stateRequest", request(1, [&](record::CdrWriter& cdr) { cdr.put(wanted); }));
    return take();
  };
  const Requests requests = state(0);
  EXPECT_TRUE(requests.reset && requests.paused && *requests.paused);
  bridge->publish(RunState{.paused = true, .runs = 1});
  EXPECT_EQ(answers("set_simulation_state", 1).back().first, 1);
  state(0);
  EXPECT_EQ(answers("set_simulation_state", 2).back().first, 101) << "stopped already";
  state(2);
  EXPECT_EQ(answers("set_simulation_state", 3).back().first, 1) << "stopped, now paused";
  state(3);
  EXPECT_EQ(answers("set_simulation_state", 4).back().first, 0) << "a run does not quit for others";
}

TEST_F(Ros2BridgeTest, EntitiesAreThePresentRobots) {
  open();
  const auto names = [&](const std::string& filter) {
    const auto writer = network.writer("rr/get_entitiesReply");
    const std::size_t before = network.wait(writer, 0).size();
    send("rq/get_entitiesRequest", request(1, [&](record::CdrWriter& cdr) {
           cdr.put(filter);
           cdr.put_count(0);
           cdr.put_count(0);
           cdr.put(std::uint8_t{0});
           cdr.put(std::uint8_t{0});
           cdr.put_count(0);
         }));
    take();
    const base::Bytes bytes = network.wait(writer, before + 1).back();
    record::CdrReader cdr(bytes);
    cdr.get<std::uint64_t>();
    cdr.get<std::uint64_t>();
    std::string all = std::to_string(cdr.get<std::uint8_t>());
    cdr.get_string();
    for (std::uint32_t left = cdr.get_count(5); left > 0; --left) all += " " + cdr.get_string();
    return all;
  };
  EXPECT_EQ(names(""), "1 scout tag");
  EXPECT_EQ(names("^sc.*t$"), "1 scout");
  EXPECT_EQ(names("a"), "1 tag");
  EXPECT_EQ(names("^a"), "1");
  EXPECT_EQ(names(".*"), "1 scout tag");
  EXPECT_EQ(names("(a+)+"), "0") << "expressions that take long are refused";
  EXPECT_EQ(names(std::string(300, 'a')), "0");
}

/// Returns a SetEntityState.
/// @param values position, rotation
base::Bytes placement(const std::string& name, const std::string& frame, const std::vector<double>& values,
                      const std::vector<bool>& flags) {
  base::Bytes bytes;
  record::CdrWriter cdr(bytes);
  cdr.put(std::uint64_t{17});
  cdr.put(std::int64_t{1});
  cdr.put(name);
  record::put_header(cdr, 0, frame);
  for (const double value : values) cdr.put(value);
  for (int i = 0; i < 12; ++i) cdr.put(0.0);
  for (const bool flag : flags) cdr.put(flag);
  return bytes;
}

TEST_F(Ros2BridgeTest, RobotsArePlacedAtValidPoses) {
  open();
  const std::vector<double> pose{3.0, -4.0, 9.0, 0.0, 0.0, std::sin(0.5), std::cos(0.5)};
  std::vector<double> longer = pose, infinite = pose, far = pose, zero = pose;
  longer[3] = 0.5, infinite[0] = INFINITY, far[1] = 1e300, zero[6] = zero[5] = 0.0;
  struct Case {
    base::Bytes request;
    int code;
  };
  const std::vector<bool> flags{true, false, false};
  const std::vector<Case> cases{{placement("scout", "", pose, flags), 1},
                                {placement("scout", "world", pose, {}), 1},  // version 1.0 has no flags
                                {placement("scout", "map", pose, flags), 0},
                                {placement("scout", "", pose, {true, true, false}), 0},
                                {placement("missing", "", pose, flags), 2},
                                {placement("robot_2", "", pose, flags), 2},  // absent
                                {placement("scout", "", longer, flags), 101},
                                {placement("scout", "", infinite, flags), 101},
                                {placement("scout", "", far, flags), 101},
                                {placement("scout", "", zero, flags), 101}};
  for (const Case& each : cases) send("rq/set_entity_stateRequest", each.request);
  const Requests requests = take();
  ASSERT_EQ(requests.placements.size(), 2u);
  EXPECT_EQ(requests.placements[0].mover, 0u);
  EXPECT_EQ(requests.placements[0].X_WM.x, 3.0);
  EXPECT_EQ(requests.placements[0].X_WM.y, -4.0);
  EXPECT_EQ(requests.placements[0].X_WM.z, 0.1) << "the height above the floor is unchanged";
  EXPECT_NEAR(requests.placements[0].X_WM.yaw, 1.0, 1e-12);
  const auto done = answers("set_entity_state", cases.size());
  ASSERT_EQ(done.size(), cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) EXPECT_EQ(done[i].first, cases[i].code) << i << done[i].second;
}

/// Clients of Fast DDS are answered by its process, which has the same service endpoints.
TEST_F(Ros2BridgeTest, AnswersAreSentToTheParticipantOfTheirRequest) {
  FakeFast fast;
  fast_of_test = &fast;
  open();
  fast_of_test = nullptr;
  EXPECT_EQ(bridge->describe().find("installed"), std::string::npos) << bridge->describe();
  EXPECT_EQ(fast.options.dds.domain, 7u);
  EXPECT_TRUE(fast.options.dds.loopback);
  std::vector<std::string> expected, found;
  for (const auto* all : {&network.readers, &network.writers})
    for (const DdsEndpoint& one : *all)
      if (one.topic.starts_with("rq/") || one.topic.starts_with("rr/")) expected.push_back(one.topic + " " + one.type);
  for (const FastService& one : fast.options.services) found.push_back(one.requests.topic + " " + one.requests.type);
  for (const FastService& one : fast.options.services) found.push_back(one.replies.topic + " " + one.replies.type);
  EXPECT_EQ(found, expected);

  const std::string topic = "rq/get_simulation_stateRequest", reply = "rr/get_simulation_stateReply";
  const auto& services = fast.options.services;
  const auto service = static_cast<std::size_t>(
      std::find_if(services.begin(), services.end(), [&](const auto& one) { return one.requests.topic == topic; }) -
      services.begin());
  const auto ask = [&](std::uint64_t sender, std::int64_t sequence) {
    DdsMessage message{service, sender, request(sequence, kNothing)};
    message.sender.fast = true;
    fast.options.dds.receive(std::move(message));
  };
  ask(5, 1);
  send(topic, request(2, kNothing));
  ask(6, 3);
  take();
  ASSERT_EQ(fast.replies.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(fast.replies[i].writer, service);
    EXPECT_EQ(fast.replies[i].sender, 5 + i);
    record::CdrReader cdr(fast.replies[i].message);
    cdr.get<std::uint64_t>();
    EXPECT_EQ(cdr.get<std::int64_t>(), static_cast<std::int64_t>(1 + 2 * i));
  }
  EXPECT_EQ(network.wait(network.writer(reply), 1).size(), 1u);
  EXPECT_TRUE(has_request_header({0x01, 0x10})) << "Cyclone DDS";
  for (const DdsGuid& other : {DdsGuid{0x01, 0x0f}, {0x01, 0x01}, {0x10, 0x01}, {}})
    EXPECT_FALSE(has_request_header(other)) << "Fast DDS, Connext, and others";
  bridge.reset();  // before `fast`
}

TEST_F(Ros2BridgeTest, AnAnswerWaitsForItsReaderUpToALimit) {
  open();
  send("rq/get_simulation_stateRequest", request(1, kNothing), 404);  // a client whose reader is never discovered
  take();
  EXPECT_EQ(answers("get_simulation_state", 1).size(), 1u);
}

TEST_F(Ros2BridgeTest, AFloodOfRequestsIsQueuedAndCommandsAreNot) {
  open();
  const std::size_t flood = DdsInbox::kMaxMessages + 5;
  for (std::size_t i = 0; i < flood; ++i) send("rq/get_simulation_stateRequest", request(1, kNothing));
  EXPECT_EQ(bridge->counts().left_out, 5u);
  base::Bytes twist;
  record::CdrWriter cdr(twist);
  for (int i = 0; i < 6; ++i) cdr.put(0.25);
  send("rt/scout/cmd_vel", twist);
  EXPECT_EQ(take().commands.size(), 1u);
  EXPECT_EQ(answers("get_simulation_state", Ros2Bridge::kMaxRequests).size(), Ros2Bridge::kMaxRequests);
  for (std::size_t i = 0; i < flood; ++i) send("rq/get_simulation_stateRequest", request(1, kNothing));
  EXPECT_EQ(bridge->counts().left_out, 10u) << "another inbox is full while the first waits";
}

TEST_F(Ros2BridgeTest, RequestsWaitingForTheRunAreBounded) {
  open();
  for (std::size_t i = 0; i < RosServices::kMaxWaiting + 9; ++i)
    send("rq/sensorfarm/resetRequest", request(1, kNothing));
  for (int i = 0; i < 3; ++i) take();
  EXPECT_EQ(answers("sensorfarm/reset", 9).size(), 9u) << "refused; the others wait";
  publish(false, 1);
  EXPECT_EQ(answers("sensorfarm/reset", RosServices::kMaxWaiting + 9).size(), RosServices::kMaxWaiting + 9);
}

// The run continues for any bytes. Requests are finite and name robots.
TEST_F(Ros2BridgeTest, SurvivesAnyBytes) {
  open();
  publish(true);
  std::vector<base::Bytes> seeds{placement("scout", "world", {1, 2, 0, 0, 0, 0, 1}, {true, false, false})};
  seeds.push_back(request(1, [](record::CdrWriter& cdr) {
    cdr.put("s.*");
    for (int i = 0; i < 3; ++i) cdr.put_count(1);
    cdr.put("tag");
  }));
  base::Bytes twist;
  record::encode_twist(5, "base_link", {0.5, 0.25, -1.0}, twist);
  seeds.push_back(twist);
  std::mt19937 random(1);
  for (int round = 0; round < 4000; ++round) {
    base::Bytes bytes = seeds[random() % seeds.size()];
    for (std::uint32_t changes = random() % 4; changes > 0; --changes)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random() % 3 == 0 ? 255 : random());
    if (random() % 2 == 0) bytes.resize(random() % (bytes.size() + 8));
    network.receive({random() % network.readers.size(), 1, bytes});
    for (const Requests requests = take(); const Placement& each : requests.placements) {
      EXPECT_LT(each.mover, 3u);
      EXPECT_TRUE(std::isfinite(each.X_WM.x + each.X_WM.y + each.X_WM.yaw));
    }
    if (round % 64 == 0) publish(round % 128 == 0, static_cast<std::uint32_t>(round / 64));
  }
  EXPECT_GT(bridge->counts().malformed, 500u);
  EXPECT_LT(bridge->counts().malformed, 4000u);
}

/// External traffic cannot fill the log: of 100 000 lines at once the first are written, then five a second.
TEST(Ros2Bridge, TheLogOfDdsIsLimited) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe2(ends.data(), O_NONBLOCK), 0);
  {
    DdsLog log(ends[1]);
    for (int i = 0; i < 100'000; ++i) log.write("malformed packet received\x1b[2J\n");
  }
  std::string text(1 << 20, '\0');
  const ssize_t size = read(ends[0], text.data(), text.size());
  close(ends[0]), close(ends[1]);
  ASSERT_GT(size, 0);
  text.resize(static_cast<std::size_t>(size));
  EXPECT_EQ(text.find("sensorfarm: DDS: malformed packet received\\x1b[2J\n"), 0u) << text.substr(0, 200);
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 500);
}

TEST(Ros2Options, AreReadAsInRos2Nodes) {
  const auto with = [](const char* variable, const char* value, const std::string& domain) {
    setenv(variable, value, 1);
    const Ros2Options options = ros2_options(domain);
    unsetenv(variable);
    return options;
  };
  EXPECT_EQ(ros2_options("").domain, 0u);
  EXPECT_FALSE(ros2_options("").loopback);
  EXPECT_EQ(ros2_options("232").domain, 232u);
  EXPECT_EQ(with("ROS_DOMAIN_ID", "42", "").domain, 42u);
  EXPECT_EQ(with("ROS_DOMAIN_ID", "42", "5").domain, 5u);
  EXPECT_TRUE(with("ROS_LOCALHOST_ONLY", "1", "").loopback);
  EXPECT_FALSE(with("ROS_LOCALHOST_ONLY", "0", "").loopback);
  EXPECT_TRUE(with("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", "").loopback);
  for (const char* domain : {"233", "-1", "x", "1 "}) EXPECT_THROW(ros2_options(domain), base::InputError) << domain;
  setenv("ROS_DOMAIN_ID", "many", 1);
  EXPECT_THROW(ros2_options(""), base::InputError);
  unsetenv("ROS_DOMAIN_ID");
}

}  // namespace
}  // namespace sf::bridges
