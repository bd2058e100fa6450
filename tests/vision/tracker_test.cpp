// Merging and tracking.

#include "vision/tracker.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sf::vision {

namespace {

Sighting sighting(double time, double x, double y, double yaw, std::uint32_t id = 1) {
  Sighting s;
  s.id = id;
  s.time = time;
  s.fit.X_WT = {x, y, 0.2, yaw};
  s.fit.pixel = 0.004;
  s.fit.side = 0.15;
  return s;
}

std::vector<TrackedTag> update(Tracker& tracker, const std::vector<Sighting>& sightings) {
  std::vector<TrackedTag> tracked;
  tracker.update(sightings, tracked);
  return tracked;
}

}  // namespace

TEST(Tracker, ReportsTheFirstSightingAtRest) {
  Tracker tracker;
  const auto tracked = update(tracker, {sighting(0.0, 1.0, 2.0, 0.5)});
  ASSERT_EQ(tracked.size(), 1u);
  EXPECT_EQ(tracked[0].X_WT.y, 2.0);
  EXPECT_EQ(tracked[0].velocity, glm::dvec2());
  EXPECT_EQ(tracked[0].turn, 0.0);
  EXPECT_TRUE(update(tracker, {}).empty());
}

/// A tag that was not seen for more than a second is new again.
TEST(Tracker, ReportsFromTheChosenSightingOn) {
  Tracker tracker(3);
  std::string reported;
  for (const double t : {0.0, 0.1, 0.2, 0.3, 1.4, 1.5, 1.6})
    reported += update(tracker, {sighting(t, 1.0, 2.0, 0.5)}).empty() ? '-' : 'x';
  EXPECT_EQ(reported, "--xx--x");
}

TEST(Tracker, TakesTheHeightOfTheMostCertainCamera) {
  Sighting near = sighting(0.0, 1.0, 2.0, 0.5), far = near;
  near.fit.X_WT.z = 0.31, near.fit.height_sigma = 0.002, near.fit.roll = 0.1, near.fit.tilt_sigma = 0.01;
  far.fit.X_WT.z = 0.33, far.fit.height_sigma = 0.02;
  for (const auto& views : {std::vector{near, far}, std::vector{far, near}}) {
    Tracker each;
    const auto tracked = update(each, views);
    ASSERT_EQ(tracked.size(), 1u);
    EXPECT_EQ(tracked[0].X_WT.z, 0.31);
    EXPECT_EQ(tracked[0].height_sigma, 0.002);
    EXPECT_EQ(tracked[0].roll, 0.1);
    EXPECT_EQ(tracked[0].tilt_sigma, 0.01);
  }
}

TEST(Tracker, ReportsFromTheSecondSightingOn) {
  Tracker tracker(2);
  EXPECT_TRUE(update(tracker, {sighting(0.0, 1.0, 2.0, 0.5)}).empty());
  const auto tracked = update(tracker, {sighting(0.1, 1.0, 2.0, 0.5)});
  ASSERT_EQ(tracked.size(), 1u);
  EXPECT_EQ(tracked[0].id, 1u);
  EXPECT_EQ(tracked[0].time, 0.1);
  EXPECT_EQ(tracked[0].X_WT.x, 1.0);
  EXPECT_EQ(tracked[0].X_WT.z, 0.2);
  EXPECT_EQ(tracked[0].cameras, 1);
  EXPECT_TRUE(update(tracker, {}).empty());
}

TEST(Tracker, FindsTheVelocityOfACircleWithoutLag) {
  Tracker tracker;
  std::vector<TrackedTag> tracked;
  double t = 0.0;
  for (int i = 0; i < 15; ++i) {
    t = i / 15.0;
    const double angle = 2.0 * t;  // radius 0.25 m, 0.5 m/s, through the jump of the heading at pi
    tracked =
        update(tracker, {sighting(t, 0.25 * std::sin(angle), -0.25 * std::cos(angle), base::wrap_angle(angle + 2.0))});
  }
  ASSERT_EQ(tracked.size(), 1u);
  EXPECT_NEAR(tracked[0].velocity.x, 0.5 * std::cos(2.0 * t), 2e-3);
  EXPECT_NEAR(tracked[0].velocity.y, 0.5 * std::sin(2.0 * t), 2e-3);
  EXPECT_NEAR(tracked[0].turn, 2.0, 1e-2);
}

TEST(Tracker, MergesViewsOfSeveralCameras) {
  Tracker tracker;
  update(tracker, {sighting(0.0, 1.0, 0.0, M_PI - 0.01)});
  Sighting other = sighting(0.1, 1.004, 0.0, -M_PI + 0.01);
  other.fit.pixel = 0.008;  // a quarter of the weight
  const auto tracked = update(tracker, {sighting(0.1, 1.0, 0.0, M_PI - 0.01), other});
  ASSERT_EQ(tracked.size(), 1u);
  EXPECT_NEAR(tracked[0].X_WT.x, 1.0 + 0.2 * 0.004, 1e-12);
  EXPECT_NEAR(tracked[0].X_WT.yaw, M_PI - 0.01 + 0.2 * 0.02, 1e-12);  // not across the jump at pi
  EXPECT_EQ(tracked[0].cameras, 2);
  EXPECT_EQ(tracker.refused(), 0u);
}

