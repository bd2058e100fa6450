// The derived sensor `features`: rows of each kind of input, readings without inputs, and refused settings.

#include "sensors/features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/time.h"
#include "farm/farm.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/host_trial.h"
#include "world/stage/build_world.h"

namespace sf::trial {
namespace {

world::World featured(const std::string& sensors, const std::string& derived) {
  return world::build_world("featured.world",
                            "define bot position( size [0.3 0.3 0.1] drive \"diff\" " + sensors +
                                " derived( type \"features\" " + derived +
                                " ) )\nbot( name \"r0\" pose [1 2 0 90] )\n"
                                "model( name \"post\" pose [1 3 0 0] size [0.1 0.1 0.5] fiducial_return 7 )\n"
                                "model( name \"wall\" pose [3 2 0 0] size [0.1 4 0.5] )\n",
                            {.sensors = sensors::world_file_words()});
}

using Rows = std::vector<std::array<double, sensors::kFeatureNumbers>>;

Rows rows_of(const base::ReadingBlock& block) {
  Rows rows(block.values.size() / sensors::kFeatureNumbers);
  for (std::size_t k = 0; k < rows.size(); ++k)
    std::copy_n(block.values.begin() + static_cast<std::ptrdiff_t>(sensors::kFeatureNumbers * k),
                sensors::kFeatureNumbers, rows[k].begin());
  return rows;
}

/// Returns the readings of the first second at rest.
std::vector<Rows> readings_of(const world::World& world) {
  farm::Farm farm(world, host_device(), {.seed = 1, .threads = 1});
  farm.subscribe(0, base::only(sensors::kFeatures));
  std::vector<Rows> all;
  for (int tick = 0; tick <= 10; ++tick) {
    const base::Report report{0, 0, world.movers[0].X_WM, {}};
    for (const base::ReadingBlock& block : farm.tick(base::nanoseconds(0.1 * tick), {&report, 1}))
      if (block.type == sensors::kFeatures) all.push_back(rows_of(block));
  }
  return all;
}

const std::string kScanner = "laser( samples 361 fov 180 range_max 5 noise [0.005 0 0] )";

TEST(Features, OfALaserAreAClusterAndALineInTheRobotsFrame) {
  const auto all = readings_of(featured(kScanner, "inputs [\"laser\"] most 4"));
  ASSERT_EQ(all.size(), 11u);
  for (const Rows& rows : all) {
    ASSERT_EQ(rows.size(), 4u);
    const auto &post = rows[0], &wall = rows[1];
    EXPECT_EQ(post[sensors::kFeatureKindAt], 3.0);
    EXPECT_NEAR(post[0], 0.95, 0.03);
    EXPECT_NEAR(post[1], 0.0, 0.03);
    EXPECT_TRUE(std::isnan(post[2])) << "no direction";
    EXPECT_EQ(post[3], 1.0);
    EXPECT_GT(post[4], 0.0);
    EXPECT_EQ(wall[sensors::kFeatureKindAt], 1.0);
    EXPECT_NEAR(wall[1], -1.95, 0.03) << "to the right";
    EXPECT_LT(std::abs(wall[2]), 0.05) << "along the robot's x";
    EXPECT_EQ(wall[3], 1.0);
    EXPECT_EQ(rows[3][3], 0.0) << "no more features";
    EXPECT_TRUE(std::isnan(rows[3][0]));
    EXPECT_EQ(rows[3][sensors::kFeatureKindAt], 0.0);
  }
}

TEST(Features, OfALidarAreAboveTheGroundAndBelowBridges) {
  const std::string lidar =
      "lidar( channels 48 fov_v [-30 10] columns 241 fov 120 range [0.3 40] noise [0.01 0] pose6 [0 0 0.9 0 3 0] ) ";
  const auto rows_in = [&](const std::string& more) {
    const world::World world = world::build_world(
        "featured.world",
        "define bot position( size [0.3 0.3 0.1] drive \"diff\" " + lidar +
            "derived( type \"features\" inputs [\"lidar\"] shortest 5.5 widest 5 objects [4.2 1.7] ) )\n"
            "bot( name \"r0\" pose [0 0 0 0] )\n" +
            more,
        {.sensors = sensors::world_file_words()});
    Rows valid = readings_of(world).back();
    std::erase_if(valid, [](const auto& row) { return row[3] == 0.0; });
    return valid;
  };
  EXPECT_TRUE(rows_in("").empty()) << "the floor is no obstacle";
  EXPECT_TRUE(rows_in("model( pose [10 0 3 0] size [4 8 0.3] )\n").empty()) << "a bridge is overhead";
  const Rows rows =
      rows_in("model( pose [12 1 0 20] size [4.2 1.7 1.4] )\nmodel( pose [15 -6 0 0] size [0.4 0.4 2] )\n");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0][sensors::kFeatureKindAt], 5.0) << "as large as a car";
  EXPECT_NEAR(rows[0][0], 12.0, 0.3);
  EXPECT_NEAR(rows[0][1], 1.0, 0.3);
  EXPECT_EQ(rows[1][sensors::kFeatureKindAt], 3.0) << "a trunk";
  EXPECT_NEAR(rows[1][0], 14.9, 0.15);
}

