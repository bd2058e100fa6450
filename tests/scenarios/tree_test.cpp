// The experiment `tree`: five unlike sensors of a car, all choices of which are tracked in one run.

#include <gtest/gtest.h>

#include "scenarios/tree_runs.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

TEST(TreeExperiment, MoreSensorsFindMoreObjects) {
  gpu::Device device;
  const ExperimentOptions options{.threads = 1};
  const Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/tree.toml");
  const ExperimentContext context{*find_experiment("tree"), scenario, options, device, {}};
  const TreeRun run = run_tree(context, 1);
  const std::vector<TreeTracks>& all = run.tracks;
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
  EXPECT_EQ(run_tree(context, 1).tracks[0].position_squares, all[0].position_squares) << "deterministic";
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
