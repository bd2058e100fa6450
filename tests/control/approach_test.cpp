// Road users around a robot, their ways, and the lines that they approach.

#include <gtest/gtest.h>

#include <set>

#include "tests/control/observer.h"

namespace sf::traffic {
namespace {

using control::Rule;

TEST(RoadUsers, IncludeRobotsWithinThreeAndAHalfMetres) {
  const Site site(two_crossings());
  Observer me(site, 5);
  const auto counted = [&](const Seen& other, std::uint32_t leader = base::kNoId) {
    me.see(0.0, {5, {0, 0, 0, 0}, 0.0, leader}, {other});
    return me.rights.road_users().size() == 2;
  };
  EXPECT_TRUE(counted({6, {3.499, 0, 0, 0}}));
  EXPECT_TRUE(counted({6, {0, 3.499, 0, 0}}));
  EXPECT_FALSE(counted({6, {3.501, 0, 0, 0}}));
  EXPECT_FALSE(counted({6, {0, -3.501, 0, 0}}));
  EXPECT_TRUE(counted({6, {9, 0, 0, 0}}, 6)) << "its leader, at any distance";
  EXPECT_FALSE(counted({6, {9, 0, 0, 0}}, 7));
  EXPECT_TRUE(counted({6, {9, 0, 0, 0}, 0.0, 5})) << "its follower";
  EXPECT_FALSE(counted({6, {9, 0, 0, 0}, 0.0, 7}));
  EXPECT_FALSE(counted({5, {1, 0, 0, 0}})) << "itself";
}

TEST(RoadUsers, HaveVelocitiesInTheWorldFrame) {
  const Site site(two_crossings());
  control::RightOfWay rights(site.corridors, 5);
  rights.observe({.state = {.X_WM = {1, 0, 0, M_PI / 2}, .velocity = {0.3, 0.4, 1.0}}, .readings = {}, .others = {}}, 0,
                 false);
  EXPECT_NEAR(rights.road_users()[0].velocity.x, -0.4, 1e-12);
  EXPECT_NEAR(rights.road_users()[0].velocity.y, 0.3, 1e-12);
  EXPECT_NEAR(rights.road_users()[0].speed, 0.5, 1e-12);
}

TEST(RoadUsers, UpdatePositionsAfterEveryMotion) {
  const Site site(two_crossings());
  Observer me(site, 5);
  const auto place = [&](const Pose& X_WM) {
    me.see(0.0, {5, X_WM});
    return me.user().positions.count == 1 ? me.user().positions.all[0] : control::RoadPosition{99};
  };
  EXPECT_NEAR(place({1.0, 0, 0, 0}).s, 1.0, 1e-9);
  EXPECT_NEAR(place({1.5, 0, 0, 0}).s, 1.5, 1e-9);
  EXPECT_NEAR(place({4, -2.0, 0, M_PI / 2}).s, 1.0, 1e-9);
  EXPECT_NEAR(place({4, -1.5, 0, M_PI / 2}).s, 1.5, 1e-9);
  EXPECT_EQ(place({4, 0, 0, M_PI / 2}).way, kCross);
  EXPECT_EQ(place({4, 0, 0, 0}).way, kMain) << "turned in place";
}

// Boundary: 0.8 radii.
TEST(RoadUsers, AreOnALaneOrNextToIt) {
  const Site site(two_crossings());
  Observer me(site, 5);
  me.see(0.0, {5, {1, 0.8 * 0.165 - 1e-3, 0, 0}});
  EXPECT_EQ(me.user().positions.count, 1u);
  me.see(0.0, {5, {1, 0.8 * 0.165 + 1e-3, 0, 0}});
  EXPECT_EQ(me.user().positions.count, 0u);
}

// Where ways part: ways at most a quarter of a radius farther than the nearest one.
TEST(RoadUsers, AreOnAllWaysNearlyAsCloseAsTheNearest) {
  const Site site(simville());
  Observer me(site, 5);
  const std::uint32_t bend = site.exit("1.1", "12.1");
  std::set<std::uint32_t> counts;
  for (double s = 0.0; s < site.corridors.way(bend).length; s += 0.01) {
    const Pose X_WM = site.on(bend, s);
    const control::RoadPositions all = site.corridors.positions(X_WM, 0.8 * 0.165);
    std::uint32_t near = 0;
    for (const control::RoadPosition& place : all) near += place.offset - all.all[0].offset <= 0.25 * 0.165;
    me.see(0.0, {5, X_WM});
    EXPECT_EQ(me.user().positions.count, near) << s;
    counts.insert(all.count - near);
  }
  EXPECT_GT(counts.size(), 1u) << "some are farther";
}

// ---- Approaches.

TEST(RoadUsers, ApproachTheNextLineUntilTheyAreThreeCentimetresBeyond) {
  const Site site(two_crossings());
  const auto& lines = site.corridors.way(kMain).lines;
  ASSERT_EQ(lines.size(), 2u);
  Observer me(site, 5);
  const auto line = [&](double s) {
    me.see(0.0, {5, site.on(kMain, s)});
    EXPECT_EQ(me.approach().lane, kMain);
    EXPECT_NEAR(me.approach().ahead, me.approach().line - s, 1e-9);
    return me.approach().line;
  };
  EXPECT_EQ(line(lines[0] + 0.029), lines[0]);
  EXPECT_EQ(line(lines[0] + 0.031), lines[1]);
  EXPECT_EQ(line(lines[1] + 1.0), lines[1]) << "the last";
}

TEST(RoadUsers, ContendFromHalfAMetreBeforeTheLine) {
  const Site site(two_crossings());
  for (const double ahead : {0.501, 0.499, 0.0}) {
    Observer me(site, 5);
    me.see(0.0, {5, site.before(kMain, ahead)});
    EXPECT_EQ(me.approach().contends, ahead < 0.5) << ahead;
  }
}

// Boundary: a robot at rest up to 0.15 radii beyond the line still counts as before the line.
TEST(RoadUsers, ContendIfNoRobotIsBetweenThemAndTheLine) {
  const Site site(two_crossings());
  const auto contends = [&](const Pose& other) {
    Observer me(site, 5);
    me.see(0.0, {5, site.before(kCross, 0.3)}, {{6, other}});
    return me.approach().contends;
  };
  EXPECT_FALSE(contends(site.before(kCross, 0.1)));
  EXPECT_FALSE(contends(site.before(kCross, -0.024)));
  EXPECT_TRUE(contends(site.before(kCross, -0.026)));
  EXPECT_TRUE(contends(site.before(kCross, 0.5))) << "behind it";
  EXPECT_TRUE(contends(site.before(kCross, 0.3))) << "at the same position";
  const Site close(straight_lanes({{{{3, -2}, {3, 3}}}, {{{3.5, -2}, {3.5, 3}}}, {{{0, 0}, {9, 0}}}}));
  Observer me(close, 5);
  me.see(0.0, {5, close.before(0, 0.3)}, {{6, close.before(1, 0.1)}});
  EXPECT_TRUE(me.approach().contends) << "on another lane";
}

// Boundary: a radius to either side of the robot's front at its waiting position.
TEST(RoadUsers, ObserveAStopLineAtTheirWaitingLine) {
  const double front = Site(two_crossings()).corridors.way(kCross).lines[0] + 0.165;
  for (const double off : {-1.1, -0.9, 0.9, 1.1}) {
    const glm::dvec2 stop{4, -3 + front + 0.165 * off};
    const Site site(straight_lanes({{{{0, 0}, {12, 0}}}, {{{4, -3}, stop, {4, 3}}}}, {"stop 2.1.2"}));
    Observer me(site, 5);
    me.see(0.0, {5, site.before(kCross, 0.3)});
    EXPECT_EQ(me.approach().rule, std::abs(off) < 1.0 ? Rule::stop : Rule::free) << off;
  }
}

/// Two crossing lanes with stop lines, at the fronts of waiting robots.
world::RoadNetwork two_stops() {
  const double front = Site(two_crossings()).corridors.way(kCross).lines[0] + 0.165;
  return straight_lanes({{{{0, 0}, {1 + front, 0}, {12, 0}}}, {{{4, -3}, {4, -3 + front}, {4, 3}}}},
                        {"stop 1.1.2", "stop 2.1.2"});
}

TEST(RoadUsers, ContendAtAStopLineAfterStopping) {
  const Site site(two_stops());
  const auto contends = [&](double ahead, double speed) {
    Observer me(site, 5);
    me.see(0.0, {5, site.before(kCross, ahead), speed});
    EXPECT_EQ(me.may_enter(kCross, kMain), me.approach().contends);
    me.see(0.1, {5, site.before(kCross, ahead - 0.01), 0.1});
    return me.approach().contends;
  };
  EXPECT_TRUE(contends(0.08, 0.009)) << "and when it drives on";
  EXPECT_FALSE(contends(0.08, 0.011));
  EXPECT_FALSE(contends(0.085, 0.0)) << "half a radius is 0.0825 m";
  EXPECT_TRUE(contends(-0.08, 0.0));
  EXPECT_FALSE(contends(-0.085, 0.0));
}

TEST(RoadUsers, RankByTheStartOfContentionNotByArrival) {
  const Site site(two_stops());
  for (const bool other_first : {false, true}) {
    Observer me(site, other_first ? 5 : 7);
    me.see(0.0, {5, site.before(kCross, 0.05), other_first ? 0.1 : 0.0}, {{6, site.before(kMain, 0.3), 0.1}});
    EXPECT_EQ(me.may_enter(kCross, kMain), !other_first);
    me.see(1.0, {5, site.before(kCross, 0.05), other_first ? 0.1 : 0.0}, {{6, site.before(kMain, 0.05)}});
    EXPECT_EQ(me.may_enter(kCross, kMain), !other_first);
    me.see(2.0, {5, site.before(kCross, 0.05)}, {{6, site.before(kMain, 0.05)}});
    EXPECT_EQ(me.may_enter(kCross, kMain), !other_first);
  }
}

}  // namespace
}  // namespace sf::traffic
