#include "scenarios/simulation.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "base/error.h"
#include "control/own_controllers.h"
#include "farm/schedule.h"
#include "robots/kinematics.h"
#include "scenarios/run_metrics.h"
#include "sensors/laser.h"
#include "sensors/sensor_type.h"
#include "tests/counted_new.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"

namespace sf::scenarios {
namespace {

world::World our_world(const std::string& name, std::uint32_t robots = 0) {
  world::World world = world::load_world(SF_SOURCE_DIR "/worlds/" + name, {.sensors = sensors::world_file_words()});
  if (robots > 0) world::clone_robots(world, robots, 3);
  return world;
}

/// Rows of all movers except tags.
std::vector<std::uint32_t> robots_of(const world::World& world) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i)
    if (!world.movers[i].is_tag) rows.push_back(i);
  return rows;
}

/// All robots remain at rest.
SimulationOptions without_controllers(const world::World& world) {
  SimulationOptions options;
  options.actor.controller.name.clear();
  options.actors.assign(world.movers.size(), options.actor);
  return options;
}

control::ControllerConfig config_of(const std::string& name, std::vector<control::Setting> settings = {}) {
  return {name, 0.0, {"controller '" + name + "'", std::move(settings)}};
}

std::uint64_t hash_after(const world::World& world, const SimulationOptions& options, int ticks) {
  Simulation simulation(world, device(), options);
  for (int i = 0; i < ticks; ++i) simulation.step();
  return simulation.farm().hash();
}

TEST(Simulation, ThreadsChangeNothing) {
  const world::World world = our_world("rooms.world", 20);
  const std::uint64_t first = hash_after(world, {.seed = 7, .threads = 1}, 40);
  EXPECT_EQ(hash_after(world, {.seed = 7, .threads = 2}, 40), first);
  EXPECT_EQ(hash_after(world, {.seed = 7, .threads = 5}, 40), first);
  EXPECT_NE(hash_after(world, {.seed = 8, .threads = 2}, 40), first);
}

TEST(Simulation, ThreadsChangeNothingWithABadLink) {
  const world::World world = our_world("rooms.world", 20);
  SimulationOptions options{.seed = 7, .threads = 1};
  options.actor.link = {.delay = 0.1, .jitter = 0.3, .loss = 0.2, .seed = 7};
  const std::uint64_t first = hash_after(world, options, 40);
  options.threads = 3;
  EXPECT_EQ(hash_after(world, options, 40), first);
  options.actor.link.seed = 8;
  EXPECT_NE(hash_after(world, options, 40), first);
}

/// A link without delay and loss gives the same readings as no link.
TEST(Simulation, AMailboxWithoutDelayChangesNothing) {
  const world::World world = our_world("rooms.world", 10);
  SimulationOptions options{.seed = 7};
  const std::uint64_t direct = hash_after(world, options, 30);
  options.actor.link = {.jitter = 1e-12, .seed = 7};  // formally imperfect, but nothing is late
  EXPECT_EQ(hash_after(world, options, 30), direct);
}

TEST(Simulation, ARobotWithoutControllerDoesNotMove) {
  const world::World world = our_world("rooms.world", 3);
  SimulationOptions options;
  options.actor.controller.name.clear();
  Simulation simulation(world, device(), options);
  for (int i = 0; i < 20; ++i) simulation.step();
  const auto tick = simulation.step();
  for (std::size_t m = 0; m < world.movers.size(); ++m) {
    EXPECT_EQ(tick.reports[m].X_WM.x, world.movers[m].X_WM.x);
    EXPECT_EQ(simulation.controller(static_cast<std::uint32_t>(m)), nullptr);
  }
  EXPECT_FALSE(simulation.all_done());
}

TEST(Simulation, RobotsStartWithTheSignal) {
  const world::World world = our_world("rooms.world", 1);
  SimulationOptions options{.start_at = 1.0};
  options.actor.controller = config_of("wander", {{"start", std::string("signal"), ""}});
  Simulation simulation(world, device(), options);
  double moved_at = -1.0;
  for (int i = 0; i < 30 && moved_at < 0.0; ++i) {
    const auto tick = simulation.step();
    const base::Pose& X = tick.reports[0].X_WM;
    if (X.x != world.movers[0].X_WM.x || X.yaw != world.movers[0].X_WM.yaw) moved_at = 1e-9 * double(tick.time);
  }
  // Decided at 1.0 s, visible a tick later.
  EXPECT_NEAR(moved_at, 1.1, 0.11);
  EXPECT_GT(moved_at, 1.0);
}

