// The experiment `tree`: five unlike sensors of a car, all choices of which are tracked in one run.

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/tree_runs.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

TreeRun run_for(double duration) {
  gpu::Device device;
  const ExperimentOptions options{.threads = 1};
  Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/tree.toml");
  scenario.duration = duration;
  return run_tree({*find_experiment("tree"), scenario, options, device, {}}, 1);
}
const TreeRun& first_run() {
  static const TreeRun run = run_for(40.0);
  return run;
}

TEST(TreeExperiment, MoreSensorsFindMoreObjects) {
  const std::vector<TreeTracks>& all = first_run().tracks;
  ASSERT_EQ(all.size(), kAllTreeSensors);
  const auto found = [&](unsigned sensors) { return all[sensors - 1].found; };
  EXPECT_EQ(all[kAllTreeSensors - 1].sensors, kAllTreeSensors);
  EXPECT_GT(all[0].targets, 1000u);
  EXPECT_GT(found(kAllTreeSensors), all[0].targets / 2);
  EXPECT_GT(found(kAllTreeSensors), found(kAllTreeSensors & ~1u)) << "without the front laser";
  EXPECT_GT(found(1), found(8)) << "infrared alone is near-sighted";
  for (const TreeTracks& tracks : all) {
    EXPECT_EQ(tracks.targets, all[0].targets) << "the same truth";
    EXPECT_EQ(tracks.readings, all[0].readings);
    EXPECT_LE(tracks.found, tracks.targets);
  }
}

TEST(TreeExperiment, IsDeterministic) {
  const TreeRun once = run_for(10.0), again = run_for(10.0);
  for (std::size_t k = 0; k < once.tracks.size(); ++k)
    EXPECT_EQ(once.tracks[k].position_squares, again.tracks[k].position_squares);
  EXPECT_GT(once.tracks.back().position_squares, 0.0);
}

TEST(TreeExperiment, MoreSensorsGiveABetterGrid) {
  const std::vector<TreeGrid>& all = first_run().grids;
  ASSERT_EQ(all.size(), 2 * kAllGridSensors);
  const auto grid = [&](unsigned sensors, GridPose pose) {
    const TreeGrid& of = all[static_cast<std::size_t>(pose) * kAllGridSensors + sensors - 1];
    EXPECT_EQ(of.sensors, sensors);
    EXPECT_EQ(of.cells, all[0].cells) << "the same truth";
    return of;
  };
  const TreeGrid best = grid(kAllGridSensors, GridPose::exact);
  EXPECT_GT(best.cells, 10'000u);
  EXPECT_GT(best.surfaces, 500u);
  EXPECT_GT(10 * best.found, 8 * best.surfaces);
  EXPECT_GT(10 * best.right, 9 * best.occupied);
  EXPECT_LT(100 * best.wrong, best.free);
  for (std::size_t k = 0; k < kGridSensors; ++k) {
    EXPECT_LT(best.log_loss, grid(kAllGridSensors & ~(1u << k), GridPose::exact).log_loss + 0.01 * best.log_loss) << k;
    EXPECT_LT(grid(1u << k, GridPose::exact).log_loss, std::log(2.0) * static_cast<double>(best.cells)) << k;
  }
  EXPECT_LT(best.log_loss, grid(kAllGridSensors, GridPose::own).log_loss) << "the car's own poses blur the grid";
}

TEST(TreeExperiment, NeedsItsCar) {
  gpu::Device device;
  const ExperimentOptions options{.threads = 1};
  const Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/monitor.toml");
  const ExperimentContext context{*find_experiment("tree"), scenario, options, device, {}};
  expect_in("no car 'probe'; expected worlds/simville/tree.world", refusal_of([&] { run_tree(context, 1); }));
}

}  // namespace
}  // namespace sf::scenarios
