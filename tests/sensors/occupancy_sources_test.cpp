// Occupancy maps from several unlike sensors: settings, readings of a tick, and firing order.

#include "sensors/occupancy_sources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/time.h"
#include "farm/farm.h"
#include "sensors/infrared.h"
#include "sensors/laser.h"
#include "sensors/sonar.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/host_trial.h"
#include "world/stage/build_world.h"

namespace sf::trial {
namespace {

using sensors::RangeSensor;

const std::string kThreeSensors =
    "laser( samples 61 fov 120 range_max 3 noise [0.02 0.01 0] rate 10 ) "
    "sonar( scount 4 spose[0] [0.1 0 0] spose[1] [0 0.1 90] spose[2] [-0.1 0 180] spose[3] [0 -0.1 -90] fov 25 "
    "range [0.05 3] noise [0.02 0.01] rate 10 ) "
    "infrared( scount 1 spose[0] [0.1 0 30] fov 20 range [0 1] noise 0.1 rate 20 ) ";

world::World surveyed(const std::string& map, const std::string& sensors = kThreeSensors) {
  return world::build_world("surveyed.world",
                            "define bot position( size [0.3 0.3 0.1] drive \"diff\" " + sensors +
                                " )\n"
                                "bot( name \"r0\" pose [0 0 0 0] occupancy( cell 0.05 words [30 30] " +
                                map +
                                " ) )\n"
                                "bot( name \"r1\" pose [1 -1 0 90] )\n"
                                "model( name \"wall\" pose [2 0 0 0] size [0.1 4 0.5] )\n"
                                "model( name \"post\" pose [0.5 0.6 0 0] size [0.1 0.1 0.5] )\n",
                            {.sensors = sensors::world_file_words()});
}

std::vector<RangeSensor> sources_of(const std::string& map) {
  return sensors::occupancies_of(surveyed(map)).at(0).sources;
}

TEST(OccupancySources, AreNamedLikeInputs) {
  using sensors::kInfrared, sensors::kLaser, sensors::kSonar;
  EXPECT_EQ(sources_of("sources [\"sonar\" \"laser:0\"]"), (std::vector<RangeSensor>{{kLaser, 0, 0}, {kSonar, 0, 0}}));
  EXPECT_EQ(sources_of("sources [\"*/laser\" \"r1/infrared\" \"laser\"]"),
            (std::vector<RangeSensor>{{kLaser, 0, 0}, {kLaser, 1, 0}, {kInfrared, 1, 0}}));
  const sensors::Occupancy map = sensors::occupancies_of(surveyed("sources [\"sonar\"]")).at(0);
  EXPECT_EQ(*map.settings.odds, maps::LogOddsUpdate{});
  EXPECT_EQ(*sensors::occupancies_of(surveyed("sources [\"sonar\"] log_odds [70 30 500]")).at(0).settings.odds,
            (maps::LogOddsUpdate{70, 30, 500}));
}

TEST(OccupancySources, RefusesWhatIsNoRangeSensor) {
  const auto refused = [](const std::string& map, const std::string& part) {
    const std::string error = refusal_of([&] { sources_of(map); });
    expect_in(part, error);
    EXPECT_TRUE(error.starts_with("surveyed.world:2:")) << error;
  };
  refused("sources [\"gps\"]", "expected \"[robot/]laser[:number]\", or a sonar or infrared");
  refused("sources [\"scan=laser\"]", "expected \"[robot/]laser");
  refused("sources [\"laser:one\"]", "expected \"[robot/]laser");
  refused("sources [\"laser:1\"]", "there is no such sensor");
  refused("sources [\"r2/laser\"]", "no robot is called 'r2'");
  refused("sources [1 2]", "expects names of sensors");
  refused("sources [\"laser\"] laser \"laser\"", "remove one of them");
  refused("sources [\"laser\"] log_odds 0", "always has log odds");
  refused("sources [\"laser\"] cell 0.001", "more than 1022 cells");
}

/// Runs two robots for a second and a half. @return the last map's words
std::vector<double> map_of(const world::World& world, unsigned threads, gpu::Device& on = host_device()) {
  farm::Farm farm(world, on, {.seed = 3, .threads = threads});
  farm.subscribe_all();
  std::vector<double> words;
  for (int tick = 0; tick <= 30; ++tick) {
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < 2; ++m) {
      base::Pose X = world.movers[m].X_WM;
      X.yaw += 0.05 * tick;
      reports.push_back({m, 0, X, {}});
    }
    for (const base::ReadingBlock& block : farm.tick(base::nanoseconds(0.05 * tick), reports))
      if (block.type == sensors::kOccupancy) words.assign(block.values.begin(), block.values.end());
  }
  return words;
}

maps::OccupancyGrid grid_of(const world::World& world, const std::vector<double>& words) {
  maps::OccupancyGrid grid(sensors::occupancies_of(world).at(0).settings.grid);
  std::ranges::transform(words, grid.words.begin(), [](double word) { return static_cast<std::uint32_t>(word); });
  return grid;
}

TEST(OccupancySources, OneMapShowsWhatEachSensorSees) {
  const world::World world = surveyed("sources [\"laser\" \"sonar\" \"infrared\" \"r1/sonar\"] rate 10");
  const maps::OccupancyGrid grid = grid_of(world, map_of(world, 1));
  const auto at = [&](double x, double y) { return grid.at(maps::cell_at(grid.geometry, {x, y})); };
  int wall = 0, post = 0;
  for (double y = -0.5; y < 0.5; y += 0.05)
    wall += at(1.93, y) == maps::Cell::occupied || at(1.97, y) == maps::Cell::occupied;
  for (double x = 0.45; x < 0.55; x += 0.05)
    post += at(x, 0.53) == maps::Cell::occupied || at(x, 0.57) == maps::Cell::occupied;
  EXPECT_GE(wall, 15);
  EXPECT_GE(post, 1);
  EXPECT_EQ(at(1.0, 0.2), maps::Cell::free);
  EXPECT_EQ(at(-1.0, 0.02), maps::Cell::free) << "behind r0, where only its sonar looks";
}

TEST(OccupancySources, DoNotDependOnThreadsOrDevice) {
  const world::World world = surveyed("sources [\"*/laser\" \"*/sonar\" \"infrared\"] rate 10");
  const std::vector<double> one = map_of(world, 1);
  EXPECT_TRUE(std::ranges::any_of(one, [](double word) { return word != 0.0; }));
  EXPECT_EQ(one, map_of(world, 4));
  EXPECT_EQ(one, map_of(world, 2, device()));
}

struct Readings {
  std::vector<std::vector<double>> values;
  std::vector<base::ReadingBlock> blocks;
};

/// Readings of all sensors of both robots, in order of type.
Readings readings_at(std::uint32_t sequence) {
  Readings all;
  for (const auto& [type, count] : {std::pair{sensors::kLaser, 61u}, {sensors::kSonar, 4u}, {sensors::kInfrared, 2u}})
    for (std::uint32_t m = 0; m < 2; ++m) {
      all.values.emplace_back(count, 0.7 + 0.01 * m + 0.001 * sequence);
      all.blocks.push_back(
          {.mover = m, .type = type, .sequence = sequence, .X_WM = {0.1 * m, 0.0, 0.0, 0.2 * sequence}});
    }
  for (std::size_t k = 0; k < all.blocks.size(); ++k) all.blocks[k].values = all.values[k];
  return all;
}

TEST(OccupancySources, DoNotDependOnTheOrderWithinATick) {
  const world::World world = surveyed("sources [\"*/laser\" \"*/sonar\" \"*/infrared\"]");
  const std::vector<sensors::Occupancy> settings = sensors::occupancies_of(world);
  base::ThreadPool pool{2};
  sensors::SourceMaps forward(world, settings, pool), backward(world, settings, pool);
  for (std::uint32_t k = 0; k < 8; ++k) {
    Readings readings = readings_at(k);
    forward.observe(readings.blocks);
    std::ranges::reverse(readings.blocks);
    backward.observe(readings.blocks);
  }
  EXPECT_TRUE(std::ranges::equal(forward.words(0), backward.words(0)));
  EXPECT_TRUE(std::ranges::any_of(forward.words(0), [](std::uint32_t word) { return word != 0; }));
}

TEST(OccupancySources, TransducersThatDidNotFireSayNothing) {
  const world::World world = surveyed("sources [\"sonar\"]");
  sensors::RangeSource source(world, {sensors::kSonar, 0, 0});
  const std::vector<double> ranges{1.0, 1.0, 3.0, 1.0};
  std::vector<base::QualityFlag> quality(4, base::QualityFlag::none);
  base::ReadingBlock reading{.type = sensors::kSonar, .sequence = 4, .values = ranges};
  EXPECT_EQ(source.cones(reading, {}).size(), 4u) << "the first reading is one of all";
  reading.sequence = 6;
  const auto fired = source.cones(reading, {});
  ASSERT_EQ(fired.size(), 2u) << "two of four in turn";
  EXPECT_NEAR(fired[0].X_WC.yaw, M_PI / 2, 1e-12);
  EXPECT_TRUE(fired[0].has_echo);
  EXPECT_NEAR(fired[0].sigma, std::hypot(0.02, 0.01), 1e-12);
  EXPECT_NEAR(fired[0].half, 12.5 * M_PI / 180.0, 1e-12);
  EXPECT_FALSE(fired[1].has_echo) << "at range_max";
  quality[3] = base::QualityFlag::too_near;
  reading.sequence = 7, reading.quality = quality;
  EXPECT_TRUE(source.cones(reading, {}).empty());
}

TEST(OccupancySources, GrazingSurfacesThatReturnNoEchoWeakenFreeSpace) {
  const world::World world = surveyed("sources [\"sonar\"]", "sonar( scount 1 spose[0] [0 0 0] incidence 45 )");
  sensors::RangeSource source(world, {sensors::kSonar, 0, 0});
  const std::vector<double> ranges{4.0};
  const auto cones = source.cones({.type = sensors::kSonar, .values = ranges}, {});
  ASSERT_EQ(cones.size(), 1u);
  EXPECT_NEAR(cones[0].seen, 0.5, 1e-9);
}

TEST(OccupancySources, OfOtherRobotsNeedOneProcess) {
  const auto refusal = [](const std::string& map) {
    const world::World world = surveyed(map);
    return refusal_of([&] { const farm::Farm farm(world, host_device(), {.threads = 1, .shared = true}); });
  };
  EXPECT_EQ(refusal("sources [\"laser\"]"), "");
  const std::string error = refusal("sources [\"laser\" \"r1/sonar\"]");
  expect_in("has sources of other robots, which several processes cannot share", error);
  EXPECT_TRUE(error.starts_with("surveyed.world:2:")) << error;
}

TEST(OccupancySources, GoOnWhenRobotsJoin) {
  const world::World world = surveyed("sources [\"laser\" \"sonar\"]");
  const std::vector<sensors::Occupancy> settings = sensors::occupancies_of(world);
  base::ThreadPool pool{1};
  sensors::SourceMaps all(world, settings, pool), before(world, settings, pool), after(world, settings, pool);
  for (std::uint32_t k = 0; k < 6; ++k) {
    const Readings readings = readings_at(k);
    all.observe(readings.blocks);
    (k < 3 ? before : after).observe(readings.blocks);
    if (k == 2) after.take_over(before, 1);
  }
  EXPECT_TRUE(std::ranges::equal(all.words(0), after.words(0)));
}

}  // namespace
}  // namespace sf::trial
