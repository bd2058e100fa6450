#include "scenarios/positioning.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "control/stop_reason.h"
#include "robots/estimation/chi_square.h"
#include "scenarios/scenario.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/device.h"
#include "tests/instrumented.h"
#include "tests/robots/estimation/reference.h"
#include "tests/units.h"
#include "tests/world/read_world.h"

namespace sf::scenarios {
namespace {

constexpr base::Pose kHere{1.0, 2.0, 0.5, 3.1};

std::vector<control::MeasuredPose> poses(const PositioningOptions& options, int ticks, std::uint32_t robot = 7) {
  Positioning positioning(options, robot);
  std::vector<control::MeasuredPose> all;
  for (int tick = 0; tick < ticks; ++tick) {
    positioning.measure(tick * kTick, kHere);
    for (const control::MeasuredPose& pose : positioning.receive(tick * kTick)) all.push_back(pose);
  }
  return all;
}

TEST(Positioning, MeasuresAtItsRateOutsideOfOutages) {
  const auto all = poses({.rate = 5.0, .outages = {{0.4, 1.0}, {1.5, 1.6}}}, 21);
  std::vector<std::int64_t> ticks;
  for (const control::MeasuredPose& pose : all) ticks.push_back(pose.time / kTick);
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{0, 2, 10, 12, 14, 16, 18, 20}));
  EXPECT_EQ(all[0].X_WM.x, kHere.x);
  EXPECT_EQ(all[0].X_WM.z, kHere.z);
  EXPECT_DOUBLE_EQ(all[0].covariance[0], 1e-6) << "of a millimetre, without noise";
}

TEST(Positioning, StatesItsNoiseOrWhatItIsTold) {
  const PositioningOptions noisy{.position_sigma = 0.02, .yaw_sigma = 0.1};
  double squares = 0.0, turned = 0.0;
  const auto all = poses(noisy, 2000);
  for (const control::MeasuredPose& pose : all) {
    squares += std::pow(pose.X_WM.x - kHere.x, 2) + std::pow(pose.X_WM.y - kHere.y, 2);
    turned += std::pow(base::wrap_angle(pose.X_WM.yaw - kHere.yaw), 2);
  }
  EXPECT_NEAR(squares / 4000.0, all[0].covariance[0], 0.1 * all[0].covariance[0]);
  EXPECT_NEAR(turned / 2000.0, all[0].covariance[5], 0.1 * all[0].covariance[5]);
  EXPECT_EQ(poses(noisy, 3)[2].X_WM.x, all[2].X_WM.x) << "the draws are counted";
  EXPECT_NE(poses(noisy, 3, 8)[2].X_WM.x, all[2].X_WM.x) << "each robot has its own";
  PositioningOptions told = noisy;
  told.stated_position_sigma = 0.5;
  told.stated_yaw_sigma = 0.25;
  EXPECT_EQ(poses(told, 1)[0].covariance, (std::array<double, 6>{0.25, 0.0, 0.0, 0.25, 0.0, 0.0625}));
  EXPECT_EQ(poses(told, 1)[0].X_WM.x, all[0].X_WM.x);
}

TEST(Positioning, PosesAreLateOutOfOrderAndLost) {
  const auto all = poses({.link = {.delay = 0.2, .jitter = 0.5, .loss = 0.25}}, 1000);
  EXPECT_NEAR(static_cast<double>(all.size()), 750.0, 60.0);
  int overtaken = 0;
  for (std::size_t i = 1; i < all.size(); ++i) overtaken += all[i].time < all[i - 1].time;
  EXPECT_GT(overtaken, 50);
  EXPECT_TRUE(poses({.link = {.delay = 0.2}}, 2).empty()) << "under way";
  EXPECT_EQ(poses({.link = {.delay = 0.2}}, 3).size(), 1u);
  EXPECT_THROW(Positioning({.link = {.delay = 0.6, .jitter = 0.5}}, 7), base::InputError) << "too late to be used";
}

