// Worlds on a device have the bytes of those of Simulation.

#include "sensorfarm/device_worlds.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "sensorfarm/simulation.h"
#include "tests/refusal.h"

namespace sensorfarm {
namespace {

constexpr std::uint32_t kCopies = 3;
const ObservationOptions kSeen{.every = 4, .goal_reach = 2.0};

/// Returns a small room with a crate that may be missing. @param robot further keys of the robot
std::string room(const std::string& laser = "noise [0.01 0.02 0]", const std::string& robot = "",
                 const std::string& crate = "") {
  return "define wall model( size [3 0.2 1] )"
         "wall( pose [0 1.5 0 0] ) wall( pose [0 -1.5 0 0] ) wall( pose [1.5 0 0 90] ) wall( pose [-1.5 0 0 90] )"
         "model( name \"crate\" size [0.5 0.8 1] pose [0.5 0 0 0] random_pose [0.3 0.3 90] random_present 0.6 " +
         crate +
         ")"
         "position( name \"bot\" size [0.3 0.3 0.2] pose [-1 -1 0 0] drive \"diff\" random_noise 0.5 " +
         robot + " laser( samples 31 fov 180 range_max 2.5 range_min 0.3 " + laser + " ) )";
}

template <class Row>
void expect_bytes(std::span<const Row> device, std::span<const Row> host, const std::string& what) {
  ASSERT_EQ(device.size(), host.size()) << what;
  EXPECT_EQ(std::memcmp(device.data(), host.data(), host.size_bytes()), 0) << what;
}

/// The same worlds on a device and by Simulation.
class Twin {
 public:
  explicit Twin(std::uint32_t robots, const ObservationOptions& seen = kSeen)
      : Twin(Options{.robots = robots, .seed = 5, .copies = kCopies}, seen) {}
  explicit Twin(const Options& options, const ObservationOptions& seen = kSeen)
      : device_(DeviceWorlds::from_text(room(), options)),
        host_(Simulation::from_text(room(), options)),
        seen_(host_.observe(seen)) {
    device_.observe(seen);
  }

  void step() {
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::vector<Twist> commands(host_.size());
    for (Twist& command : commands) command = {0.3 + any(random_), 0.0, 2.0 * any(random_)};
    device_.step(commands), host_.step(commands);
  }
  void reset(const std::vector<std::uint32_t>& worlds, const std::vector<std::uint64_t>& seeds,
             const WorldStarts& starts = {}) {
    device_.reset(worlds, seeds, starts), host_.reset(worlds, seeds, starts);
  }
  /// New goals for all agents, but none for the first.
  void set_goals() {
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (double& goal : seen_.goals()) goal = any(random_);
    seen_.goals()[0] = NAN;
    device_.set_goals(seen_.goals());
    seen_.update();
  }
  void compare(const std::string& when) {
    const Readings own = device_.readings(), expected = host_.readings("laser");
    ASSERT_EQ(own.sensors, expected.sensors);
    ASSERT_EQ(own.elements, expected.elements);
    expect_bytes(own.robots, expected.robots, when);
    for (std::size_t i = 0; i < own.sensors; ++i) {
      expect_bytes(own.row(i), expected.row(i), "readings of laser " + std::to_string(i) + when);
      for (const double range : own.row(i)) echoes_ += range < 2.5;
    }
    expect_bytes(device_.observations(), seen_.values(), "observations" + when);
    for (std::size_t i = 0; i < seen_.agents(); ++i) {
      const double own_distance = device_.distances()[i], distance = seen_.distances()[i];
      EXPECT_TRUE(own_distance == distance || (std::isnan(own_distance) && std::isnan(distance))) << when;
      EXPECT_EQ(device_.progress()[i], seen_.progress()[i]) << "agent " << i << when;
      if (seen_.progress()[i] != 0.0) ++progressed_;
    }
    expect_bytes(device_.poses(), host_.poses(), "poses" + when);
    expect_bytes(device_.velocities(), host_.velocities(), "velocities" + when);
    expect_bytes(device_.contacts(), host_.contacts(), "contacts" + when);
    for (const std::uint8_t contact : device_.contacts()) contacts_ += contact;
  }
  std::size_t echoes() const { return echoes_; }
  std::size_t contacts() const { return contacts_; }
  std::size_t progressed() const { return progressed_; }