TEST(Simulation, ControllersRunAtTheirOwnRate) {
  world::World world = our_world("testpath/testpath.world");
  world.interval = 0.05;
  SimulationOptions options;
  options.actor.controller = config_of("lane-keeping");
  options.actor.controller.rate = 4.0;
  Simulation simulation(world, device(), options);
  std::vector<int> steps;
  for (int i = 0; i <= 20; ++i) {
    simulation.step();
    if (simulation.stepped(0)) steps.push_back(i);
  }
  EXPECT_EQ(steps, (std::vector<int>{0, 5, 10, 15, 20}));
}

// --- Rates that do not divide the tick rate.

world::Sensor sensor(const std::string& type, double rate) {
  world::Sensor sensor;
  sensor.type = sensor.name = type;
  sensor.settings.push_back({"rate", {rate}, "", 0, ""});
  if (type == "encoder") sensor.settings.push_back({"slip", {0.02}, "", 0, ""});
  return sensor;
}

/// Robots among boxes with one laser each, invisible to each other.
world::World fast_world(const std::vector<double>& rates, const raycast::ScanNoise& noise = {}) {
  world::World world = scenes::boxes(15, 12.0, 3);
  sensors::LaserSettings laser = scenes::laser(31, M_PI, 6.0);
  laser.noise = noise;
  scenes::add_robots(world, static_cast<std::uint32_t>(rates.size()), laser, 5);
  for (std::size_t m = 0; m < rates.size(); ++m) {
    scenes::edit_laser(world.movers[m])->rate = rates[m];
    for (world::Segment& side : world.movers[m].body) side.seen_by_laser = false;
  }
  world::update_extent_and_hash(world);
  return world;
}

/// Every reading has its time of measurement, and is measured at the robot's interpolated pose at that time.
TEST(Simulation, SensorsMeasureAtTheirOwnTimes) {
  const std::vector<double> rates{13.0, 25.0, 50.0, 10.0, 4.0, 333.0};
  const world::World world = fast_world(rates);
  Simulation simulation(world, device(), {.seed = 7});
  farm::Farm asked(world, device(), {.noise = false});
  std::vector<std::uint32_t> counts(rates.size());
  std::vector<base::Report> before;
  std::size_t driven = 0;
  for (int i = 0; i <= 20; ++i) {  // 2 s, both ends included
    const base::TickRecord tick = simulation.step();
    for (const base::ReadingBlock& r : tick.readings) {
      ASSERT_EQ(r.sequence, counts[r.mover]) << rates[r.mover] << " Hz";
      ASSERT_EQ(r.time, farm::due_time(counts[r.mover]++, rates[r.mover], 0.0));
      if (r.time < tick.time && tick.contacts[r.mover] == 0) {
        const double since = 1e-9 * static_cast<double>(r.time - before[r.mover].time);
        const base::Pose X = robots::advance(before[r.mover].X_WM, tick.reports[r.mover].velocity, since);
        EXPECT_NEAR(r.X_WM.x, X.x, 1e-12);
        EXPECT_NEAR(r.X_WM.y, X.y, 1e-12);
        EXPECT_NEAR(base::wrap_angle(r.X_WM.yaw - X.yaw), 0.0, 1e-12);
        driven += r.X_WM.x != before[r.mover].X_WM.x;
      }
      if (r.mover == 5 && r.sequence % 16 != 0) continue;
      const base::ReadingBlock there = asked.sense(r.mover, sensors::kLaser, 0, r.X_WM);
      ASSERT_TRUE(std::equal(r.values.begin(), r.values.end(), there.values.begin(), there.values.end()));
    }
    before.assign(tick.reports.begin(), tick.reports.end());
  }
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{27, 51, 101, 21, 9, 667}));
  EXPECT_GT(driven, 200u) << "the test is meant to drive";
}

/// Returns the readings of the first robot.
std::vector<std::vector<double>> read_by_first(const world::World& world, std::uint8_t but = 0) {
  Simulation simulation(world, device(), {.seed = 7});
  std::vector<std::vector<double>> all;
  for (int i = 0; i < 60; ++i)
    for (const base::ReadingBlock& r : simulation.step().readings) {
      if (r.mover != 0 || r.type == but) continue;
      all.push_back({double(r.type), double(r.sequence), double(r.time)});
      all.back().insert(all.back().end(), r.values.begin(), r.values.end());
    }
  return all;
}

