#include "scenarios/simulation.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "scenarios/watch.h"
#include "sensors/kind.h"
#include "tests/counted_new.h"

namespace sf::scenarios {
namespace {

gpu::Device& device() {
  static gpu::Device device;
  return device;
}

world::World our_world(const std::string& name, std::uint32_t robots = 0) {
  world::World world = world::load_world(SF_SOURCE_DIR "/worlds/" + name, {.sensors = sensors::vocabulary()});
  if (robots > 0) world::clone_robots(world, robots, 3);
  return world;
}

/// Rows of all that are not tags.
std::vector<std::uint32_t> robots_of(const world::World& world) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i)
    if (!world.movers[i].is_tag) rows.push_back(i);
  return rows;
}

/// Everyone stands.
SimulationOptions nobody(const world::World& world) {
  SimulationOptions options;
  options.actor.plan.controller.clear();
  options.actors.assign(world.movers.size(), options.actor);
  return options;
}

control::Plan plan(const std::string& name, std::vector<control::Setting> settings = {}) {
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

TEST(Simulation, ThreadsChangeNothingBehindABadLinkEither) {
  const world::World world = our_world("rooms.world", 20);
  SimulationOptions options{.seed = 7, .threads = 1};
  options.actor.link = {.delay = 0.1, .jitter = 0.3, .loss = 0.2, .seed = 7};
  const std::uint64_t first = hash_after(world, options, 40);
  options.threads = 3;
  EXPECT_EQ(hash_after(world, options, 40), first);
  options.actor.link.seed = 8;
  EXPECT_NE(hash_after(world, options, 40), first);
}

/// Without a link the readings come as they are made: a link that does nothing is no link.
TEST(Simulation, AMailboxThatKeepsNothingBackChangesNothing) {
  const world::World world = our_world("rooms.world", 10);
  SimulationOptions options{.seed = 7};
  const std::uint64_t direct = hash_after(world, options, 30);
  options.actor.link = {.jitter = 1e-12, .seed = 7};  // not perfect by its own word, and yet nothing is late
  EXPECT_EQ(hash_after(world, options, 30), direct);
}

TEST(Simulation, WhoHasNoControllerStands) {
  const world::World world = our_world("rooms.world", 3);
  SimulationOptions options;
  options.actor.plan.controller.clear();
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
  options.actor.plan = plan("wander", {{"start", std::string("signal"), ""}});
  Simulation simulation(world, device(), options);
  double moved_at = -1.0;
  for (int i = 0; i < 30 && moved_at < 0.0; ++i) {
    const auto tick = simulation.step();
    const base::Pose& X = tick.reports[0].X_WM;
    if (X.x != world.movers[0].X_WM.x || X.yaw != world.movers[0].X_WM.yaw) moved_at = 1e-9 * double(tick.time);
  }
  // Decided at 1.0 s, seen a tick later.
  EXPECT_NEAR(moved_at, 1.1, 0.11);
  EXPECT_GT(moved_at, 1.0);
}

TEST(Simulation, ControllersRunAtTheirOwnRate) {
  world::World world = our_world("testpath/testpath.world");
  world.interval = 0.05;
  SimulationOptions options;
  options.actor.plan = plan("lane-keeping");
  options.actor.plan.rate = 4.0;
  Simulation simulation(world, device(), options);
  std::vector<int> steps;
  for (int i = 0; i <= 20; ++i) {
    simulation.step();
    if (simulation.stepped(0)) steps.push_back(i);
  }
  EXPECT_EQ(steps, (std::vector<int>{0, 5, 10, 15, 20}));
}

/// The wheel turns towards the lane only once the first reading has come.
TEST(Simulation, ADelayedReadingIsSeenThatMuchLater) {
  const world::World world = our_world("testpath/testpath.world");
  for (const double delay : {0.0, 0.5, 1.0}) {
    SimulationOptions options;
    options.actor.plan = plan("lane-keeping");
    options.actor.link = {.delay = delay};
    Simulation simulation(world, device(), options);
    int first = -1;
    for (int i = 0; i < 20 && first < 0; ++i) {
      simulation.step();
      if (std::isfinite(simulation.controller(0)->error())) first = i;
    }
    EXPECT_EQ(first, std::lround(delay / world.interval)) << delay;
  }
}

/// Two robots that patrol towards each other hear of each other, and stop; deaf ones would meet.
TEST(Simulation, RobotsHearEachOther) {
  world::World world = our_world("rooms.world", 2);
  const auto rows = robots_of(world);
  ASSERT_EQ(rows.size(), 2u);
  world.walls.clear();
  for (world::Mover& mover : world.movers) mover.X_WM = {100.0, 100.0, 0.0, 0.0};
  world.movers[rows[0]].X_WM = {0.0, 0.0, 0.0, 0.0};
  world.movers[rows[1]].X_WM = {3.0, 0.0, 0.0, M_PI};
  world::finish(world);
  SimulationOptions options = nobody(world);
  const auto towards = [&](double x) {
    return plan("patrol", {{"points", std::vector<double>{x, 0.0}, ""}, {"speed", 0.3, ""}});
  };
  options.actors[rows[0]].plan = towards(3.0);
  options.actors[rows[1]].plan = towards(0.0);
  Simulation simulation(world, device(), options);
  Watch watch(world, simulation);
  double gap = 0.0;
  for (int i = 0; i < 150; ++i) {
    const auto tick = simulation.step();
    watch.look(tick);
    gap = std::abs(tick.reports[rows[0]].X_WM.x - tick.reports[rows[1]].X_WM.x);
  }
  EXPECT_EQ(watch.of(rows[0]).contacts + watch.of(rows[1]).contacts, 0u);
  EXPECT_LT(gap, 1.2);
  EXPECT_GT(gap, 0.33);
}

TEST(Simulation, UnknownControllersAndSettingsAreRefused) {
  const world::World world = our_world("rooms.world", 1);
  SimulationOptions options;
  options.actor.plan = plan("wonder");
  EXPECT_THROW(Simulation(world, device(), options), base::InputError);
  options.actor.plan = plan("wander", {{"speeed", 1.0, "--set speeed: "}});
  EXPECT_THROW(Simulation(world, device(), options), base::InputError);
}

/// With mailboxes, links and V2V at work.
TEST(Simulation, ATickAllocatesNothingAfterWarmUp) {
  world::World world = our_world("rooms.world", 12);
  SimulationOptions options = nobody(world);
  options.threads = 1;
  for (const std::uint32_t i : robots_of(world)) {
    options.actors[i].link = {.delay = 0.1, .jitter = 0.2, .loss = 0.1, .seed = 1};
    options.actors[i].plan =
        i % 2 == 0 ? plan("patrol", {{"points", std::vector<double>{0.0, 0.0}, ""}}) : plan("wander");
  }
  // Nobody drives: where robots are, cells are built, and that is the farm's business.
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

}  // namespace
}  // namespace sf::scenarios