/// Returns the valid features that a camera 1.3 m above the floor sees in the models, over ten readings.
std::vector<Rows> in_image_of(const std::string& models, const std::string& more = "") {
  const world::World world = world::build_world(
      "featured.world",
      "define bot position( size [0.3 0.3 1.3] drive \"diff\" camera( resolution [320 120] fov 70 range [0.3 40] " +
          more +
          " pose6 [0 0 0 0 5 0] size [0 0 0] ) derived( type \"features\" inputs [\"camera\"] shortest 5.5 widest 5 "
          "objects [4.2 1.7] ) )\nbot( name \"r0\" pose [0 0 0 0] )\n" +
          models,
      {.sensors = sensors::world_file_words()});
  std::vector<Rows> all = readings_of(world);
  for (Rows& rows : all) std::erase_if(rows, [](const auto& row) { return row[3] == 0.0; });
  return all;
}

TEST(Features, OfADepthImageAreAboveTheGroundAndInTheRobotsFrame) {
  EXPECT_TRUE(in_image_of("").back().empty()) << "neither the floor nor pixels without a surface are obstacles";
  const Rows wall = in_image_of("model( pose [12 0 0 0] size [0.2 6 3] )\n").back();
  ASSERT_EQ(wall.size(), 1u);
  EXPECT_EQ(wall[0][sensors::kFeatureKindAt], 1.0);
  EXPECT_NEAR(wall[0][0], 11.9, 0.01);
  EXPECT_NEAR(std::abs(wall[0][2]), 0.5 * M_PI, 0.01) << "across";
  EXPECT_NEAR(wall[0][sensors::kFeatureKindAt + 1], 3.0, 0.06);
  // Aside, depth along the optical axis is shorter than the range, here by 1.2 m.
  const Rows car = in_image_of("model( pose [14 6 0 20] size [4.2 1.7 1.4] )\n").back();
  ASSERT_EQ(car.size(), 1u);
  EXPECT_EQ(car[0][sensors::kFeatureKindAt], 5.0) << "as large as a car";
  EXPECT_NEAR(car[0][0], 14.0, 0.3);
  EXPECT_NEAR(car[0][1], 6.0, 0.3);
}

/// The nearest of a column's depths would be off by its noise: the mean of them is not.
TEST(Features, OfNoisyDepthsAreNotTooNear) {
  constexpr double kWall = 19.9, kSigma = 0.001 * kWall * kWall;  // [m]
  double sum = 0.0, count = 0.0;
  for (const Rows& rows : in_image_of("model( pose [20 0 0 0] size [0.2 8 3] )\n", "depth_noise 0.001"))
    for (const auto& row : rows) {
      if (row[sensors::kFeatureKindAt] != 1.0) continue;
      ++count, sum += row[0];
      EXPECT_NEAR(row[0], kWall, 4.0 * std::sqrt(row[4])) << "as stated";
    }
  ASSERT_GE(count, 8.0) << "of ten readings";
  EXPECT_NEAR(sum / count, kWall, 0.3 * kSigma);
}