/// Samples of other sensors between ticks affect neither readings nor accumulated wheel rotations.
TEST(Simulation, RatesOfOtherSensorsChangeNothing) {
  const raycast::ScanNoise noise{.range_sigma = 0.01, .range_proportional = 0.0, .angle_sigma = 0.002};
  for (const double rate : {10.0, 13.0}) {
    world::World alone = fast_world({rate}, noise);
    alone.movers[0].sensors.push_back(sensor("encoder", 10.0));
    world::update_extent_and_hash(alone);
    const auto expected = read_by_first(alone);
    EXPECT_GT(expected.size(), rate == 10.0 ? 119u : 130u);

    world::World company = fast_world({rate, 50.0, 333.0, 7.0}, noise);
    company.movers[0].sensors = alone.movers[0].sensors;
    for (std::size_t m = 1; m < 4; ++m) company.movers[m].X_WM.x += 100.0;
    world::update_extent_and_hash(company);
    EXPECT_EQ(read_by_first(company), expected) << rate << " Hz, others far away";

    world::World more = alone;
    more.movers[0].sensors.push_back(sensor("gyro", 77.0));
    world::update_extent_and_hash(more);
    EXPECT_EQ(read_by_first(more, 9), expected) << rate << " Hz, and a gyro on itself";
  }
}

/// A controller receives the newest reading of each sensor, regardless of how many there were since its last step.
TEST(Simulation, ControllersReceiveTheNewestScan) {
  const world::World world = fast_world({25.0, 35.0, 50.0});
  SimulationOptions options{.seed = 7};
  const std::uint64_t direct = hash_after(world, options, 60);
  options.actor.link = {.jitter = 1e-12, .seed = 7};  // a mailbox, which keeps only the newest
  EXPECT_EQ(hash_after(world, options, 60), direct);
}

TEST(Simulation, ThreadsChangeNothingBetweenTicks) {
  const world::World world = fast_world({13.0, 25.0, 50.0, 10.0, 4.0}, {.range_sigma = 0.01});
  const std::uint64_t first = hash_after(world, {.seed = 7, .threads = 1}, 30);
  EXPECT_EQ(hash_after(world, {.seed = 7, .threads = 3}, 30), first);
}

/// Returns the first of 20 ticks in which the robot has received a reading of its lane edge sensor; -1 if none.
int first_error_tick(const world::World& world, double delay) {
  SimulationOptions options;
  options.actor.controller = config_of("lane-keeping");
  options.actor.link = {.delay = delay};
  Simulation simulation(world, device(), options);
  for (int tick = 0; tick < 20; ++tick) {
    simulation.step();
    if (std::isfinite(simulation.controller(0)->error())) return tick;
  }
  return -1;
}

/// The delay counts from the time of measurement, not from the next tick: first at 77 ms, received at the tick after
/// arrival.
TEST(Simulation, LinkDelaysCountFromTheMeasurement) {
  for (const auto& [delay, tick] : {std::pair{0.02, 1}, {0.022, 1}, {0.024, 2}, {0.12, 2}}) {
    world::World world = our_world("testpath/testpath.world");
    for (world::Sensor& s : world.movers[0].sensors) s.settings.push_back({"phase", {0.077}, "", 0, ""});
    EXPECT_EQ(first_error_tick(world, delay), tick) << delay;
  }
}

/// The robot steers towards the lane only after the first reading.
TEST(Simulation, ADelayedReadingActsAfterItsDelay) {
  const world::World world = our_world("testpath/testpath.world");
  for (const double delay : {0.0, 0.5, 1.0})
    EXPECT_EQ(first_error_tick(world, delay), std::lround(delay / world.interval)) << delay;
}

/// Two robots that patrol towards each other stop by V2V; without it they would collide.
TEST(Simulation, RobotsReceiveEachOthersStates) {
  world::World world = our_world("rooms.world", 2);
  const auto rows = robots_of(world);
  ASSERT_EQ(rows.size(), 2u);
  world.walls.clear();
  for (world::Mover& mover : world.movers) mover.X_WM = {100.0, 100.0, 0.0, 0.0};
  world.movers[rows[0]].X_WM = {0.0, 0.0, 0.0, 0.0};
  world.movers[rows[1]].X_WM = {3.0, 0.0, 0.0, M_PI};
  world::update_extent_and_hash(world);
  SimulationOptions options = without_controllers(world);
  const auto towards = [&](double x) {
    return config_of("patrol", {{"points", std::vector<double>{x, 0.0}, ""}, {"speed", 0.3, ""}});
  };
  options.actors[rows[0]].controller = towards(3.0);
  options.actors[rows[1]].controller = towards(0.0);
  Simulation simulation(world, device(), options);
  RunMetrics metrics(world, simulation);
  double gap = 0.0;
  for (int i = 0; i < 150; ++i) {
    const auto tick = simulation.step();
    metrics.update(tick);
    gap = std::abs(tick.reports[rows[0]].X_WM.x - tick.reports[rows[1]].X_WM.x);
  }
  EXPECT_EQ(metrics.of(rows[0]).contacts + metrics.of(rows[1]).contacts, 0u);
  EXPECT_LT(gap, 1.2);
  EXPECT_GT(gap, 0.33);
}

