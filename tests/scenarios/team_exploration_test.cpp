// Exploration by several robots that share their maps.

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "control/control_shell.h"
#include "control/explore.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/cluster/thread_ranks.h"
#include "tests/device.h"
#include "tests/instrumented.h"
#include "tests/refusal.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {
namespace {

const std::string kExplorer = R"(
define explorer position
(
  size [0.33 0.33 0.1] drive "diff" velocity_bounds [-0.5 0.5 0 0 0 0 -90 90]
  laser( pose [0.1 0 0.1 0] samples 91 fov 180 range_max 0.75 rate 10 )
)
)";
const std::string kRoom = kExplorer + R"(
define fence model( size [0.04 2.04 0.4] )
fence( pose [-1 0 0 0] ) fence( pose [1 0 0 0] ) fence( pose [0 -1 0 90] ) fence( pose [0 1 0 90] )
explorer( name "a" pose [-0.6 -0.5 0 0] )
explorer( name "b" pose [0.6 0.5 0 180] )
)";
const std::string kPassage = kExplorer + R"(
model( pose [0 0.3 0 0] size [3 0.04 0.4] ) model( pose [0 -0.3 0 0] size [3 0.04 0.4] )
model( pose [-1.2 0 0 0] size [0.04 0.6 0.4] ) model( pose [1.5 0 0 0] size [0.04 0.6 0.4] )
explorer( name "a" pose [-0.8 0 0 0] )
explorer( name "b" pose [0.2 0 0 180] )
)";

world::World room() { return world::build_world("room.world", kRoom, {.sensors = sensors::world_file_words()}); }

SimulationOptions exploring(bool team, unsigned threads = 1) {
  return {.seed = 3,
          .threads = threads,
          .actor = {.controller = {"explore", 0.0, {"controller 'explore'", {{"team", team, ""}}}}, .link = {}}};
}

const control::Explore& explorer(const Simulation& simulation, std::uint32_t mover) {
  const auto& shell = dynamic_cast<const control::ControlShell&>(*simulation.controller(mover));
  return dynamic_cast<const control::Explore&>(shell.inner());
}

std::size_t explored(const maps::OccupancyGrid& grid) {
  std::size_t count = 0;
  for (std::int64_t row = 0; row < maps::rows(grid.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(grid.geometry); ++column)
      count += grid.at({column, row}) != maps::Cell::unexplored;
  return count;
}

TEST(TeamExploration, EachRobotHasTheMapOfAll) {
  const world::World world = room();
  std::size_t seen[2] = {};
  for (const bool team : {false, true}) {
    Simulation simulation(world, device(), exploring(team));
    for (int i = 0; i < 100; ++i) simulation.step();
    seen[team ? 1 : 0] = explored(explorer(simulation, 0).grid());
  }
  EXPECT_GT(seen[1], seen[0] * 3 / 2) << "b is in the other corner";
}

TEST(TeamExploration, ClaimsAreExclusiveAfterOneTick) {
  const world::World world = room();
  Simulation simulation(world, device(), exploring(true));
  std::vector<std::int64_t> before;
  int claims = 0;
  for (int i = 0; i < 150; ++i) {
    simulation.step();
    std::vector<std::int64_t> both;
    const auto a = explorer(simulation, 0).shared_map(), b = explorer(simulation, 1).shared_map();
    if (!a || !b) continue;
    claims += !a->claim.empty() && !b->claim.empty();
    std::set_intersection(a->claim.begin(), a->claim.end(), b->claim.begin(), b->claim.end(), std::back_inserter(both));
    std::vector<std::int64_t> kept;
    for (const std::int64_t key : both) {
      const auto wide = maps::columns(a->geometry);
      const bool open = explorer(simulation, 0).grid().at({key % wide, key / wide}) == maps::Cell::unexplored &&
                        explorer(simulation, 1).grid().at({key % wide, key / wide}) == maps::Cell::unexplored;
      if (open && std::binary_search(before.begin(), before.end(), key)) kept.push_back(key);
    }
    EXPECT_TRUE(kept.empty()) << "tick " << i;
    before = both;
  }
  EXPECT_GT(claims, 10) << "both explore";
}

TEST(TeamExploration, ThreadsChangeNothing) {
  const world::World world = room();
  std::uint64_t hashes[2];
  for (const unsigned threads : {1u, 3u}) {
    Simulation simulation(world, device(), exploring(true, threads));
    for (int i = 0; i < 100; ++i) simulation.step();
    hashes[threads / 2] = simulation.farm().hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(TeamExploration, ARobotThatLeavesOrIsDrivenReleasesItsClaim) {
  if (instrumented()) GTEST_SKIP() << "a minute under sanitizers; Teammates.ARobotThatLeavesReleasesItsClaim is short";
  const world::World world = room();
  for (const bool leaves : {true, false}) {
    Simulation simulation(world, device(), exploring(true));
    for (int i = 0; i < 120; ++i) simulation.step();
    if (leaves)
      simulation.remove_robot(0);
    else
      simulation.drive(0, {});
    for (int i = 0; i < 2000 && !explorer(simulation, 1).done(); ++i) simulation.step();
    EXPECT_TRUE(explorer(simulation, 1).done()) << "b explores the rest";
  }
}

TEST(TeamExploration, ARobotAtRestInAPassageIsNotAwaitedForever) {
  if (instrumented()) GTEST_SKIP() << "a minute under sanitizers; Teammates tests its parts";
  const world::World world = world::build_world("passage.world", kPassage, {.sensors = sensors::world_file_words()});
  SimulationOptions options = exploring(true);
  options.actors.assign(2, options.actor);
  options.actors[1].controller.name.clear();
  Simulation simulation(world, device(), options);
  for (int i = 0; i < 1500 && !explorer(simulation, 0).done(); ++i) simulation.step();
  EXPECT_TRUE(explorer(simulation, 0).done()) << "it gives up the cells behind the other robot";
}

TEST(TeamExploration, IsRefusedAcrossRanks) {
  std::vector<std::unique_ptr<gpu::Device>> devices;
  for (int rank = 0; rank < 2; ++rank) devices.push_back(std::make_unique<gpu::Device>());
  cluster::ThreadRanks(2).run([&](cluster::Ranks& rank) {
    const world::World world = room();
    SimulationOptions options = exploring(true);
    options.ranks = &rank;
    EXPECT_EQ(refusal_of([&] { Simulation(world, *devices[rank.rank()], options); }),
              "controller 'explore': robots cannot share maps across ranks; expected one process, or the setting "
              "'team = false'");
  });
}

}  // namespace
}  // namespace sf::scenarios
