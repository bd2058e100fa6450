// The thesis' path following in closed loop: runs compared with its tables, and properties of any P loop.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "scenarios/path_report.h"
#include "scenarios/simulation.h"
#include "scenarios/trial.h"
#include "sensors/sensor_type.h"
#include "tests/device.h"
#include "world/path_geometry.h"

namespace sf::scenarios {
namespace {

Scenario experiment(const std::string& name, Plant plant) {
  Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/" + name + ".toml");
  scenario.plant = plant;
  return scenario;
}

Trial run(Scenario scenario, std::uint64_t seed, const Disturbance& disturbance = {}) {
  scenario.seed = seed;
  return run_trial(scenario, disturbed_world(scenario, disturbance), device(), {.disturbance = disturbance});
}

/// Returns means of the eight columns over seeds 1 to 3, all of which must reach the end without contact.
ThesisRow mean_row(const std::string& name) {
  std::vector<ThesisRow> rows;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Trial trial = run(experiment(name, Plant::thesis), seed);
    EXPECT_TRUE(trial.done) << name << " " << seed;
    EXPECT_EQ(trial.counts[0].contacts, 0u);
    rows.push_back(row_of(trial.errors[0]));
  }
  return mean_of(rows);
}

/// Checks that the values are within a factor of 1.5 of the thesis' trials.
void expect_near_table(const std::string& name, const ThesisRow& ours) {
  const ThesisTable& table = *thesis_table(name);
  double least = HUGE_VAL, most = 0.0;
  for (const ThesisRow& row : table.trials) {
    least = std::min(least, row[4]);
    most = std::max(most, row[4]);
  }
  EXPECT_GT(ours[4], least / 1.5) << name;
  EXPECT_LT(ours[4], most * 1.5) << name;
}

TEST(PathFollowing, LaneEdgesMatchTheTable) {
  const ThesisRow p = mean_row("lane-edge-p");
  const ThesisRow pi = mean_row("lane-edge-pi");
  expect_near_table("lane-edge-p", p);
  expect_near_table("lane-edge-pi", pi);
  EXPECT_LT(pi[0], p[0]);
  EXPECT_GT(pi[0], 0.0);
}

TEST(PathFollowing, MagnetsMatchTheTable) {
  const ThesisRow p = mean_row("magnet-p");
  const ThesisRow pi = mean_row("magnet-pi");
  expect_near_table("magnet-p", p);
  expect_near_table("magnet-pi", pi);
  EXPECT_LT(pi[0], p[0]);
}

/// The heading changes by kp times the integral of the error. On a path with a right-angle turn the mean error is
/// therefore (pi / 2) / (kp T), whatever the sensor, the delay or the lane's width.
TEST(PathFollowing, TheMeanErrorOfAPLoopComesFromTheBend) {
  for (const double delay : {0.0, 0.5}) {
    Scenario scenario = experiment("lane-edge-p", Plant::ideal);
    scenario.actor.link = {.delay = delay};
    const Trial trial = run(scenario, 1, {.place = 0.0, .heading = 0.0});
    ASSERT_TRUE(trial.done);
    const double seconds = trial.times.back() - trial.times.front();
    EXPECT_NEAR(trial.errors[0].mean, 0.5 * M_PI / (0.5 * seconds), 0.1 * trial.errors[0].mean) << delay;

    // To the last digit: every error except the last was in effect for 0.1 s.
    const std::vector<double>& errors = trial.counts[0].errors;
    const double sum = std::accumulate(errors.begin(), errors.end() - 1, 0.0);
    const double turned = base::wrap_angle(trial.tracks[0].poses.back().yaw - trial.tracks[0].poses.front().yaw);
    EXPECT_NEAR(turned, 0.5 * 0.1 * sum, 0.01) << delay;
  }
}

/// Player's driver halves the radius, so the same gain steers about twice as much, and the mean error is about half.
TEST(PathFollowing, TheThesisPlantDoublesTheGain) {
  const Disturbance none{.place = 0.0, .heading = 0.0};
  const double ideal = run(experiment("lane-edge-p", Plant::ideal), 1, none).errors[0].mean;
  const double thesis = run(experiment("lane-edge-p", Plant::thesis), 1, none).errors[0].mean;
  EXPECT_NEAR(thesis / ideal, 0.5, 0.08);
}

/// The body of the shipped robot, with its own sensor and default settings, stays in the lane, including the bend and
/// the narrow end.
TEST(PathFollowing, TheShippedRobotKeepsTheLaneWithItsDefaults) {
  const world::World world =
      world::load_world(SF_SOURCE_DIR "/worlds/testpath/testpath.world", {.sensors = sensors::world_file_words()});
  for (const char* controller : {"lane-keeping", "magnet-keeping"}) {
    SimulationOptions options;
    options.actor.controller.name = controller;
    Simulation simulation(world, device(), std::move(options));
    double least = HUGE_VAL;  // [m] from the body to the lane's edge
    int ticks = 0;
    for (; ticks < 800 && !simulation.all_done(); ++ticks) {
      const base::Pose X_WM = simulation.step().reports[0].X_WM;
      const world::PathProjection at = world::project_onto(world.paths[0], {X_WM.x, X_WM.y});
      least =
          std::min(least, 0.5 * world.paths[0].pieces[at.piece].width - std::abs(at.offset) - world.movers[0].radius);
    }
    EXPECT_TRUE(simulation.all_done()) << controller;
    EXPECT_GT(least, -0.02) << controller << ": its body, except for 2 cm";
    EXPECT_NEAR(0.1 * ticks, 51.0, 5.0) << controller << ": 5.08 m at 0.1 m/s";
  }
}

TEST(PathFollowing, ATrialIsAFunctionOfItsSeed) {
  const Scenario scenario = experiment("lane-edge-p", Plant::thesis);
  const std::uint64_t first = run(scenario, 5).hash;
  EXPECT_EQ(run(scenario, 5).hash, first);
  EXPECT_NE(run(scenario, 6).hash, first);
}

TEST(PathFollowing, StartsAreNormallyDistributedAroundTheWorlds) {
  Scenario scenario = experiment("lane-edge-p", Plant::thesis);
  const base::Pose at = world_of(scenario).movers[0].X_WM;
  const Disturbance d{.place = 0.01, .heading = 0.02};
  double sum = 0.0, squares = 0.0, turns = 0.0;
  constexpr int kTrials = 200;
  for (int k = 0; k < kTrials; ++k) {
    scenario.seed = static_cast<std::uint64_t>(k);
    const base::Pose X = disturbed_world(scenario, d).movers[0].X_WM;
    sum += X.x - at.x;
    squares += (X.x - at.x) * (X.x - at.x) + (X.y - at.y) * (X.y - at.y);
    turns += (X.yaw - at.yaw) * (X.yaw - at.yaw);
  }
  EXPECT_NEAR(sum / kTrials, 0.0, 4 * 0.01 / std::sqrt(kTrials));
  EXPECT_NEAR(std::sqrt(squares / (2 * kTrials)), 0.01, 0.0015);
  EXPECT_NEAR(std::sqrt(turns / kTrials), 0.02, 0.004);
}

}  // namespace
}  // namespace sf::scenarios
