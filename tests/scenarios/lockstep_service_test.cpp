#include "scenarios/lockstep_service.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "control/own_controllers.h"
#include "sensors/laneedge.h"
#include "sensors/laser.h"
#include "sensors/magnetometer.h"
#include "sensors/sensor_type.h"
#include "tests/refusal.h"
#include "tests/scenarios/lockstep_driver.h"
#include "tests/server/fixture.h"
#include "world/free_space.h"

namespace sf::scenarios {
namespace {

constexpr std::uint64_t kSeed = 5;
constexpr int kTicks = 40;

/// A controller whose command depends on all of its inputs, present and past.
struct Chaos {
  double memory = 0.0;
  base::Twist drive(double x, double yaw, double forward, bool contact, std::span<const double> ranges) {
    double nearest = 8.0, sum = 0.0;
    for (const double range : ranges) nearest = std::min(nearest, range), sum += range;
    memory = 0.5 * memory + (contact ? 1.0 : 0.0);
    const double turn = std::sin(1e3 * sum + x + yaw) + memory;
    return {0.1 * nearest - 0.01 * forward, 0.0, turn};
  }
};

class ChaosController final : public sensorfarm::Controller {
 public:
  sensorfarm::Twist step(const sensorfarm::Input& input) override {
    const base::Twist twist = chaos_.drive(input.pose.x, input.pose.yaw, input.velocity.forward, input.contact,
                                           input.newest("laser")->values);
    return {twist.forward, twist.left, twist.turn};
  }

 private:
  Chaos chaos_;
};

gpu::Device& lockstep_device() {
  static gpu::Device device;
  return device;
}

/// A cave with noisy scans of several datagrams, at the ticks.
world::World lockstep_world(std::uint32_t robots) {
  world::World world = world::load_world(SF_SOURCE_DIR "/worlds/cave.world", {.sensors = sensors::world_file_words()});
  world::clone_robots(world, robots, kSeed);
  return world;
}

std::uint64_t hash_in_process(const world::World& world, const std::string& controller = "chaos") {
  static const bool added = [] {
    sensorfarm::ControllerEntry entry{
        "chaos", "of a test", 10.0, false,
        [](const sensorfarm::Robot&, sensorfarm::Settings&) { return std::make_unique<ChaosController>(); }};
    control::add_own_controller(std::move(entry), "test");
    return true;
  }();
  EXPECT_TRUE(added);
  Simulation simulation(world, lockstep_device(), {.seed = kSeed, .actor = {.controller = {.name = controller}}});
  for (int tick = 0; tick <= kTicks; ++tick) simulation.step();
  return simulation.farm().hash();
}

struct Fixture {
  explicit Fixture(std::uint32_t robots, std::uint32_t wait_for = 1, double timeout = 0.0)
      : Fixture(lockstep_world(robots), wait_for, timeout) {}
  explicit Fixture(world::World given, std::uint32_t wait_for = 1, double timeout = 0.0)
      : world(std::move(given)),
        service(world, lockstep_device(),
                {.lockstep = {.bind = {netio::kLoopback, 0},
                              .robots = wait_for,
                              .timeout = timeout,
                              .log_descriptor = log.descriptor()},
                 .seed = kSeed}) {}
  std::uint16_t port() { return service.lockstep().inbox().port(); }
  std::uint64_t tick() const { return service.ticks() - 1; }
  std::uint64_t hash() const { return service.simulation().farm().hash(); }