 private:
  DeviceWorlds device_;
  Simulation host_;
  Observations seen_;
  std::mt19937_64 random_{1};
  std::size_t echoes_ = 0, contacts_ = 0, progressed_ = 0;
};

/// Compares 100 ticks with restarts: two without a reading between them, then a step before any reading.
void compare_hundred_ticks(std::uint32_t robots, const ObservationOptions& seen = kSeen) {
  Twin twin(robots, seen);
  twin.compare(" at the start");
  for (int tick = 1; tick <= 100 && !testing::Test::HasFatalFailure(); ++tick) {
    twin.step();
    if (tick > 40 && tick < 50) continue;  // nothing is read
    if (tick % 25 == 5) twin.set_goals();
    if (tick != 70) twin.compare(" in tick " + std::to_string(tick));
    if (tick == 30) twin.reset({1}, {77}), twin.reset({2, 1}, {8, 9}), twin.compare(" at a restart");
    if (tick == 60 || tick == 70) twin.reset({0}, {static_cast<std::uint64_t>(tick)});
  }
  EXPECT_GT(twin.echoes(), 1'000u);
  EXPECT_GT(twin.contacts(), 20u);
  EXPECT_GT(twin.progressed(), 100u);
}

TEST(DeviceWorlds, BytesOfSimulationForOneRobotPerWorld) { compare_hundred_ticks(1); }
TEST(DeviceWorlds, BytesOfSimulationForSeveralRobotsPerWorld) { compare_hundred_ticks(3); }

// Steps without a reading must shift the stack, restarts fill it, and new goals change its newest observation alone.
TEST(DeviceWorlds, BytesOfSimulationForStacks) {
  compare_hundred_ticks(2, {.every = 4, .goal_reach = 2.0, .stack = 3});
  compare_hundred_ticks(1, {.every = 31, .speeds = false, .stack = 2});  // a beam alone
}

// A crate and a robot of three are given, one absent; NaN leaves the others to the seed. Noise is that of the start.
TEST(DeviceWorlds, BytesOfSimulationForGivenStarts) {
  Twin twin(2);
  const double none = NAN;
  const Pose any{none, 0.0, 0.0, 0.0};
  const std::vector<Pose> poses{{-0.8, 0.7, 0.0, 2.0}, any, {0.9, 0.9, 0.1, 0.3}, any, {0.1, -1.0, 0.0, -7.0}, any};
  const std::vector<double> present{none, none, 1.0, none, none, 0.0}, noise{0.0, none, none, 1.0, 0.25, none};
  twin.step();
  twin.reset({2, 0}, {7, 8}, {.poses = poses, .present = present, .noise = noise});
  for (int tick = 0; tick < 10 && !HasFatalFailure(); ++tick) {
    twin.compare(" after given starts, tick " + std::to_string(tick));
    twin.step();
  }
  EXPECT_GT(twin.echoes(), 100u);
}

TEST(DeviceWorlds, WithoutNoiseAndOneWorld) {
  Twin twin({.noise = false});
  for (int tick = 0; tick < 3; ++tick) twin.step(), twin.compare(" without noise");
}

std::string refused(const std::string& world, const Options& options = {}) {
  return sf::refusal_of<Error>([&] { DeviceWorlds::from_text(world, options); });
}

TEST(DeviceWorlds, RefusesWhatOnlySimulationHas) {
  const std::string end = "; use Simulation with copies (in Python: Worlds)";
  const auto expect = [&](const std::string& what, const std::string& message) {
    sf::expect_in(what, message);
    sf::expect_in(end, message);
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  EXPECT_EQ(refused(room()), "");
  expect("do not support the option 'faults'", refused(room(), {.faults = "[[fault]]"}));
  expect("the option 'record'", refused(room(), {.record = "run"}));
  expect("the option 'controller'", refused(room(), {.controller = "wander"}));
  expect("the controller 'wander' of 'bot'", refused(room("", "ctrl \"wander\"")));
  EXPECT_EQ(refused(room("", "ctrl \"wander\""), {.controller = "none"}), "");
  expect("sensors of type 'gyro'", refused(room("", "gyro()")));
  expect("angular noise", refused(room("noise [0 0 0.1]")));
  expect("between its beams", refused(room("resolution 2")));
  expect("between its beams", refused(room(), {.accuracy = "skip2"}));
  expect("measures in 32 bits", refused(room(), {.accuracy = "single"}));
  expect("rate of 5 Hz", refused(room("rate 5")));
  expect("phase of 0.02 s", refused(room("phase 0.02")));
  expect("the random slip or acceleration of 'bot'", refused(room("", "random_slip 0.2")));
  expect("the random size of 'crate'", refused(room("", "", "random_size [0.1 0.1 0]")));
}

TEST(DeviceWorlds, RefusesTheHost) {
  const auto message = sf::refusal_of<DeviceError>([] { DeviceWorlds::from_text(room(), {.device = "host"}); });
  sf::expect_in("a Vulkan device is required", message);
}

TEST(DeviceWorlds, RefusesBadCallsAndGoesOn) {
  DeviceWorlds worlds = DeviceWorlds::from_text(room(), {.copies = 2});
  const auto step = [&](std::vector<Twist> commands) { return sf::refusal_of<Error>([&] { worlds.step(commands); }); };
  const auto reset = [&](std::vector<std::uint32_t> which, std::vector<std::uint64_t> seeds) {
    return sf::refusal_of<Error>([&] { worlds.reset(which, seeds); });
  };
  EXPECT_EQ(step(std::vector<Twist>(2)), "2 commands for 4 rows; expected one per row");
  sf::expect_in("expected finite numbers", step(std::vector<Twist>(4, {NAN, 0.0, 0.0})));
  sf::expect_in("there is no world 2", reset({2}, {1}));
  sf::expect_in("given twice", reset({1, 1}, {1, 2}));
  sf::expect_in("1 seeds for 2 worlds", reset({0, 1}, {1}));
  const std::vector<Pose> before(worlds.poses().begin(), worlds.poses().end());
  const auto given = [&](const WorldStarts& starts) {
    return sf::refusal_of<Error>([&] { worlds.reset(std::vector{0u}, std::vector<std::uint64_t>{3}, starts); });
  };
  const std::vector<Pose> far{{0.0, 0.0, 0.0, 1.1e4}, {NAN, 0.0, 0.0, 0.0}}, short_{{NAN, 0.0, 0.0, 0.0}};
  const std::vector<std::array<double, 3>> sizes{{0.5, 0.5, 0.5}, {NAN, 0.0, 0.0}};
  const std::vector<double> slip{NAN, 0.1}, missing{NAN, 0.0};
  sf::expect_in("do not support starts with a yaw beyond 10000 rad; use Simulation", given({.poses = far}));
  sf::expect_in("do not support starts with sizes", given({.sizes = sizes}));
  sf::expect_in("do not support starts with slip or acceleration", given({.slip = slip}));
  sf::expect_in("1 starts for 2 rows", given({.poses = short_}));
  sf::expect_in("is a robot, and cannot be missing", given({.present = missing}));
  expect_bytes(worlds.poses(), std::span<const Pose>(before), "poses after refused resets");
  const auto observe = [&](const ObservationOptions& options) {
    return sf::refusal_of<Error>([&] { worlds.observe(options); });
  };
  const auto set_goals = [&](std::vector<double> goals) {
    return sf::refusal_of<Error>([&] { worlds.set_goals(goals); });
  };
  sf::expect_in("call observe first", set_goals({}));
  sf::expect_in("call observe first", sf::refusal_of<Error>([&] { worlds.observations(); }));
  sf::expect_in("stack is 0", observe({.stack = 0}));
  sf::expect_in("expected 'laser'", observe({.sensor = "sonar"}));
  sf::expect_in("every is 0", observe({.every = 0}));
  EXPECT_EQ(observe({}), "");
  sf::expect_in("2 numbers for the goals of 2 agents", set_goals({1.0, 2.0}));
  sf::expect_in("infinite", set_goals({1.0, 2.0, 3.0, HUGE_VAL}));
  EXPECT_EQ(worlds.columns(), 33u);
  EXPECT_EQ(step({}), "");
}

}  // namespace
}  // namespace sensorfarm
