// The derived sensor `tracks`: objects in the world frame from unlike sensors of two robots, decisions, and refusals.

#include "sensors/tracks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/time.h"
#include "farm/farm.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/host_trial.h"
#include "world/stage/build_world.h"

namespace sf::trial {
namespace {

using TrackRow = std::array<double, sensors::kTrackNumbers>;

world::World tracked(const std::string& derived) {
  return world::build_world(
      "tracked.world",
      "define bot position( size [0.3 0.3 0.2] drive \"diff\" encoder( per_count 0.001 slip 0.001 ) gyro( noise 0.1 )\n"
      "laser( samples 361 fov 180 range_max 6 noise [0.01 0 0] )\n"
      "sonar( scount 1 spose[0] [0.15 0 0] fov 20 range [0.1 5] rate 10 noise [0.02 0] )\n"
      "derived( type \"localization\" inputs [\"encoder\" \"gyro\"] rate 20 )\n"
      "derived( type \"features\" name \"scan\" inputs [\"laser\"] )\n"
      "derived( type \"features\" name \"echo\" inputs [\"sonar\"] )\n" +
          derived +
          " )\nbot( name \"r0\" pose [0 0 0 0] )\nbot( name \"r1\" pose [3 -2 0 90] )\n"
          "model( name \"post\" pose [3 0 0 0] size [0.1 0.1 0.5] )\n"
          "define target position( size [0.2 0.2 0.5] drive \"omni\" )\ntarget( name \"t\" pose [2 2.3 0 0] )\n",
      {.sensors = sensors::world_file_words()});
}

/// r0 drives at 0.2 m/s, r1 stands, t moves to the right of r0 at 0.4 m/s. Returns the valid rows after `seconds`.
std::vector<TrackRow> rows_after(const world::World& world, double seconds) {
  farm::Farm farm(world, host_device(), {.seed = 1, .threads = 1});
  farm.subscribe(0, base::only(sensors::kTracks));
  std::vector<TrackRow> rows;
  for (int tick = 0; tick <= std::lround(10.0 * seconds); ++tick) {
    const double t = 0.1 * tick;
    const std::int64_t now = base::nanoseconds(t);
    const base::Report reports[] = {{0, now, {0.2 * t, 0, 0, 0}, {0.2, 0, 0}},
                                    {1, now, world.movers[1].X_WM, {}},
                                    {2, now, {2.0, 2.3 - 0.4 * t, 0, 0}, {0, -0.4, 0}}};
    for (const base::ReadingBlock& block : farm.tick(now, reports)) {
      if (block.type != sensors::kTracks) continue;
      rows.clear();
      for (std::size_t at = 0; at < block.values.size(); at += sensors::kTrackNumbers) {
        TrackRow row;
        std::copy_n(block.values.begin() + static_cast<std::ptrdiff_t>(at), row.size(), row.begin());
        if (row[sensors::kTrackValidAt] != 0.0) rows.push_back(row);
      }
    }
  }
  return rows;
}

const TrackRow* row_near(const std::vector<TrackRow>& rows, glm::dvec2 p, double within = 0.3) {
  for (const TrackRow& row : rows)
    if (std::hypot(row[0] - p.x, row[1] - p.y) < within && row[sensors::kTrackKindAt] != 3.0) return &row;
  return nullptr;
}

const std::string kBoth =
    "derived( type \"tracks\" inputs [\"*/features:0\" \"*/features:1\" \"*/localization\"] rate 10 )";

TEST(Tracks, OfTwoRobotsAreObjectsAtRestAndMoving) {
  const auto rows = rows_after(tracked(kBoth), 4.0);
  const TrackRow* const post = row_near(rows, {2.95, 0.0});
  const TrackRow* const target = row_near(rows, {2.0, 0.7});
  ASSERT_NE(post, nullptr);
  ASSERT_NE(target, nullptr);
  EXPECT_EQ((*post)[sensors::kTrackKindAt], 1.0);
  EXPECT_EQ((*target)[sensors::kTrackKindAt], 2.0);
  EXPECT_NEAR((*target)[3], -0.4, 0.1);
  EXPECT_NEAR((*target)[2], 0.0, 0.1);
  EXPECT_NE((*post)[sensors::kTrackIdentityAt], (*target)[sensors::kTrackIdentityAt]);
  EXPECT_NEAR((*post)[sensors::kTrackAheadAt], 2.15, 0.2) << "in the corridor of r0";
  EXPECT_NEAR((*post)[sensors::kTrackContactAt], (2.15 - 0.15) / 0.2, 2.0);
  EXPECT_TRUE(std::isnan((*target)[sensors::kTrackAheadAt]));
  EXPECT_GT((*post)[sensors::kTrackCovarianceAt], 0.0);
}

TEST(Tracks, OfOneRobotFromOneSensor) {
  const auto rows =
      rows_after(tracked("derived( type \"tracks\" inputs [\"features:0\" \"localization\"] rate 10 most 2 )"), 4.0);
  ASSERT_LE(rows.size(), 2u);
  EXPECT_NE(row_near(rows, {2.0, 0.7}), nullptr) << "moving objects come first";
}

TEST(Tracks, EchoesOfConesAreInFrontOfTheirObjects) {
  const auto x_of = [](const std::string& extent) {
    const auto rows =
        rows_after(tracked("derived( type \"tracks\" inputs [\"features:1\" \"localization\"] " + extent + " )"), 4.0);
    const TrackRow* const post = row_near(rows, {3.0, 0.0});
    return post == nullptr ? std::pair(0.0, 0.0) : std::pair((*post)[0], (*post)[sensors::kTrackCovarianceAt]);
  };
  const auto [surface, least] = x_of("extent 0");
  const auto [middle, more] = x_of("extent 0.2");
  EXPECT_NEAR(middle - surface, 0.2, 0.02);
  EXPECT_NEAR(more - least, 0.01, 0.005) << "the extent is known to its half";
  EXPECT_NEAR(x_of("").first - surface, std::hypot(0.15, 0.15), 0.02) << "the default: as large as the robot";
}

/// A car of 12 m/s ahead of one of 20 m/s, which has a radar and the pose that its encoders state.
TEST(Tracks, ACarAheadIsTrackedWithinItsStatedErrorsByItsClosingSpeed) {
  const world::World world = world::build_world(
      "radar.world",
      "define car position( size [4 2 1.5] velocity_bounds [-40 40 0 0 0 0 -90 90] )\n"
      "car( name \"r0\" encoder( per_count 0.01 slip 0.001 track 1.5 )\n"
      "  radar( targets 4 range [1 120] fov 60 noise [0.2 0.3 0.1] rate 10 pose6 [2 0 -0.9 0 0 0] )\n"
      "  derived( type \"localization\" inputs [\"encoder\"] rate 20 )\n"
      "  derived( type \"tracks\" inputs [\"radar\" \"localization\"] speed 10 agility 1 extent 2 rate 10 ) )\n"
      "car( name \"ahead\" pose [60 0 0 0] )\n",
      {.sensors = sensors::world_file_words()});
  farm::Farm farm(world, host_device(), {.seed = 1, .threads = 1});
  farm.subscribe(0, base::only(sensors::kTracks));
  double nees = 0.0;
  int count = 0;
  for (int tick = 0; tick <= 50; ++tick) {
    const double t = 0.1 * tick;
    const std::int64_t now = base::nanoseconds(t);
    const base::Report reports[] = {{0, now, {20.0 * t, 0, 0, 0}, {20, 0, 0}},
                                    {1, now, {60.0 + 12.0 * t, 0, 0, 0}, {12, 0, 0}}};
    for (const base::ReadingBlock& block : farm.tick(now, reports)) {
      if (block.type != sensors::kTracks || tick < 15) continue;
      const std::span<const double> row = block.values.first(sensors::kTrackNumbers);
      ASSERT_EQ(row[sensors::kTrackValidAt], 1.0);
      EXPECT_EQ(row[sensors::kTrackKindAt], 2.0);
      EXPECT_NEAR(row[0], 60.0 + 12.0 * t, 1.5);
      EXPECT_NEAR(row[2], 12.0, 0.5) << "along the line of sight";
      EXPECT_NEAR(row[sensors::kTrackAheadAt], 60.0 - 8.0 * t, 1.5);
      const double variance = row[sensors::kTrackCovarianceAt + 7];  // of vx
      EXPECT_LT(variance, 0.1);
      nees += (row[2] - 12.0) * (row[2] - 12.0) / variance, ++count;
    }
  }
  EXPECT_GT(count, 30);
  EXPECT_LT(nees / count, 4.0) << "the speed's error is as stated";
}

TEST(Tracks, RefusesFeaturesWithoutAPose) {
  const auto refusal = [](const std::string& more) {
    return refusal_of([&] { const sensors::SensorSet all(tracked("derived( type \"tracks\" " + more + " )")); });
  };
  EXPECT_EQ(refusal("inputs [\"features\" \"localization\"]"), "");
  expect_in("expected 1 to", refusal("inputs [\"features\"]"));
  expect_in("need one pose of 'r0'", refusal("inputs [\"features\" \"r1/localization\"]"));
  expect_in("'localization' is listed twice", refusal("inputs [\"features\" \"localization\" \"localization\"]"));
  expect_in("'r1/localization' is listed twice",
            refusal("inputs [\"features\" \"localization\" \"r1/localization\" \"r1/localization\"]"));
  expect_in("expected features", refusal("inputs [\"laser\" \"localization\"]"));
  expect_in("'most'", refusal("inputs [\"features\" \"localization\"] most 16"));
  expect_in("'extent'", refusal("inputs [\"features\" \"localization\"] extent -1"));
  expect_in("'keep'", refusal("inputs [\"features\" \"localization\"] keep 0"));
  expect_in("'agility'", refusal("inputs [\"features\" \"localization\"] agility -1"));
  expect_in("'speed'", refusal("inputs [\"features\" \"localization\"] speed 0"));
  expect_in("need features or a radar", refusal("inputs [\"localization\"]"));
}

}  // namespace
}  // namespace sf::trial
