// The experiment `follow`: a tag that crosses four cameras.

#include "scenarios/follow_runs.h"

#include <gtest/gtest.h>

#include "tests/instrumented.h"

namespace sf::scenarios {

TEST(FollowExperiment, FollowingGivesTheTrackOfAllCameras) {
  if (instrumented()) GTEST_SKIP() << "rendering is slow with sanitizers; tests/vision/follow_test.cpp takes its paths";
  int steps = 0;
  const FollowRun run = run_follow(
      kFollowCases[0], 1, [&](double) { ++steps; }, 0.3);
  EXPECT_EQ(steps, 5);
  ASSERT_EQ(run.times.size(), 5u);
  for (const FollowMethod method : {FollowMethod::all, FollowMethod::follow, FollowMethod::others}) {
    const FollowRow row = summarize(run, method);
    EXPECT_EQ(row.seen, 5u);
    EXPECT_EQ(row.missed, 0u);
    EXPECT_EQ(row.different, 0u);
    EXPECT_LT(row.rms_mm, 0.5);
    EXPECT_GT(row.rms_mm, 0.0);
    EXPECT_GT(row.cpu_ms, 0.0);
  }
  EXPECT_EQ(run.searches[0], (std::vector<double>{2, 1, 1, 1, 1}));
  EXPECT_EQ(run.searches[3], (std::vector<double>{2, 0, 0, 0, 0}));
  EXPECT_NEAR(summarize(run, FollowMethod::follow).asleep, 0.6, 1e-12) << "three of four cameras, from the second on";
}

/// Counts missed sightings, and those with a different position or speed.
TEST(FollowExperiment, CountsDifferences) {
  FollowRun run;
  run.times = {0.0, 0.1, 0.2, 0.3};
  const FollowMoment seen{1e-3, vision::TrackedTag{.id = 1, .X_WT = {1.0, 2.0, 0.2, 0.5}, .cameras = 1}, 2e-3};
  run.moments.fill(std::vector<FollowMoment>(4, seen));
  auto& follow = run.moments[1];
  follow[1].tag.reset();
  follow[2].tag->X_WT.x += 1e-15;
  follow[3].tag->velocity.y = 1e-9;
  run.moments[0][3].tag.reset();
  const FollowRow row = summarize(run, FollowMethod::follow);
  EXPECT_EQ(row.seen, 3u);
  EXPECT_EQ(row.missed, 1u);
  EXPECT_EQ(row.different, 2u) << "and a tag that all cameras did not see";
  EXPECT_NEAR(row.gap, 0.2, 1e-12);
  EXPECT_NEAR(row.cpu_ms, 1.0, 1e-12);
  EXPECT_NEAR(row.rms_mm, 2.0, 1e-12);
}

}  // namespace sf::scenarios
