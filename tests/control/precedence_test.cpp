// Precedence of two robots at one conflict.

#include <gtest/gtest.h>

#include "tests/control/observer.h"

namespace sf::traffic {
namespace {

constexpr double kRadius = 0.165;           // [m]
constexpr double kMargin = 0.15 * kRadius;  // [m]

// ---- The order of waiting robots.

TEST(Precedence, EarlierArrivalThenSmallerId) {
  const Site site(two_crossings());
  const auto may_enter = [&](double own, double others, std::uint32_t id) {
    Observer me(site, id);
    for (const double t : {0.0, 0.1, 0.2})
      me.see(t, {id, site.before(kCross, t < own ? 1.0 : 0.1)}, {{6, site.before(kMain, t < others ? 1.0 : 0.1)}});
    return me.may_enter(kCross, kMain);
  };
  EXPECT_TRUE(may_enter(0.0, 0.1, 7));
  EXPECT_FALSE(may_enter(0.1, 0.0, 5));
  EXPECT_TRUE(may_enter(0.0, 0.0, 5));
  EXPECT_FALSE(may_enter(0.0, 0.0, 7));
}

TEST(Precedence, ReturningRobotRanksFromItsReturn) {
  const Site site(two_crossings());
  Observer me(site, 5);
  for (const double t : {0.0, 0.1, 0.2})
    me.see(t, {5, site.before(kCross, t == 0.1 ? 1.0 : 0.1)}, {{6, site.before(kMain, 0.1)}});
  EXPECT_FALSE(me.may_enter(kCross, kMain));
}

// A robot that has passed the line still approaches it, because there is no other. The next robot does not inherit its
// turn.
TEST(Precedence, EveryRobotHasItsOwnTurn) {
  const Site site(two_crossings());
  Observer me(site, 5);
  for (const double t : {0.0, 0.1, 0.2})
    me.see(t, {5, site.before(kCross, 0.4)},
           {{6, site.before(kMain, t == 0.0 ? 1.0 : 0.1)}, {7, site.before(kCross, t == 0.2 ? -0.5 : 0.1)}});
  EXPECT_TRUE(me.approach().contends);
  EXPECT_FALSE(me.may_enter(kCross, kMain));
}

TEST(Precedence, EveryLineHasItsOwnTurn) {
  const Site site(two_crossings());
  Observer me(site, 7);
  for (const double t : {0.0, 0.1, 0.2})
    me.see(t, {7, site.before(kFarCross, t == 0.0 ? 1.0 : 0.1)}, {{6, site.before(kMain, 0.1, t == 0.2 ? 1 : 0)}});
  EXPECT_TRUE(me.may_enter(kFarCross, kMain)) << "the other waited at the previous line";
  // The two crossing lanes have their lines at the same place.
  Observer other(site, 5);
  for (const double t : {0.0, 0.1, 0.2})
    other.see(t, {5, site.before(t == 0.2 ? kFarCross : kCross, 0.1)},
              {{6, site.before(kMain, t == 0.0 ? 1.0 : 0.4, 1)}});
  EXPECT_FALSE(other.may_enter(kFarCross, kMain)) << "it waited on another lane";
}

// 6.1 and 10.2 cross, and each has a light.
TEST(Precedence, RobotThatNeedNotStopPrecedesAndRobotAtRedIsIgnored) {
  using enum world::LightState;
  Site site(simville(), {light("a", {"6.1.3"}, {{dark, 1.0}}), light("b", {"10.2.3"}, {{dark, 1.0}})});
  const std::uint32_t a = site.lane("6.1"), b = site.lane("10.2");
  const std::uint32_t own = site.exit("6.1", "7.1"), other = site.exit("10.2", "11.2");
  const auto may_enter = [&](world::LightState mine, world::LightState others, double arrival, double other_arrival) {
    site.signals = {{mine, 0.0}, {others, 0.0}};
    Observer me(site, 7);
    for (const double t : {0.0, 0.1, 0.2})
      me.see(t, {7, site.before(a, t < arrival ? 0.7 : 0.0)}, {{6, site.before(b, t < other_arrival ? 0.7 : 0.0)}});
    return me.may_enter(own, other);
  };
  EXPECT_TRUE(may_enter(green, dark, 0.1, 0.0));
  EXPECT_FALSE(may_enter(dark, flashing_yellow, 0.0, 0.1));
  EXPECT_TRUE(may_enter(dark, flashing_red, 0.0, 0.1));
  EXPECT_FALSE(may_enter(dark, flashing_red, 0.1, 0.0));
  EXPECT_TRUE(may_enter(dark, red, 0.1, 0.0));
  EXPECT_TRUE(may_enter(green, yellow, 0.1, 0.0));
  EXPECT_FALSE(may_enter(red, dark, 0.0, 9.0)) << "it waits too, even without other robots";
}

/// A light without a signal counts as if it did not exist.
TEST(Precedence, LineWithoutASignalIsAStopSign) {
  const std::vector<world::Signal> one{{world::LightState::green, 0.0}};
  EXPECT_EQ(control::rule_of({0.0, {0}}, one), control::Rule::free);
  EXPECT_EQ(control::rule_of({0.0, {1}}, one), control::Rule::stop);
  EXPECT_EQ(control::rule_of({0.0, {}}, one), control::Rule::stop);
}

// Two waiting robots see each other. In some of twenty pairs in which the first one would go, the lottery lets the
// second go.
TEST(Precedence, SharedLotteryDecidesAfterThreeSeconds) {
  const Site site(two_crossings());
  for (const std::int64_t second : {0, 2000, 3500}) {  // [ms] when it arrives
    int won = 0, changes = 0;
    for (std::uint32_t id = 6; id < 26; ++id) {
      Observer a(site, 5), b(site, id);
      bool before = true;
      for (std::int64_t ms = 0; ms <= 12'000; ms += 100) {
        for (const double t : {1e-3 * double(ms), 1e-3 * double(ms) + 1e-9}) {
          const Seen one{5, site.before(kCross, 0.1)}, two{id, site.before(kMain, ms < second ? 1.0 : 0.1)};
          a.see(t, one, {two});
          b.see(t, two, {one});
          if (ms < second) continue;
          const bool first = a.may_enter(kCross, kMain);
          ASSERT_NE(first, b.may_enter(kMain, kCross)) << id << " at " << t;
          won += !first && ms < 4000;
          if (t < 3.0 + 0.5e-9) {
            EXPECT_TRUE(first) << id << " at " << t;
          }
          if (first != before && ms > second) {
            EXPECT_EQ(ms % 1000, 0) << id << " at " << t;
          }
          changes += first != before;
          before = first;
        }
      }
    }
    EXPECT_GT(won, 0) << second;
    EXPECT_GT(changes, 60) << second << ": of some 180 draws";
  }
}

TEST(Precedence, FollowersYield) {
  const Site site(two_crossings());
  const auto may_enter = [&](std::uint32_t leader, std::uint32_t others_leader, bool merges = false,
                             bool first = true) {
    Observer me(site, 5);
    for (const double t : {0.0, 0.1})
      me.see(t, {5, site.before(kCross, first || t > 0.0 ? 0.1 : 1.0), 0.0, leader},
             {{6, site.before(kMain, first && t == 0.0 ? 1.0 : 0.1), 0.0, others_leader}}, merges);
    return me.may_enter(kCross, kMain);
  };
  EXPECT_TRUE(may_enter(7, base::kNoId)) << "not a robot that it follows";
  EXPECT_FALSE(may_enter(6, base::kNoId)) << "to their leader";
  EXPECT_FALSE(may_enter(7, 7)) << "to another that follows the same";
  EXPECT_TRUE(may_enter(7, 7, true, false)) << "unless they merge before it";
  EXPECT_TRUE(may_enter(base::kNoId, 5, false, false)) << "this one follows";
  EXPECT_FALSE(may_enter(base::kNoId, 7, false, false));
}

// ---- Robots in the way.

TEST(Precedence, RobotThatCannotStopIsCommitted) {
  const Site site(two_crossings());
  const control::RightOfWay rights(site.corridors, 5);
  const double least = 0.5 * 0.5 / (2.0 * 0.6) - kMargin;  // [m] to stop from 0.5 m/s, with the margin
  EXPECT_TRUE(rights.committed(least - 1e-6, 0.5));
  EXPECT_FALSE(rights.committed(least + 1e-6, 0.5));
  EXPECT_TRUE(rights.committed(-kMargin - 1e-6, 0.0));
  EXPECT_FALSE(rights.committed(-kMargin + 1e-6, 0.0));
}

/// Returns whether robot 5, the first to arrive at the last line of `lane`, drives on along `row` with robot 6 at
/// `X_WM`.
bool first_may_enter(const Site& site, std::uint32_t lane, std::uint32_t row, std::uint32_t other, const Pose& X_WM,
                     double speed = 0.0) {
  const Seen self{5, site.before(lane, 0.0, site.corridors.way(lane).lines.size() - 1)};
  Observer me(site, 5);
  me.see(0.0, self);
  me.see(0.1, self, {{6, X_WM, speed}});
  return me.may_enter(row, other);
}

// Boundary: a millimetre before the line at which it cannot stop, and at the end of the conflict.
TEST(Precedence, RobotOnTheCrossingHasPriority) {
  const Site site(two_crossings());
  const double least = 0.5 * 0.5 / (2.0 * 0.6) - kMargin;
  EXPECT_TRUE(first_may_enter(site, kCross, kCross, kMain, site.before(kMain, least + 1e-3), 0.5));
  EXPECT_FALSE(first_may_enter(site, kCross, kCross, kMain, site.before(kMain, least - 1e-3), 0.5));
  const control::Conflict& conflict = site.conflict(kCross, kMain);
  EXPECT_FALSE(first_may_enter(site, kCross, kCross, kMain, site.on(kMain, conflict.other_to - 1e-3)));
  EXPECT_TRUE(first_may_enter(site, kCross, kCross, kMain, site.on(kMain, conflict.other_to + 1e-3)));
  EXPECT_TRUE(first_may_enter(site, kFarCross, kFarCross, kMain, site.on(kMain, 4.0))) << "it is on another crossing";
}

// 12.2 has a stop sign, 2.2 and 1.1 have none.
TEST(Precedence, ExitsFromTheEndsOfLanes) {
  const Site site(simville());
  const std::uint32_t lane = site.lane("2.2"), other_lane = site.lane("12.2");
  const std::uint32_t own = site.exit("2.2", "1.3"), other = site.exit("12.2", "2.1");
  const double least = 0.5 * 0.5 / (2.0 * 0.6) - kMargin;
  const std::size_t last = site.corridors.way(other_lane).lines.size() - 1;
  EXPECT_TRUE(first_may_enter(site, lane, own, other, site.before(other_lane, 0.0, last)));
  EXPECT_TRUE(first_may_enter(site, lane, own, other, site.before(other_lane, least + 1e-3, last), 0.5));
  EXPECT_FALSE(first_may_enter(site, lane, own, other, site.before(other_lane, least - 1e-3, last), 0.5));
  // In the opposite case it waits, although it stopped there first.
  EXPECT_TRUE(first_may_enter(site, other_lane, other, own, site.before(lane, 1.0)));
  EXPECT_FALSE(first_may_enter(site, other_lane, other, own, site.before(lane, 0.3)));
  EXPECT_FALSE(first_may_enter(site, other_lane, other, own, site.on(own, 0.1))) << "before they meet";
  const std::uint32_t bend = site.exit("1.1", "12.1");
  const double end = site.conflict(other, bend).other_to;
  EXPECT_FALSE(first_may_enter(site, other_lane, other, bend, site.on(bend, end - 0.01)));
  EXPECT_TRUE(first_may_enter(site, other_lane, other, bend, site.on(bend, end + 0.01))) << "past where they meet";
}

/// Returns whether robot 7, which arrives later, drives on along `row` although 6 waits at the first line of a lane.
bool late_may_enter(const Site& site, std::uint32_t lane, std::uint32_t row, std::uint32_t other, std::uint32_t waits) {
  Observer me(site, 7);
  for (const double t : {0.0, 0.1})
    me.see(t, {7, site.before(lane, t == 0.0 ? 1.0 : 0.0)}, {{6, site.before(waits, 0.0)}});
  EXPECT_TRUE(me.approach().contends && me.user(1).approach.contends);
  return me.may_enter(row, other);
}

TEST(Precedence, IgnoresRobotsWaitingAtOtherLines) {
  const Site crossings(two_crossings());
  EXPECT_TRUE(late_may_enter(crossings, kFarCross, kFarCross, kMain, kMain)) << "at the line before";
  // 12.1 has a line halfway, where it crosses 7.1 without a bridge, and one at its end.
  const Site town(traffic::flat(simville()));
  EXPECT_TRUE(
      late_may_enter(town, town.lane("4.2"), town.exit("4.2", "3.2"), town.exit("12.1", "4.1"), town.lane("12.1")));
  // 3.1 crosses the end of 1.1, and 4.1 crosses 2.1, with their lines equally far along them.
  const Site site(straight_lanes({{{{0, 0}, {2, 0}}},
                                  {{{3, 0}, {8, 0}}},
                                  {{{2.5, -2.5}, {2.5, -0.5}}},
                                  {{{5, -2.5}, {5, -0.5}}},
                                  {{{2.5, 0.5}, {2.5, 3}}},
                                  {{{5, 0.5}, {5, 3}}}},
                                 {"exit 1.1.2 2.1.1", "exit 3.1.2 5.1.1", "exit 4.1.2 6.1.1"}));
  const std::uint32_t own = site.exit("1.1", "2.1"), other = site.exit("3.1", "5.1");
  EXPECT_EQ(site.corridors.way(2).lines, site.corridors.way(3).lines);
  EXPECT_FALSE(late_may_enter(site, 0, own, other, 2));
  EXPECT_TRUE(late_may_enter(site, 0, own, other, 3));
}

// ---- Lane changes.

// From 1.1 into 1.2, 5 m from its start. Boundaries: two radii behind the meeting point plus 2.5 s at its speed; two
// and a half radii beyond.
TEST(LaneChange, WaitsForRobotsAlongsideOrArrivingSoon) {
  const Site site(simville());
  const std::uint32_t target_lane = site.lane("1.2");
  const std::uint32_t change = site.way(control::Way::Kind::change, "1.1", "1.2", site.roads.lanes[0].points[9].s);
  const control::Conflict& conflict = site.conflict(change, target_lane);
  ASSERT_TRUE(conflict.yields);
  const auto may_enter = [&](std::uint32_t own, double s, double speed) {
    Observer me(site, own);
    me.see(0.0, {own, site.on(site.lane("1.1"), 2.5)}, {{6, site.on(target_lane, conflict.other_from + s), speed}});
    return me.may_enter(change, target_lane);
  };
  EXPECT_TRUE(may_enter(7, -2.0 * kRadius - 1e-2, 0.0));
  EXPECT_FALSE(may_enter(7, -2.0 * kRadius + 1e-2, 0.0));
  EXPECT_TRUE(may_enter(7, -2.0 * kRadius - 2.5 * 0.2 - 1e-2, 0.2));
  EXPECT_FALSE(may_enter(7, -2.0 * kRadius - 2.5 * 0.2 + 1e-2, 0.2));
  EXPECT_FALSE(may_enter(7, 2.5 * kRadius - 1e-2, 0.2));
  EXPECT_TRUE(may_enter(7, 2.5 * kRadius + 1e-2, 0.2)) << "the robot follows it";
  EXPECT_FALSE(may_enter(7, 2.5 * kRadius + 1e-2, 0.0)) << "at rest in the way";
  EXPECT_TRUE(may_enter(7, conflict.other_to - conflict.other_from + 1e-2, 0.0)) << "at rest beyond";
  EXPECT_TRUE(may_enter(5, 0.1, 0.0)) << "both at rest: the smaller id goes first";
  EXPECT_FALSE(may_enter(5, 0.1, 0.05));
}

// The other follower of the same leader blocks only next to the gap that it opens: two and a half radii behind.
TEST(LaneChange, EntersTheGapOpenedForIt) {
  const Site site(simville());
  const std::uint32_t target_lane = site.lane("1.2");
  const std::uint32_t change = site.way(control::Way::Kind::change, "1.1", "1.2", site.roads.lanes[0].points[9].s);
  const double meet = site.conflict(change, target_lane).other_from;
  const auto may_enter = [&](double s, std::uint32_t others_leader, bool merges) {
    Observer me(site, 7);
    me.see(0.0, {7, site.on(site.lane("1.1"), 2.5), 0.0, 3}, {{6, site.on(target_lane, meet + s), 0.2, others_leader}},
           merges);
    return me.may_enter(change, target_lane);
  };
  EXPECT_TRUE(may_enter(-2.5 * kRadius - 1e-2, 3, true));
  EXPECT_FALSE(may_enter(-2.5 * kRadius + 1e-2, 3, true));
  EXPECT_FALSE(may_enter(-2.5 * kRadius - 1e-2, 4, true)) << "that one follows another";
  EXPECT_FALSE(may_enter(-2.5 * kRadius - 1e-2, 3, false)) << "it has merged";
}

// Two lanes side by side, and one that crosses them where the way of a lane change runs.
TEST(LaneChange, CrossesALaneWhenNoRobotApproaches) {
  const Site site(straight_lanes({{{{0, 0}, {2, 0}, {8, 0}}, {{0, 0.5}, {4, 0.5}, {8, 0.5}}}, {{{3, -3}, {3, 3}}}}));
  const std::uint32_t change = site.way(control::Way::Kind::change, "1.1", "1.2", 2.0), across = site.lane("2.1");
  Observer me(site, 5);
  me.see(0.0, {5, site.on(0, 1.0)}, {{6, site.before(across, 1.0)}});
  EXPECT_FALSE(me.approach().contends);
  EXPECT_TRUE(me.may_enter(change, across));
  // It arrived first, but at the line of its lane; a lane change has no line.
  me.see(0.1, {5, site.before(0, 0.1)}, {{6, site.before(across, 1.0)}});
  me.see(0.2, {5, site.before(0, 0.1)}, {{6, site.before(across, 0.1)}});
  EXPECT_TRUE(me.may_enter(0, across));
  EXPECT_FALSE(me.may_enter(change, across));
}

// Boundary: 0.15 radii before the stretch that two robots cannot share.
TEST(LaneChange, BlocksFromTheStartOfTheSharedStretch) {
  const Site site(straight_lanes({{{{0, 0}, {2, 0}, {8, 0}}, {{0, 0.5}, {4, 0.5}, {8, 0.5}}}, {{{3, -3}, {3, 3}}}}));
  const std::uint32_t change = site.way(control::Way::Kind::change, "1.1", "1.2", 2.0), across = site.lane("2.1");
  const control::Conflict& conflict = site.conflict(across, change);
  const auto may_enter = [&](double s) { return first_may_enter(site, across, across, change, site.on(change, s)); };
  EXPECT_TRUE(may_enter(conflict.other_from - kMargin - 3e-3));
  EXPECT_FALSE(may_enter(conflict.other_from - kMargin + 3e-3));
  EXPECT_FALSE(may_enter(conflict.other_to - 3e-3));
  EXPECT_TRUE(may_enter(conflict.other_to + 3e-3));
}

// ---- Merging behind a leader.

TEST(Merging, YieldsToTheLeaderAtAnyDistance) {
  const Site site(two_crossings());
  const double meet = site.conflict(kCross, kMain).other_from, clear = site.conflict(kCross, kMain).other_to;
  const auto may_enter = [&](double s, std::uint32_t leader, bool merges, std::uint32_t lane = kMain) {
    Observer me(site, 5);
    me.see(0.0, {5, site.before(kCross, 0.0), 0.0, leader}, {{6, site.on(lane, s)}}, merges);
    return me.may_enter(kCross, kMain);
  };
  EXPECT_FALSE(may_enter(0.5, 6, true));
  EXPECT_TRUE(may_enter(0.5, 6, false)) << "it has merged";
  EXPECT_TRUE(may_enter(0.5, 7, true)) << "another robot";
  EXPECT_FALSE(may_enter(meet + 0.1, 6, true));
  EXPECT_TRUE(may_enter(clear + 0.1, 6, true)) << "it has passed";
  EXPECT_TRUE(may_enter(0.5, 6, true, kFarCross)) << "on another lane";
}

TEST(Merging, YieldsToTheLeaderLeavingTheSameLane) {
  const Site site(simville());
  const std::uint32_t lane = site.lane("12.2"), from = site.lane("2.2");
  const Seen self{5, site.before(lane, 0.0, site.corridors.way(lane).lines.size() - 1), 0.0, 6};
  Observer me(site, 5);
  for (const bool merges : {true, false}) {
    me.see(0.0, self, {{6, site.on(from, 1.5)}}, merges);
    EXPECT_EQ(me.may_enter(site.exit("12.2", "2.1"), site.exit("2.2", "1.3")), !merges);
  }
}

// ---- Zones.

struct Yard : Site {
  using Site::Site;
  bool free_with(const Pose& X_WM, double speed = 0.0) const {
    Observer me(*this, 5);
    me.see(0.0, {5, on(lane("11.2"), 0.0)}, {{6, X_WM, speed}});
    return me.rights.zone_free(0);
  }
};

// Boundary: 0.35 radii from its parking position.
TEST(ZoneFree, WhileTheOthersAreParked) {
  const Yard site(simville());
  const Pose spot = site.corridors.parked(2);
  const auto aside = [&](double by) { return Pose{spot.x + by, spot.y, 0.0, spot.yaw}; };
  EXPECT_TRUE(site.free_with(spot));
  EXPECT_TRUE(site.free_with(spot, 0.009));
  EXPECT_FALSE(site.free_with(spot, 0.011));
  EXPECT_TRUE(site.free_with(aside(0.35 * kRadius - 1e-3)));
  EXPECT_FALSE(site.free_with(aside(0.35 * kRadius + 1e-3)));
}

// Boundary: its front at the end of the lane that leads into the zone.
TEST(ZoneFree, UntilARobotIsAboutToEnter) {
  Yard site(simville());
  EXPECT_TRUE(site.free_with(site.on(site.lane("11.2"), 0.45 - kRadius - 1e-3)));
  EXPECT_FALSE(site.free_with(site.on(site.lane("11.2"), 0.45 - kRadius + 1e-3)));
  EXPECT_TRUE(site.free_with(site.on(site.lane("6.1"), 1.2))) << "the end of another lane";
  EXPECT_TRUE(site.free_with(site.on(site.exit("6.1", "7.1"), 0.6))) << "an exit into another lane";
}

// Robots so small that the exits of the zone are outside it.
TEST(ZoneFree, UntilARobotIsOnAWayIntoOrOutOfIt) {
  const Yard site(simville(), {}, {.radius = 0.02, .front = 0.02});
  const auto& ways = site.corridors.ways();
  int exits = 0;
  for (std::uint32_t row = 0; row < ways.size(); ++row) {
    if (ways[row].kind != control::Way::Kind::exit || ways[row].zone != 0) continue;
    const Pose middle = site.on(row, 0.5 * ways[row].length);
    ASSERT_FALSE(site.corridors.inside(0, {middle.x, middle.y}));
    EXPECT_FALSE(site.free_with(middle)) << row;
    ++exits;
  }
  EXPECT_EQ(exits, 2);
}

// The exit into the zone is moved to the start of 7.1, so that no robot at the end of 7.1 can take it.
TEST(ZoneFree, EvenIfARobotHasPassedItsEntrance) {
  world::RoadNetwork roads = simville();
  const Site before(roads);
  for (world::RoadExit& exit : roads.exits)
    if (exit.to.kind == world::PointRef::Kind::perimeter)
      exit.from = {world::PointRef::Kind::lane, before.lane("7.1"), 0};
  const Yard site(roads);
  const std::uint32_t lane = site.lane("7.1");
  EXPECT_TRUE(site.free_with(site.on(lane, site.corridors.way(lane).length)));
}

}  // namespace
}  // namespace sf::traffic
