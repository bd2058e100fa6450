// Explorers in processes of their own that share their maps without the farm.

#include <gtest/gtest.h>

#include <algorithm>

#include "control/explore.h"
#include "sensors/sensor_type.h"
#include "tests/server/fixture.h"
#include "world/stage/build_world.h"

namespace sf::server {
namespace {

/// The controllers of the robots, per mover.
std::map<std::uint32_t, control::Explore*>& team_explorers() {
  static std::map<std::uint32_t, control::Explore*> explorers;
  return explorers;
}

constinit const control::ControllerType team_explorer{
    .name = "test-team-explorer",
    .summary = "explores, observed",
    .stops_on_bumper = false,
    .make = [](const control::ControllerContext& context, control::Settings& settings) {
      auto made = control::explore_controller.make(context, settings);
      team_explorers()[context.mover] = dynamic_cast<control::Explore*>(made.get());
      return made;
    }};

/// A room of 2 m by 2 m with two robots in opposite corners, which see 0.75 m.
world::World team_room() {
  return world::build_world("room.world", R"(
define explorer position
(
  size [0.33 0.33 0.1] drive "diff" velocity_bounds [-0.5 0.5 0 0 0 0 -90 90]
  laser( pose [0.1 0 0.1 0] samples 91 fov 180 range_max 0.75 rate 10 )
)
define fence model( size [0.04 2.04 0.4] )
fence( pose [-1 0 0 0] ) fence( pose [1 0 0 0] ) fence( pose [0 -1 0 90] ) fence( pose [0 1 0 90] )
explorer( name "a" pose [-0.6 -0.5 0 0] )
explorer( name "b" pose [0.6 0.5 0 180] )
)",
                            {.sensors = sensors::world_file_words()});
}

struct RobotTeamTest : testing::Test {
  static void SetUpTestSuite() { control::add_controller(&team_explorer); }
  RobotTeamTest() { f.client.reset(), team_explorers().clear(); }

  /// @param cells [m] of each robot's map
  void start(bool direct, const std::array<double, 2>& cells = {0.03, 0.03}, double loss = 0.0) {
    const std::array ports{free_port(), free_port()};
    for (const std::uint32_t mover : {0u, 1u}) {
      RobotClientOptions options{.log_descriptor = f.log.descriptor()};
      options.link.farm = {netio::kLoopback, f.service->port()};
      options.link.model.loss = loss;
      options.controller.name = team_explorer.name;
      options.controller.settings = {"controller 'explore'", {{"team", true, ""}, {"cell", cells[mover], ""}}};
      if (direct)
        options.link.direct = netio::DirectV2vOptions{.bind = {netio::kLoopback, ports[mover]},
                                                      .peers = {{netio::kLoopback, ports[1 - mover]}}};
      robots.push_back(std::make_unique<RobotClient>(f.world, f.sensor_set, mover, f.layout, options));
    }
  }
  static std::uint16_t free_port() { return netio::bound_endpoint(netio::open_udp({netio::kLoopback, 0})).port; }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i, f.now += kTick) {
      for (const auto& robot : robots) robot->receive(f.now), robot->step(f.now);
      f.service->tick(f.now);
    }
  }

  Fixture f{{.world = team_room()}};
  std::vector<std::unique_ptr<RobotClient>> robots;
};

/// Returns the cells that `robot` has measured, without the last two seconds, and those of them that `other` lacks.
std::pair<std::size_t, std::size_t> measured_and_missing(std::uint32_t robot, std::uint32_t other) {
  const auto map = team_explorers().at(robot)->shared_map();
  const maps::OccupancyGrid& grid = team_explorers().at(other)->grid();
  std::size_t measured = 0, missing = 0;
  for (std::size_t i = 0; i + 2 < map->changes.size(); ++i)
    for (const auto& cell : map->changes[i]->cells) {
      ++measured;
      missing += grid.at(cell.at) == maps::Cell::unexplored ? 1 : 0;
    }
  return {measured, missing};
}

TEST_F(RobotTeamTest, EachRobotHasTheMapOfBoth) {
  start(true);
  run(150);
  for (const std::uint32_t robot : {0u, 1u}) {
    const auto [measured, missing] = measured_and_missing(robot, 1 - robot);
    EXPECT_GT(measured, 1000u);
    EXPECT_EQ(missing, 0u);
    const auto stats = robots[robot]->stats();
    EXPECT_GT(stats.team->pieces, 10u);
    EXPECT_EQ(stats.team->repeated, 0u);
    EXPECT_LE(stats.team->sent, 150u / 10 * 50);
    EXPECT_EQ(stats.contacts, 0u);
  }
}

TEST_F(RobotTeamTest, ClaimsAreExclusive) {
  start(true);
  std::vector<std::int64_t> before;
  int claims = 0;
  for (int i = 0; i < 200; ++i) {
    run(1);
    const auto a = team_explorers().at(0)->shared_map(), b = team_explorers().at(1)->shared_map();
    if (!a || !b) continue;
    claims += !a->claim.empty() && !b->claim.empty() ? 1 : 0;
    std::vector<std::int64_t> both, kept;
    std::ranges::set_intersection(a->claim, b->claim, std::back_inserter(both));
    std::ranges::set_intersection(both, before, std::back_inserter(kept));
    EXPECT_TRUE(kept.empty()) << i;
    before = both;
  }
  EXPECT_GT(claims, 20);
}

TEST_F(RobotTeamTest, MapsAreCompleteOverALossyLink) {
  start(true, {0.03, 0.03}, 0.2);
  run(150);
  for (const std::uint32_t robot : {0u, 1u}) {
    for (int i = 0; i < 100 && measured_and_missing(robot, 1 - robot).second > 0; ++i) run(1);
    const auto [measured, missing] = measured_and_missing(robot, 1 - robot);
    EXPECT_GT(measured, 1000u);
    EXPECT_EQ(missing, 0u);
    EXPECT_GT(robots[robot]->stats().team->repeated, 0u);
  }
}

TEST_F(RobotTeamTest, ARobotThatIsDoneStaysUntilTheOtherHasItsMap) {
  start(true, {0.03, 0.03}, 0.6);
  int staying = 0;
  for (int i = 0; i < 4000 && !robots[0]->done(); ++i) {
    run(1);
    staying += robots[0]->stats().done ? 0 : team_explorers().at(0)->done() ? 1 : 0;
  }
  ASSERT_TRUE(robots[0]->done());
  EXPECT_GT(staying, 0);
  EXPECT_EQ(robots[1]->stats().team->changes, team_explorers().at(0)->shared_map()->changes.size());
}

TEST_F(RobotTeamTest, WithoutADirectLinkRobotsExploreAlone) {
  start(false);
  run(100);
  EXPECT_GT(measured_and_missing(0, 1).second, 100u);
  EXPECT_FALSE(robots[0]->stats().team);
  EXPECT_NE(f.log.read_all().find("a explores alone, because"), std::string::npos);
}

TEST_F(RobotTeamTest, MapsOfDifferentAreasAreNotShared) {
  start(true, {0.03, 0.04});
  run(100);
  EXPECT_EQ(robots[0]->stats().team->changes, 0u);
  EXPECT_NE(f.log.read_all().find("the maps of robots"), std::string::npos);
}

}  // namespace
}  // namespace sf::server