TEST(Simulation, UnknownControllersAndSettingsAreRejected) {
  const world::World world = our_world("rooms.world", 1);
  SimulationOptions options;
  options.actor.controller = config_of("wonder");
  EXPECT_THROW(Simulation(world, device(), options), base::InputError);
  options.actor.controller = config_of("wander", {{"speeed", 1.0, "--set speeed: "}});
  EXPECT_THROW(Simulation(world, device(), options), base::InputError);
}

/// With mailboxes, links and V2V.
TEST(Simulation, ATickAllocatesNothingAfterWarmUp) {
  world::World world = our_world("rooms.world", 12);
  SimulationOptions options = without_controllers(world);
  options.threads = 1;
  for (const std::uint32_t i : robots_of(world)) {
    options.actors[i].link = {.delay = 0.1, .jitter = 0.2, .loss = 0.1, .seed = 1};
    options.actors[i].controller =
        i % 2 == 0 ? config_of("patrol", {{"points", std::vector<double>{0.0, 0.0}, ""}}) : config_of("wander");
  }
  // No robot moves: new places would create cells, which allocates in the farm.
  for (world::Mover& mover : world.movers) mover.max_forward = mover.max_turn = 1e-12;
  Simulation simulation(world, device(), options);
  for (int i = 0; i < 200; ++i) simulation.step();
  counted::allocations = 0;
  for (int i = 0; i < 50; ++i) {
    counted::counting = true;
    simulation.step();
    counted::counting = false;
  }
  EXPECT_EQ(counted::allocations, 0u);
}

/// A long step ends soon after a stop is requested.
TEST(Simulation, ALongStepIsAbandoned) {
  const world::World world = our_world("rooms.world", 3);
  Simulation simulation(world, device(), {});
  simulation.step();
  simulation.interrupt_on([] { return true; }, std::chrono::nanoseconds(0));
  EXPECT_THROW(simulation.step(), base::Interrupted);
}

/// A stop is detected between two robots: many decisions take long even if each is fast.
TEST(Simulation, AStopIsDetectedBetweenTwoRobots) {
  static std::atomic<int> steps{0};
  struct Counts : sensorfarm::Controller {
    sensorfarm::Twist step(const sensorfarm::Input&) override { return ++steps, sensorfarm::Twist{}; }
  };
  control::add_own_controller(
      {"counts", "of a test", 10.0, false,
       [](const sensorfarm::Robot&, sensorfarm::Settings&) { return std::make_unique<Counts>(); }},
      "test");
  const world::World world = our_world("rooms.world", 30);
  Simulation simulation(world, device(), {.threads = 2, .actor = {.controller = config_of("counts")}});
  simulation.step();
  const int before = steps;
  ASSERT_EQ(before, 30);
  simulation.interrupt_on([] { return steps > 30; }, std::chrono::nanoseconds(0));
  EXPECT_THROW(while (steps < 1000) simulation.step(), base::Interrupted);
  EXPECT_LE(steps, before + 2) << "one for each thread";
}

/// A robot whose displacements would need too many substeps per tick to test is named once, with the remedy.
TEST(Simulation, WarnsAboutRobotsTooFastForTheirTicks) {
  world::World world = our_world("rooms.world", 3);
  EXPECT_TRUE(Simulation(world, device(), {}).warnings().empty());
  world.movers[1].max_forward = world.movers[2].max_forward = 1e5;
  const Simulation simulation(world, device(), {});
  ASSERT_EQ(simulation.warnings().size(), 1u);
  expect_in("'" + world.movers[1].name + "' may travel 1e+04 m in a tick", simulation.warnings()[0].message);
  EXPECT_NE(simulation.warnings()[0].message.find("velocity_bounds"), std::string::npos);
}

}  // namespace
}  // namespace sf::scenarios
