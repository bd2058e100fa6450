#include "scenarios/rank_exchange.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/cluster/thread_ranks.h"
#include "tests/sensors/scenes.h"

namespace sf::scenarios {
namespace {

/// [1/s] 500 for a robot, and for each reading 20 plus its rays.
TEST(RankExchange, CostsIncludeReadingsAndRays) {
  world::World world;
  const std::uint32_t robot = scenes::add_robot(world, {}, scenes::laser(61));
  world.movers.emplace_back();
  const sensors::SensorSet sensor_set(world);
  const double rate = sensor_set.groups()[0].rows[0].rate;
  EXPECT_EQ(costs_of(world, sensor_set)[robot], 500.0 + rate * (20.0 + 61.0));
  EXPECT_EQ(costs_of(world, sensor_set)[robot + 1], 500.0);
}

/// Robots in all four states, two on each rank.
TEST(RankExchange, AllRanksGetTheStatusOfAllControllers) {
  world::World world;
  for (int m = 0; m < 4; ++m) scenes::add_robot(world, {2.0 * m, 0.0, 0.0, 0.0}, scenes::laser(3));
  const std::vector<unsigned> homes{0, 0, 1, 1};
  std::vector<std::unique_ptr<gpu::Device>> devices;
  for (int rank = 0; rank < 2; ++rank) devices.push_back(std::make_unique<gpu::Device>());
  cluster::ThreadRanks(2).run([&](cluster::Ranks& one) {
    farm::Farm farm(world, *devices[one.rank()], {.threads = 1, .shared = true});
    RankExchange exchange(one, homes);
    std::vector<base::Twist> commands(4);
    std::vector<base::Intent> intents(4);
    std::vector<OwnEstimate> estimates(4);
    std::vector<ControlStatus> statuses(4, {.drives = true});
    for (std::uint32_t m = 0; m < 4; ++m)
      if (exchange.owns(m)) {
        statuses[m] = {true, m % 2 == 1, m >= 2, 0.25 * m};
        estimates[m].quality.stated = m < 2;
        estimates[m].quality.covariance[5] = 0.5f * static_cast<float>(m);
        estimates[m].state = {.time = m, .X_WM = {1.0 * m, 2.0, 3.0, 4.0}, .velocity = {5.0, 6.0, 7.0 * m}};
      }
    exchange.begin({commands, intents, estimates, statuses}, farm, base::kNoId, nullptr, false);
    EXPECT_FALSE(exchange.finish({commands, intents, estimates, statuses}, farm));
    for (std::uint32_t m = 0; m < 4; ++m) {
      EXPECT_EQ(statuses[m].stepped, m % 2 == 1) << m;
      EXPECT_EQ(statuses[m].done, m >= 2) << m;
      if (exchange.owns(m)) continue;
      EXPECT_EQ(estimates[m].quality.stated, m == 1) << "sent after steps by robots that have one";
      if (m != 1) continue;
      EXPECT_EQ(estimates[m].quality.covariance[5], 0.5f);
      EXPECT_EQ(estimates[m].state.time, 1);
      EXPECT_EQ(estimates[m].state.X_WM.yaw, 4.0);
      EXPECT_EQ(estimates[m].state.velocity.turn, 7.0);
      EXPECT_EQ(std::isnan(statuses[m].error), !statuses[m].stepped) << m;
    }
  });
}

}  // namespace
}  // namespace sf::scenarios
