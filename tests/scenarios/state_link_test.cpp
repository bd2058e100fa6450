#include "scenarios/state_link.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/time.h"
#include "robots/kinematics.h"
#include "scenarios/lane_errors.h"
#include "scenarios/scenario.h"
#include "scenarios/trial.h"
#include "tests/device.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::scenarios {
namespace {

using base::kSecond;

/// A robot on a circle of 1 m at 0.5 m/s, in the farm's states.
struct Circle {
  explicit Circle(const StateLinkOptions& options) : world(scenes::boxed_world(20.0, 20.0, {-10.0, -10.0})) {
    scenes::add_square(world, {});
    states.emplace(world, options);
  }
  /// [m] Returns the distance between the true position and the farm's at tick k.
  double step(int k) {
    const base::Twist twist{0.5, 0.0, 0.5};
    const base::Report truth{0, k * kTick, robots::advance({}, twist, 0.1 * k), twist};
    const base::Report known = states->pass(k * kTick, {&truth, 1})[0];
    return std::hypot(known.X_WM.x - truth.X_WM.x, known.X_WM.y - truth.X_WM.y);
  }
  double worst(int from, int to) {
    double error = 0.0;
    for (int k = 0; k < to; ++k) error = std::max(k < from ? 0.0 : error, step(k));
    return error;
  }
  world::World world;
  std::optional<StateLink> states;
};

TEST(StateLink, APerfectLinkGivesTheTruth) {
  EXPECT_EQ(Circle({}).worst(0, 50), 0.0);
  EXPECT_LT(Circle({.filter = true}).worst(0, 50), 1e-9);
}

TEST(StateLink, WithoutFilterAStateIsAsOldAsItsDelay) {
  // 0.3 s at 0.5 m/s are chords of 0.15 m.
  EXPECT_NEAR(Circle({.link = {.delay = 0.3}}).worst(10, 50), 2.0 * std::sin(0.5 * 0.15), 1e-6);
}

TEST(StateLink, TheFilterPredictsOverDelayJitterAndLoss) {
  const netio::LinkModel link{.delay = 0.25, .jitter = 0.1, .loss = 0.1, .seed = 5};
  EXPECT_GT(Circle({.link = link}).worst(50, 200), 0.1);
  EXPECT_LT(Circle({.link = link, .filter = true}).worst(50, 200), 0.02);
}

TEST(StateLink, StatesArriveAtTheirRate) {
  // One state in half a second, extrapolated in between: exact for constant twists.
  EXPECT_LT(Circle({.rate = 2.0}).worst(0, 50), 1e-9);
  Circle silent({.link = {.loss = 1.0}});
  EXPECT_NEAR(silent.worst(0, 20), 2.0 * std::sin(0.5 * 0.95), 1e-9) << "it stays where it was at load";
}

/// Means of three runs of experiments/late-states.toml.
/// @param filter nullopt: true states
LaneErrors drive(double speed, std::optional<bool> filter) {
  LaneErrors mean;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/late-states.toml");
    scenario.seed = seed;
    scenario.actor.controller.settings = {"controller 'lane-keeping'", {{"speed", speed, ""}}};
    if (filter)
      scenario.states->filter = *filter;
    else
      scenario.states.reset();
    const world::World world = disturbed_world(scenario, {});
    const Trial trial = run_trial(scenario, world, device(), {});
    EXPECT_TRUE(trial.done);
    const LaneErrors errors = lane_errors(trial.tracks.front(), world.paths.front());
    EXPECT_FALSE(errors.left_lane);
    mean.mean_abs += errors.mean_abs / 3.0;
    mean.amplitude += errors.amplitude / 3.0;
  }
  return mean;
}

// The figures of docs/experiments.md.
TEST(LateStates, TheFilterKeepsTheLaneLikeTrueStates) {
  for (const double speed : {0.1, 0.5}) {
    const LaneErrors truth = drive(speed, {}), newest = drive(speed, false), filtered = drive(speed, true);
    SCOPED_TRACE(fmt::format("{} m/s: mean |e| {:.4f}, {:.4f}, {:.4f} m; amplitude {:.4f}, {:.4f}, {:.4f} m", speed,
                             truth.mean_abs, newest.mean_abs, filtered.mean_abs, truth.amplitude, newest.amplitude,
                             filtered.amplitude));
    EXPECT_LT(std::abs(filtered.mean_abs - truth.mean_abs), std::abs(newest.mean_abs - truth.mean_abs));
    EXPECT_LT(filtered.amplitude, newest.amplitude);
    EXPECT_LT(filtered.mean_abs, truth.mean_abs + 5e-4);
  }
}

TEST(LaneErrors, AmplitudeMatchesASineOnTheStraight) {
  const world::Path path{"lane", {{{}, 4.0, 0.0, 0.5}}};
  viz::Track track;
  for (int i = 0; i <= 400; ++i) track.poses.push_back({0.01 * i, 0.1 + 0.05 * std::sin(0.01 * i * 2.0 * M_PI / 0.4)});
  const LaneErrors errors = lane_errors(track, path);
  EXPECT_NEAR(errors.amplitude, 0.05, 5e-4) << "four periods";
  EXPECT_NEAR(errors.mean_abs, 0.1, 1e-3);
  EXPECT_NEAR(errors.max_abs, 0.15, 1e-9);
  EXPECT_FALSE(errors.left_lane);
  track.poses.push_back({1.0, -0.251});
  EXPECT_TRUE(lane_errors(track, path).left_lane);
  EXPECT_EQ(lane_errors({}, path).amplitude, 0.0) << "no poses";
}

}  // namespace
}  // namespace sf::scenarios