  server::LogPipe log;
  world::World world;
  LockstepService service;
  std::int64_t now = 0;
};

std::vector<std::uint32_t> ids(std::uint32_t first, std::uint32_t count) {
  std::vector<std::uint32_t> all(count);
  for (std::uint32_t i = 0; i < count; ++i) all[i] = first + i;
  return all;
}

/// Robots of one process, and their controllers.
struct Crew {
  Crew(Fixture& fixture, std::uint32_t first, std::uint32_t count, const Faults& faults = {})
      : robots(ids(first, count)), driver(fixture.port(), robots, faults) {}
  std::map<std::uint32_t, base::Twist> decide() {
    std::map<std::uint32_t, base::Twist> commands;
    for (const std::uint32_t id : robots) {
      const Driven& robot = driver.robot(id);
      commands[id] = minds[id].drive(robot.state.X_WR.x, robot.state.X_WR.yaw, robot.state.velocity.forward,
                                     robot.state.contact != 0, robot.readings.at(sensors::kLaser));
    }
    return commands;
  }
  std::vector<std::uint32_t> robots;
  std::map<std::uint32_t, Chaos> minds;
  Driver driver;
};

/// Runs all until `done`; returns false if that does not happen.
bool play(Fixture& fixture, const std::vector<Driver*>& drivers, const std::function<bool()>& done) {
  for (int round = 0; round < 100'000 && !done(); ++round, fixture.now += 1'000'000) {
    fixture.service.advance(fixture.now);
    for (Driver* driver : drivers) driver->receive();
    if (done()) return true;
    // Recently sent packets are repeated often, which must not matter.
    for (Driver* driver : drivers)
      if (!driver->is_complete()) driver->repeat();
  }
  return done();
}

/// Runs all until each has its answer.
bool play(Fixture& fixture, const std::vector<Driver*>& drivers) {
  return play(fixture, drivers, [&] {
    return std::all_of(drivers.begin(), drivers.end(), [](const Driver* driver) { return driver->is_complete(); });
  });
}

/// Drives to the last tick.
/// @return hash of all readings
std::uint64_t hash_over_udp(Fixture& fixture, const std::vector<Crew*>& crews) {
  std::vector<Driver*> drivers;
  for (Crew* crew : crews) drivers.push_back(&crew->driver);
  for (int tick = 0; tick < kTicks; ++tick) {
    EXPECT_TRUE(play(fixture, drivers)) << "tick " << tick;
    for (Crew* crew : crews) crew->driver.step(crew->decide());
  }
  EXPECT_TRUE(play(fixture, drivers));
  EXPECT_EQ(fixture.tick(), static_cast<std::uint64_t>(kTicks));
  return fixture.hash();
}

TEST(LockstepService, OneProcessDrivesLikeALocalController) {
  Fixture fixture(5);
  Crew crew(fixture, 1, 5);
  const std::uint64_t hash = hash_over_udp(fixture, {&crew});
  EXPECT_EQ(hash, hash_in_process(fixture.world));
  EXPECT_NE(hash, hash_in_process(fixture.world, "")) << "robots that stand see something else";
  EXPECT_EQ(fixture.service.lockstep().counts().commands, 5u * kTicks);
  EXPECT_EQ(fixture.service.lockstep().counts().refused, 0u);
}

/// A third of all datagrams is lost, a third is duplicated, and a third is late and in reverse order, in both
/// directions.
TEST(LockstepService, LossDuplicatesAndOrderChangeNothing) {
  const std::uint64_t expected = hash_in_process(lockstep_world(5));
  for (unsigned seed : {1u, 2u, 3u}) {
    Fixture fixture(5);
    const Faults faults{0.33, 0.33, 0.33, seed};
    Crew crew(fixture, 1, 5, faults);
    EXPECT_EQ(hash_over_udp(fixture, {&crew}), expected) << seed;
    EXPECT_GT(fixture.service.lockstep().counts().repeated, 100u) << "the faults did happen";
  }
}

TEST(LockstepService, SeveralProcessesDriveLikeOne) {
  Fixture fixture(5, 5);
  Crew one(fixture, 1, 2, {0.2, 0.2, 0.2, 4}), other(fixture, 3, 2), third(fixture, 5, 1, {0.0, 0.0, 0.5, 5});
  EXPECT_EQ(hash_over_udp(fixture, {&one, &other, &third}), hash_in_process(fixture.world));
}

/// 80 robots: states and scans take far more datagrams than are sent immediately.
TEST(LockstepService, LargeAnswersAreFetched) {
  Fixture fixture(80);
  Driver driver(fixture.port(), ids(1, 80), {0.1, 0.0, 0.1, 6});
  ASSERT_TRUE(play(fixture, {&driver}));
  EXPECT_GT(driver.datagrams(), 2u * server::Lockstep::kPushed);
  driver.step({}, 3);
  ASSERT_TRUE(play(fixture, {&driver}));
  EXPECT_EQ(fixture.tick(), 3u);
  EXPECT_EQ(driver.robot(80).readings.at(sensors::kLaser).size(), driver.robot(1).readings.at(sensors::kLaser).size());
}

/// The farm simulates up to the tick that all have requested: 1 + 1 + 1 ticks of one process are 3 of the other.
TEST(LockstepService, AProcessMayRequestSeveralTicks) {
  Fixture fixture(2, 2);
  Driver one(fixture.port(), {1}), other(fixture.port(), {2});
  ASSERT_TRUE(play(fixture, {&one, &other}));
  one.step({{1, {0.2, 0.0, 0.0}}}, 3);
  for (std::uint64_t tick = 1; tick <= 3; ++tick) {
    EXPECT_FALSE(one.is_complete());
    other.step({});
    ASSERT_TRUE(play(fixture, {&one, &other}, [&] { return other.is_complete(); }));
    EXPECT_EQ(fixture.tick(), tick) << "not beyond the slower process's request";
  }
  ASSERT_TRUE(play(fixture, {&one, &other}));
  EXPECT_EQ(one.tick(), 3u);
  EXPECT_DOUBLE_EQ(one.robot(1).state.velocity.forward, 0.2) << "the command held for all three";
}

/// Lasers of 5 Hz at 10 ticks a second: every other answer has a scan, and an answer after two ticks has it too.
TEST(LockstepService, AnAnswerHasTheReadingsSinceThePreviousOne) {
  Fixture fixture(server::room(5.0));
  Driver driver(fixture.port(), {1});
  std::vector<std::size_t> datagrams;
  for (const std::uint32_t ticks : {1u, 1u, 1u, 2u, 2u, 1u}) {
    ASSERT_TRUE(play(fixture, {&driver}));
    datagrams.push_back(driver.datagrams());
    driver.step({}, ticks);
  }
  EXPECT_EQ(datagrams, (std::vector<std::size_t>{2, 1, 2, 1, 2, 2})) << "at ticks 0, 1, 2, 3, 5 and 7";
}

/// A laser with `settings` for the first robot, and a lane edge sensor for both: one 0.4 m before a line, one in a
/// bend.
world::World bounds_world(const sensors::LaserSettings& settings) {
  world::World world = server::room();
  world.movers[0].sensors = {sensors::laser_sensor(settings)};
  for (world::Mover& mover : world.movers) mover.sensors.push_back({"laneedge", "edge", {}, 0.1, 1.0, 1.0, {}, 0, ""});
  world.movers[0].sensors.push_back({"magnetometer", "array", {}, 0.1, 1.0, 1.0, {}, 0, ""});
  world.lane_markings.push_back({{{-1.5, -1.0}, {-1.5, 1.0}}, 0.1, 0xFFFFFFFFu});
  world::LaneMarking bend{{}, 0.1, 0xFFFFFFFFu};
  for (double angle = -1.5; angle < 1.5; angle += 0.01)
    bend.line.push_back({2.0 + 0.4 * std::cos(angle), 1.0 + 0.4 * std::sin(angle)});
  world.lane_markings.push_back(bend);
  world::update_extent_and_hash(world);
  return world;
}

/// `error` holds for every value, or is infinite. The header indicates which, and contains the bound of unflagged
/// beams.
TEST(LockstepService, ErrorsHoldForEveryValueOrAreOmitted) {
  struct Case {
    double sigma;
    const char* mode;
    bool error, unsure, bound;
  };
  for (const Case& c : {Case{0.0, "exact", true, false, true}, Case{0.2, "exact", false, true, false},
                        Case{0.0, "skip2", false, true, true}}) {
    sensors::LaserSettings settings{{.name = "laser", .noise = {.range_sigma = c.sigma}}};
    settings.accuracy.word = c.mode;
    Fixture fixture(bounds_world(settings));
    Driver driver(fixture.port(), {1, 2});
    ASSERT_TRUE(play(fixture, {&driver}));
    const Driven &straight = driver.robot(1), &bend = driver.robot(2);
    const netio::Accuracy& laser = straight.accuracies.at(sensors::kLaser);
    EXPECT_EQ(std::isfinite(straight.errors.at(sensors::kLaser)), c.error) << c.mode;
    EXPECT_EQ(laser.unsure, c.unsure) << c.mode;
    EXPECT_EQ(std::isfinite(laser.bound), c.bound) << c.mode;
    EXPECT_EQ(straight.errors.at(sensors::kMagnetometer), 0.0) << "no magnets";
    EXPECT_LT(straight.accuracies.at(sensors::kMagnetometer).bound, 1e-18) << "the least that the word states";
    EXPECT_LT(straight.errors.at(sensors::kLaneEdge), 1.1e-8);
    EXPECT_FALSE(straight.accuracies.at(sensors::kLaneEdge).unsure);
    EXPECT_FALSE(std::isnan(bend.readings.at(sensors::kLaneEdge)[0]));
    EXPECT_TRUE(std::isinf(bend.errors.at(sensors::kLaneEdge))) << "not one straight line";
    EXPECT_TRUE(bend.accuracies.at(sensors::kLaneEdge).unsure);
    EXPECT_TRUE(std::isinf(bend.accuracies.at(sensors::kLaneEdge).bound));
  }
}

/// A STEP that announces two commands waits for the second one, whatever is repeated meanwhile.
TEST(LockstepService, AStepWaitsForItsCommands) {
  Fixture fixture(2);
  Driver driver(fixture.port(), {1, 2});
  ASSERT_TRUE(play(fixture, {&driver}));
  const auto command = [&](std::uint32_t robot, double forward) {
    base::Bytes rows;
    netio::add_row({robot, {forward, 0.0, 0.0}}, rows);
    driver.send(netio::Command{0, rows});
  };
  for (int i = 0; i < 3; ++i) {
    driver.send(netio::Step{0, 1, 2});
    command(1, 0.1 + i);  // only the first counts
    driver.flush();
    fixture.service.advance(0);
    EXPECT_EQ(fixture.tick(), 0u);
  }
  command(2, 0.0);
  driver.flush();
  EXPECT_TRUE(fixture.service.advance(0));
  EXPECT_EQ(fixture.service.lockstep().commands()[0].forward, 0.1);
  EXPECT_FALSE(fixture.service.advance(0)) << "one STEP, one tick";
}

/// Ticks other than the current one, robots of others, a STEP before any SUBSCRIBE: nothing happens.
TEST(LockstepService, UnexpectedPacketsAreCounted) {
  Fixture fixture(2, 2);
  Driver one(fixture.port(), {1}), other(fixture.port(), {2});
  one.send(netio::Step{0, 1, 0});
  one.flush();
  EXPECT_FALSE(fixture.service.advance(0));
  ASSERT_TRUE(play(fixture, {&one, &other}));
  base::Bytes rows;
  netio::add_row({2, {1.0, 0.0, 0.0}}, rows);       // robot of another process
  netio::add_row({40'000, {1.0, 0.0, 0.0}}, rows);  // unknown robot
  one.send(netio::Command{0, rows});
  rows.clear();
  netio::add_row({1, {1.0, 0.0, 0.0}}, rows);
  one.send(netio::Command{1, rows});  // for the next tick
  one.send(netio::Step{1, 1, 0});
  one.send(netio::Fetch{7, 0, 64});
  one.send(netio::Fetch{0, 1'000'000, 64});
  one.flush();
  other.send(netio::Step{0, 1, 0});
  other.flush();
  EXPECT_FALSE(fixture.service.advance(1));
  EXPECT_EQ(fixture.service.lockstep().counts().refused, 2u);
  EXPECT_EQ(fixture.service.lockstep().counts().commands, 0u);
  EXPECT_EQ(fixture.service.lockstep().commands()[0].forward, 0.0);
  EXPECT_EQ(fixture.service.lockstep().commands()[1].forward, 0.0);
}

/// One process has its answer of tick 1, the other has requested tick 2.
TEST(LockstepService, OnlyTheNewestAnswerIsFetched) {
  Fixture fixture(2, 2);
  Driver one(fixture.port(), {1}), other(fixture.port(), {2});
  ASSERT_TRUE(play(fixture, {&one, &other}));
  one.step({}), other.step({}, 2);
  ASSERT_TRUE(play(fixture, {&one, &other}, [&] { return one.is_complete(); }));
  const auto fetched = [&](Driver& driver, std::uint64_t tick) {
    fixture.service.advance(fixture.now);  // processes earlier packets
    const std::uint64_t before = fixture.service.lockstep().counts().fetched;
    driver.send(netio::Fetch{tick, 0, 64});
    driver.flush();
    fixture.service.advance(fixture.now);
    return fixture.service.lockstep().counts().fetched - before;
  };
  EXPECT_EQ(fetched(one, 0), 0u) << "the answer is discarded";
  EXPECT_EQ(fetched(other, 1), 0u) << "it did not ask for it";
  EXPECT_EQ(fetched(one, 1), one.datagrams());
  EXPECT_EQ(fixture.tick(), 1u);
}

TEST(LockstepService, AHungProcessIsDroppedByName) {
  Fixture fixture(3, 3, 2.0);
  Driver one(fixture.port(), {1}), other(fixture.port(), {2, 3});
  ASSERT_TRUE(play(fixture, {&one, &other}));
  one.step({});
  const std::int64_t begun = fixture.now;
  ASSERT_TRUE(play(fixture, {&one}, [&] { return fixture.now >= begun + 1'900'000'000; }));
  EXPECT_EQ(fixture.tick(), 0u) << "0.1 s before the limit all still wait";
  ASSERT_TRUE(play(fixture, {&one}, [&] { return one.is_complete(); }));
  EXPECT_EQ(one.robot(1).state.flags, netio::kDriverLostBit);
  EXPECT_EQ(fixture.service.lockstep().counts().lost_robots, 2u);
  const std::string message = fixture.log.read_all();
  expect_in("tick 0: no command or STEP for 2 s from " + fixture.world.movers[1].name + " (id 2), ", message);
  one.step({});
  ASSERT_TRUE(play(fixture, {&one}, [&] { return one.is_complete(); })) << "the others continue";
}

TEST(LockstepService, ALostRobotIsReported) {
  Fixture fixture(2, 2, 2.0);
  Driver one(fixture.port(), {1}), other(fixture.port(), {2});
  ASSERT_TRUE(play(fixture, {&one, &other}));
  EXPECT_EQ(one.robot(1).state.flags, 0u);
  one.step({});
  ASSERT_TRUE(play(fixture, {&one}, [&] { return one.is_complete(); }));
  EXPECT_EQ(one.robot(1).state.flags, netio::kDriverLostBit);
}

/// A silent process delays no other process if it is the only one. It is reported once per tick and keeps its robots.
TEST(LockstepService, ASilentProcessAloneIsAwaited) {
  Fixture fixture(1, 1, 2.0);
  Driver driver(fixture.port(), {1});
  ASSERT_TRUE(play(fixture, {&driver}));
  const std::int64_t begun = fixture.now;
  play(fixture, {}, [&] { return fixture.now >= begun + 6'000'000'000; });
  const std::string message = fixture.log.read_all(), name = fixture.world.movers[0].name;
  EXPECT_EQ(message, "sensorfarm: tick 0: waiting for 2 s for the commands or STEP of " + name + " (id 1)\n");
  driver.step({});
  EXPECT_TRUE(play(fixture, {&driver}));
  EXPECT_EQ(fixture.service.lockstep().counts().lost_robots, 0u);
}

TEST(LockstepService, AProcessThatLeavesIsNotAwaited) {
  Fixture fixture(2, 2);
  Driver one(fixture.port(), {1}), other(fixture.port(), {2});
  ASSERT_TRUE(play(fixture, {&one, &other}));
  one.step({}), other.step({{2, {0.2, 0.0, 0.0}}});
  ASSERT_TRUE(play(fixture, {&one, &other}));
  other.leave();
  one.step({});
  ASSERT_TRUE(play(fixture, {&one}, [&] { return one.is_complete(); }));
  EXPECT_EQ(fixture.service.lockstep().commands()[1].forward, 0.0) << "its robot stops";
}

/// Four processes that send random packets at random times: the farm continues, and then serves a correct one.
TEST(LockstepService, RandomPacketsStopNothing) {
  Fixture fixture(3, 1, 1.0);
  std::mt19937 generator(7);  // NOLINT: the same packets every time
  const auto random = [&](std::uint32_t end) { return static_cast<std::uint32_t>(generator()) % end; };
  std::vector<std::unique_ptr<Driver>> drivers;
  for (std::uint32_t robot : {1u, 2u, 3u, 1u})
    drivers.push_back(std::make_unique<Driver>(fixture.port(), std::vector{robot}));
  base::Bytes rows;
  for (int i = 0; i < 20'000; ++i) {
    Driver& driver = *drivers[random(4)];
    const std::uint32_t robot = random(4) + 1;
    const std::uint64_t tick = fixture.tick() + random(3) - 1;
    rows.clear();
    netio::add_row({robot, {0.1, 0.0, 1.0}}, rows);
    switch (random(6)) {
      case 0:
        driver.send(netio::Subscribe{random(~0u)}, robot, random(8));
        break;
      case 1:
        driver.send(netio::Command{tick, rows}, robot);
        break;
      case 2:
        driver.send(netio::Step{tick, random(1000) + 1, random(3)}, robot);
        break;
      case 3:
        driver.send(netio::Fetch{tick, random(8), random(64) + 1}, robot);
        break;
      case 4:
        driver.receive();
        break;
      default:
        if (random(16) == 0) driver.send(netio::Leave{}, robot);
    }
    driver.flush();
    if (random(4) == 0) fixture.service.advance(fixture.now += random(200'000'000));
  }
  EXPECT_GT(fixture.tick(), 10u);
  EXPECT_GT(fixture.service.lockstep().counts().refused, 10u);
  fixture.now += 10'000'000'000;
  Driver driver(fixture.port(), {1, 2, 3});
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(play(fixture, {&driver}));
    driver.step({});
  }
}

/// For a robot that joins while its process waits for others, all readings are new.
TEST(LockstepService, ARobotThatJoinsLateReceivesEverything) {
  world::World world = server::room(1.0);
  const world::Mover first = world.movers[0];
  scenes::add_mover(world, {0.0, 0.0, 0.0, 0.0}, scenes::rectangle({0.0, 0.0}, 0.3, 0.3)).sensors = first.sensors;
  Fixture fixture(std::move(world), 2);
  Driver one(fixture.port(), {1}), other(fixture.port(), {2});
  ASSERT_TRUE(play(fixture, {&one, &other}));
  one.step({}, 2), other.step({});
  ASSERT_TRUE(play(fixture, {&one, &other}, [&] { return other.is_complete(); }));
  one.send(netio::Subscribe{0}, 3);
  one.flush();
  other.step({});
  ASSERT_TRUE(play(fixture, {&one, &other}, [&] { return one.is_complete(); }));
  EXPECT_EQ(one.datagrams(), 3u) << "two states, and the scan of tick 0 of robot 3 alone";
  EXPECT_EQ(one.robot(3).readings.at(sensors::kLaser).size(), 91u);
}

/// Bit 0 of a SUBSCRIBE: the states of all robots, as exact as its own.
TEST(LockstepService, StatesOfOthersAreSentOnRequest) {
  Fixture fixture(3, 2);
  Driver one(fixture.port(), {1}, {}, netio::kNeighboursBit), other(fixture.port(), {2});
  ASSERT_TRUE(play(fixture, {&one, &other}));
  EXPECT_EQ(one.datagrams(), 3u) << "no sensor type was requested";
  for (std::uint32_t id : {1u, 2u, 3u}) EXPECT_EQ(one.robot(id).state.X_WR.x, fixture.world.movers[id - 1].X_WM.x);
  EXPECT_THROW(other.robot(1), std::out_of_range);
}

}  // namespace
}  // namespace sf::scenarios