TEST(Tracker, MovesViewsToACommonTime) {
  Tracker tracker;
  for (int i = 0; i < 10; ++i) update(tracker, {sighting(0.1 * i, 0.1 * i, 0.0, 0.0)});
  const auto tracked = update(tracker, {sighting(1.0, 1.0, 0.0, 0.0), sighting(1.05, 1.05, 0.0, 0.0)});
  ASSERT_EQ(tracked.size(), 1u);
  EXPECT_NEAR(tracked[0].X_WT.x, 1.0, 1e-4);
}

/// At 4 m/s, the tag is 0.2 m farther for a camera that sees it 50 ms later, or earlier.
TEST(Tracker, MergesViewsOfAFastTag) {
  for (const double later : {0.05, -0.05}) {
    Tracker tracker;
    update(tracker, {sighting(0.0, 0.0, 0.0, 0.0)});
    const auto tracked =
        update(tracker, {sighting(0.1, 0.4, 0.0, 0.0), sighting(0.1 + later, 0.4 + 4.0 * later, 0.0, 0.0)});
    ASSERT_EQ(tracked.size(), 1u);
    EXPECT_EQ(tracked[0].cameras, 2) << later;
  }
}

/// A camera that lags behind shows the tag's past while the others show its present.
TEST(Tracker, RejectsAnOldViewTogetherWithANewOne) {
  Tracker tracker;
  update(tracker, {sighting(0.2, 0.0, 0.0, 0.0)});
  const auto tracked = update(tracker, {sighting(0.3, 0.0, 0.0, 0.0), sighting(0.15, 0.08, 0.0, 0.0)});
  ASSERT_EQ(tracked.size(), 1u);
  EXPECT_EQ(tracked[0].X_WT.x, 0.0);
  EXPECT_EQ(tracked[0].cameras, 1);
  EXPECT_EQ(tracker.refused(), 1u);
}

/// Simultaneous views belong to one tag if they are up to half of 0.3 m apart.
TEST(Tracker, MergesViewsUpToFifteenCentimetresApart) {
  const auto cameras = [](double apart) {
    Tracker tracker;
    update(tracker, {sighting(0.0, 0.0, 0.0, 0.0)});
    return update(tracker, {sighting(0.1, 0.0, 0.0, 0.0), sighting(0.1, apart, 0.0, 0.0)}).at(0).cameras;
  };
  EXPECT_EQ(cameras(0.15), 2);
  EXPECT_EQ(cameras(std::nextafter(0.15, 1.0)), 1);
}

TEST(Tracker, RejectsASecondPosition) {
  Tracker tracker;
  update(tracker, {sighting(0.0, 0.0, 0.0, 0.0)});
  // A false sighting, 3 m away, before the true one: no tag moves 3 m within 0.1 s.
  const auto tracked = update(tracker, {sighting(0.1, 3.0, 0.0, 0.0), sighting(0.1, 0.01, 0.0, 0.0)});
  ASSERT_EQ(tracked.size(), 1u);
  EXPECT_EQ(tracked[0].X_WT.x, 0.01);
  EXPECT_EQ(tracker.refused(), 1u);
  // A sighting older than the last one is rejected, and so is one at the same time.
  EXPECT_TRUE(update(tracker, {sighting(0.05, 0.0, 0.0, 0.0)}).empty());
  EXPECT_TRUE(update(tracker, {sighting(0.1, 0.0, 0.0, 0.0)}).empty());
  EXPECT_EQ(tracker.refused(), 3u);
}

TEST(Tracker, AcceptsATagMovedElsewhere) {
  Tracker tracker;
  update(tracker, {sighting(0.0, 0.0, 0.0, 0.0)});
  update(tracker, {sighting(0.1, 0.0, 0.0, 0.0)});
  int refused = 0;
  for (int i = 2; update(tracker, {sighting(0.1 * i, 3.0, 0.0, 0.0)}).empty(); ++i) ASSERT_LT(++refused, 20);
  EXPECT_EQ(refused, 5);  // 0.3 m + 5 m/s reach 3 m after 0.54 s, and the sixth sighting is 0.6 s after the last
}

TEST(Tracker, ForgetsTagsThatDisappeared) {
  Tracker tracker(2);
  update(tracker, {sighting(0.0, 0.0, 0.0, 0.0)});
  update(tracker, {sighting(0.1, 0.0, 0.0, 0.0)});
  EXPECT_TRUE(update(tracker, {sighting(1.2, 0.0, 0.0, 0.0)}).empty());  // as at first sight
  EXPECT_EQ(update(tracker, {sighting(1.3, 0.0, 0.0, 0.0)}).size(), 1u);
}

TEST(Tracker, KeepsATagForASecond) {
  Tracker tracker(2);
  update(tracker, {sighting(0.0, 0.0, 0.0, 0.0)});
  EXPECT_EQ(update(tracker, {sighting(1.0, 0.0, 0.0, 0.0)}).size(), 1u);
  EXPECT_TRUE(update(tracker, {sighting(std::nextafter(2.0, 3.0), 0.0, 0.0, 0.0)}).empty());
}

TEST(Tracker, TracksTagsSeparately) {
  Tracker tracker;
  update(tracker, {sighting(0.0, 0.0, 0.0, 0.0, 2), sighting(0.0, 1.0, 0.0, 0.0, 1)});
  const auto tracked = update(tracker, {sighting(0.1, 0.0, 0.0, 0.0, 2), sighting(0.1, 1.0, 0.0, 0.0, 1)});
  ASSERT_EQ(tracked.size(), 2u);
  EXPECT_EQ(tracked[0].id, 1u);
  EXPECT_EQ(tracked[0].X_WT.x, 1.0);
  EXPECT_EQ(tracked[1].id, 2u);
}

}  // namespace sf::vision