/// A robot whose encoders count 5 % too much drives around a square at 0.1 m/s.
struct Round {
  explicit Round(std::uint64_t seed)
      : Round(seed, {.link = {.delay = 0.1, .jitter = 0.2, .loss = 0.1},
                     .position_sigma = 0.005,
                     .yaw_sigma = 0.01,
                     .outages = {{60.0, 80.0}}}) {}
  Round(std::uint64_t seed, PositioningOptions positioning)
      : simulation(world, device(),
                   {.seed = seed,
                    .actor = {.controller = {"patrol",
                                             0.0,
                                             {"controller 'patrol'",
                                              {{"points", std::vector{1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0}},
                                               {"pause", 0.0},
                                               {"speed", 0.1}}}},
                              .link = {}},
                    .positioning = (positioning.link.seed = seed, positioning)}) {}
  /// Drives until `end` [s]. Returns the normalised squared error of the estimate.
  double drive(double end) {
    base::TickRecord tick = simulation.step();
    while (1e-9 * static_cast<double>(tick.time) < end - 0.01) tick = simulation.step();
    truth = tick.reports[0].X_WM;
    const auto& [state, quality] = simulation.estimate(0);
    const auto& P = quality.covariance;
    const std::array<double, 3> e{state.X_WM.x - truth.x, state.X_WM.y - truth.y,
                                  base::wrap_angle(state.X_WM.yaw - truth.yaw)};
    error = std::hypot(e[0], e[1]);
    estimation::reference::Matrix covariance{};
    for (int i = 3; i < 6; ++i) covariance[i][i] = 1.0;
    const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) covariance[i][j] = P[at[i][j]];
    const estimation::reference::Matrix information = estimation::reference::inverse(covariance);
    double sum = 0.0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sum += e[i] * information[i][j] * e[j];
    return sum;
  }

  world::World world = world::read_world(
      "define robot position( size [0.33 0.33 0.1] drive \"diff\" track 0.258\n"
      "  encoder( per_count 0.001 track 0.258 slip 0.001 scale [1.05 1.05] ) )\n"
      "robot( name \"create\" pose [0 0 0 0] )\n",
      {.sensors = sensors::world_file_words()});
  Simulation simulation;
  base::Pose truth;
  double error = 0.0;  ///< [m]
};

/// Satellites do not show its heading.
TEST(Positioning, ARobotSeenBySatellitesAloneIsLost) {
  const world::World world = world::read_world(
      "define robot position( size [0.3 0.3 0.1] drive \"diff\" track 0.258 encoder( track 0.258 ) gps( noise 0.01 ) "
      ")\n"
      "robot( name \"a\" pose [3 4 0 120] )\n",
      {.sensors = sensors::world_file_words()});
  PositioningOptions cameras{.known_start = false, .link = {.delay = 0.1}, .outages = {{0.0, 1.0}}};
  Simulation simulation(world, device(),
                        {.actor = {.controller = {"wander", 0.0, {}}, .link = {}}, .positioning = cameras});
  for (int i = 0; i < 10; ++i) simulation.step();
  EXPECT_EQ(simulation.estimate(0).quality.age, base::kNoStateYet);
  for (int i = 0; i < 5; ++i) simulation.step();
  EXPECT_NE(simulation.estimate(0).quality.age, base::kNoStateYet);
  EXPECT_NEAR(base::wrap_angle(simulation.estimate(0).state.X_WM.yaw - 2.0 * M_PI / 3.0), 0.0, 0.3);
}

/// In its process a robot is lost until a camera sees it (server/own_state.h).
TEST(Positioning, ARobotWithAnUnknownStartRestsUntilItIsSeen) {
  const auto with = [](bool known) {
    return Round(1, {.known_start = known, .position_sigma = 0.005, .yaw_sigma = 0.01, .outages = {{0.0, 1.0}}});
  };
  Round known = with(true), unknown = with(false);
  known.drive(0.9);
  EXPECT_GT(known.truth.x, 0.05) << "it drives by its wheels";
  base::TickRecord tick = unknown.simulation.step();
  for (int i = 0; i < 9; ++i) tick = unknown.simulation.step();
  EXPECT_EQ(tick.reports[0].X_WM.x, 0.0);
  EXPECT_EQ(unknown.simulation.estimate(0).quality.age, base::kNoStateYet);
  EXPECT_EQ(control::stop_reason_of(*unknown.simulation.controller(0)),
            "its pose is unknown: no camera has seen it yet");
  unknown.drive(4.0);
  EXPECT_GT(unknown.truth.x, 0.1);
  EXPECT_LT(unknown.error, 0.02);
}

TEST(Positioning, ARobotLearnsItsScaleAndCoastsThroughAnOutage) {
  const int seeds = instrumented() ? 5 : 100;
  const double tail = instrumented() ? 1e-4 : 0.025;
  double seen = 0.0, lost = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    Round round(static_cast<std::uint64_t>(seed));
    seen += round.drive(60.0);
    EXPECT_LT(round.error, 0.02) << seed;
    lost += round.drive(80.0);
    EXPECT_LT(round.error, 0.04) << seed;
  }
  for (const double sum : {seen, lost}) {
    EXPECT_GT(sum, estimation::chi_square_limit(3 * seeds, 1.0 - tail)) << "the covariance is too large";
    EXPECT_LT(sum, estimation::chi_square_limit(3 * seeds, tail)) << "the covariance is too small";
  }
}

TEST(Positioning, ReachesOnlyRobotsThatLocalizeThemselves) {
  const world::World world = world::read_world(
      "define robot position( size [0.33 0.33 0.1] drive \"diff\" )\nrobot( name \"create\" pose [0 0 0 0] )\n",
      {.sensors = sensors::world_file_words()});
  const Simulation simulation(world, device(), {.positioning = PositioningOptions{}});
  ASSERT_EQ(simulation.warnings().size(), 1u);
  EXPECT_NE(simulation.warnings()[0].message.find("expected a robot with a controller and encoder"), std::string::npos);
  EXPECT_TRUE(Round(1).simulation.warnings().empty());
}

}  // namespace
}  // namespace sf::scenarios
