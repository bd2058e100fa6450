#include "scenarios/state_link.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/time.h"
#include "robots/fleet.h"
#include "robots/kinematics.h"
#include "scenarios/scenario.h"
#include "scenarios/simulation.h"
#include "tests/device.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"
#include "world/path_geometry.h"

namespace sf::scenarios {
namespace {

using base::kSecond;

/// A robot on a circle of 1 m at 0.5 m/s, as the farm knows it.
struct Circle {
  explicit Circle(const StateLinkOptions& options) : world(scenes::boxed_world(20.0, 20.0, {-10.0, -10.0})) {
    scenes::add_square(world, {});
    states.emplace(world, options);
  }
  /// [m] from the true position to the known one at tick k.
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

TEST(StateLink, PerfectLinkShowsTheTruth) {
  EXPECT_EQ(Circle({}).worst(0, 50), 0.0);
  EXPECT_LT(Circle({.filter = true}).worst(0, 50), 1e-9);
}

TEST(StateLink, WithoutFilterAStateIsAsOldAsItsDelay) {
  // 0.3 s at 0.5 m/s are chords of 0.15 m.
  EXPECT_NEAR(Circle({.link = {.delay = 0.3}}).worst(10, 50), 2.0 * std::sin(0.5 * 0.15), 1e-6);
}

TEST(StateLink, FilterPredictsOverDelayJitterAndLoss) {
  const netio::LinkModel link{.delay = 0.25, .jitter = 0.1, .loss = 0.1, .seed = 5};
  EXPECT_GT(Circle({.link = link}).worst(50, 200), 0.1);
  EXPECT_LT(Circle({.link = link, .filter = true}).worst(50, 200), 0.02);
}

TEST(StateLink, StatesComeAtTheirRate) {
  // One state in half a second, extrapolated in between: exact for constant twists.
  EXPECT_LT(Circle({.rate = 2.0}).worst(0, 50), 1e-9);
  Circle silent({.link = {.loss = 1.0}});
  EXPECT_NEAR(silent.worst(0, 20), 2.0 * std::sin(0.5 * 0.95), 1e-9) << "it stands where it was at load";
}

struct Driving {
  double mean_abs = 0.0;   ///< [m] of the true distance to the lane's centre line
  double amplitude = 0.0;  ///< [m] of the oscillation: sqrt(2) times the standard deviation of that distance
  bool done = false;
};

constexpr const char* kLate = "[states]\nrate = 10\ndelay = 0.08\njitter = 0.02\nloss = 0.05\n";

/// The test path's robot, which starts 5 cm off the lane's centre. Numbers are means over three seeds.
Driving drive(double speed, const std::string& states) {
  Driving mean;
  mean.done = true;
  for (int seed = 1; seed <= 3; ++seed) {
    const Scenario scenario = parse_scenario(
        SF_SOURCE_DIR "/experiments/late.toml",
        fmt::format(
            "world = \"../worlds/testpath/testpath.world\"\nseed = {}\nduration = 120\n[default]\ncontroller = "
            "\"lane-keeping\"\nsettings = {{ speed = {} }}\n{}[[robot]]\nname = \"roomba0\"\npose = [0.2, 0.05, 0]\n",
            seed, speed, states));
    const world::World world = world_of(scenario);
    Simulation simulation(world, device(), simulation_of(scenario, world));
    double count = 0.0, sum = 0.0, sum_abs = 0.0, squares = 0.0, total = 0.0;
    for (base::TickRecord tick = simulation.step(); tick.time < 120 * kSecond && !simulation.all_done();
         tick = simulation.step()) {
      const base::Pose& X = tick.reports[0].X_WM;
      const world::PathProjection at = world::project_onto(world.paths[0], {X.x, X.y});
      sum_abs += std::abs(at.offset);
      ++total;
      if (at.s < 1.0 || at.s > 2.6) continue;  // behind the start, before the bend
      ++count;
      sum += at.offset;
      squares += at.offset * at.offset;
    }
    mean.done = mean.done && simulation.all_done();
    mean.mean_abs += sum_abs / total / 3.0;
    mean.amplitude += std::sqrt(2.0 * std::max(0.0, squares / count - sum * sum / (count * count))) / 3.0;
  }
  return mean;
}

// The figures of docs/experiments.md.
TEST(LateStates, FilterKeepsTheLaneAsTrueStatesDo) {
  for (const double speed : {0.1, 0.5}) {
    const Driving truth = drive(speed, "");
    const Driving newest = drive(speed, kLate);
    const Driving filtered = drive(speed, std::string(kLate) + "filter = true\n");
    const std::string figures = fmt::format(
        "{} m/s: mean |e| {:.4f}, {:.4f}, {:.4f} m; amplitude {:.4f}, {:.4f}, {:.4f} m", speed, truth.mean_abs,
        newest.mean_abs, filtered.mean_abs, truth.amplitude, newest.amplitude, filtered.amplitude);
    SCOPED_TRACE(figures);
    EXPECT_TRUE(truth.done && newest.done && filtered.done);
    EXPECT_LT(std::abs(filtered.mean_abs - truth.mean_abs), std::abs(newest.mean_abs - truth.mean_abs));
    EXPECT_LT(filtered.amplitude, newest.amplitude);
    EXPECT_LT(filtered.mean_abs, truth.mean_abs + 5e-4);
  }
}

}  // namespace
}  // namespace sf::scenarios