TEST(Features, OfConesStateTheirWidth) {
  const auto all = readings_of(featured(
      "sonar( scount 2 spose[0] [0.1 0 0] spose[1] [0 0 180] fov 20 range [0.1 4] rate 10 )", "inputs [\"sonar\"]"));
  const auto& first = all.back()[0];
  EXPECT_EQ(first[sensors::kFeatureKindAt], 3.0);
  EXPECT_NEAR(first[0], 0.95, 0.03);
  EXPECT_NEAR(std::sqrt(first[7]), 0.85 * std::sin(10.0 * M_PI / 180.0) / std::sqrt(3.0), 0.02);
  EXPECT_EQ(all.back()[1][3], 0.0) << "nothing behind";
  const auto near = readings_of(
      featured("infrared( scount 1 spose[0] [0 0 0] fov 20 range [0 1] noise 0.01 rate 10 )", "inputs [\"infrared\"]"));
  EXPECT_NEAR(near.back()[0][0], 0.95, 0.05);
}

TEST(Features, OfConesThatFireInTurnAreThoseOfTheLastReading) {
  const auto all = readings_of(
      featured("sonar( scount 4 spose[0] [0 0 0] spose[1] [0 0 2] spose[2] [0 0 -2] spose[3] [0 0 4] fov 20 "
               "range [0.1 4] rate 10 )",
               "inputs [\"sonar\"] most 4"));
  for (std::size_t k = 0; k < all.size(); ++k)
    EXPECT_EQ(std::ranges::count_if(all[k], [](const auto& row) { return row[3] != 0.0; }), k == 0 ? 4 : 1) << k;
}

TEST(Features, OfAFinderAreTags) {
  const auto all = readings_of(featured("fiducial( range_max 5 noise [0.01 1 1] )", "inputs [\"fiducial\"]"));
  const auto& tag = all.back()[0];
  EXPECT_EQ(tag[sensors::kFeatureKindAt], 4.0);
  EXPECT_NEAR(tag[0], 1.0, 0.05);
  EXPECT_EQ(tag[sensors::kFeatureKindAt + 2], 7.0) << "id";
}

TEST(Features, AreNotRepeatedAndStateTheirAge) {
  const auto all =
      readings_of(featured("laser( samples 181 fov 180 range_max 5 rate 2 latency 0.1 )", "inputs [\"laser\"]"));
  int valid = 0;
  for (const Rows& rows : all)
    if (rows[0][3] != 0.0) {
      ++valid;
      EXPECT_NEAR(rows[0][sensors::kFeatureKindAt + 3], 0.1, 1e-9);
    }
  EXPECT_EQ(valid, 2) << "measured at 0 and 0.5 s";
}

TEST(Features, RefusesWhatHasNone) {
  const auto refusal = [](const std::string& more) {
    return refusal_of([&] { const sensors::SensorSet all(featured(kScanner + " gyro( ) laneedge( )", more)); });
  };
  EXPECT_EQ(refusal("inputs [\"laser\"]"), "");
  expect_in("expected ranges (range_m) or depths (depth_m) or fiducial", refusal("inputs [\"gyro\"]"));
  expect_in("'laser' is listed twice", refusal("inputs [\"laser\" \"laser\"]"));
  expect_in("'most'", refusal("inputs [\"laser\"] most 23"));
  expect_in("'shortest'", refusal("inputs [\"laser\"] shortest 0"));
  expect_in("'widest'", refusal("inputs [\"laser\"] widest -1"));
  expect_in("the length not below the width", refusal("inputs [\"laser\"] objects [1 2]"));
}

}  // namespace
}  // namespace sf::trial
