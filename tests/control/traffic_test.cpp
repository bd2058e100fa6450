// Driving on SimVille's streets: host only, every robot by what the others tell.

#include "tests/control/traffic.h"

#include <gtest/gtest.h>

#include <set>

#include "base/error.h"

namespace sf::traffic {
namespace {

using control::Value;
using Numbers = std::vector<double>;

std::vector<Setting> go(Numbers checkpoints, std::vector<Setting> more = {}) {
  more.push_back({"checkpoints", std::move(checkpoints), "test: "});
  return more;
}

// ---- Plans.

struct Planner {
  Streets streets;
  control::Corridors corridors{streets.roads, streets.world, {}};
  control::RoutePlan from(const std::string& lane, double s) const {
    return plan_from_lane(corridors, *place_on_lane(corridors, on_lane(streets.roads, lane, s)));
  }
};

TEST(RoutePlan, every_leg_begins_where_the_one_before_ends) {
  const Planner p;
  for (const auto& checkpoint : p.streets.roads.checkpoints) {
    control::RoutePlan plan = p.from("7.2", 0.4);
    ASSERT_TRUE(extend(p.corridors, plan, checkpoint)) << checkpoint.id;
    for (std::size_t i = 0; i + 1 < plan.legs.size(); ++i) {
      const auto& a = plan.legs[i];
      const auto& b = plan.legs[i + 1];
      const Vec2 end = point_on(p.corridors.way(a.way), a.to), start = point_on(p.corridors.way(b.way), b.from);
      EXPECT_LT(length(end - start), 1e-6) << checkpoint.id << " leg " << i;
      EXPECT_EQ(b.start, end_of(a));
    }
    const auto& last = plan.legs.back();
    const Vec2 end = point_on(p.corridors.way(last.way), last.to);
    // A spot's way ends where the robot's origin stands, its front at the checkpoint.
    const double off = checkpoint.at.kind == world::PointRef::Kind::spot ? 0.165 : 0.0;
    EXPECT_NEAR(length(end - checkpoint.p), off, 2e-4) << checkpoint.id;  // chords of 4 cm in bends
  }
}

TEST(RoutePlan, takes_the_shortest_way) {
  const Planner p;
  control::RoutePlan plan = p.from("4.1", 2.0);
  ASSERT_TRUE(extend(p.corridors, plan, *find_checkpoint(p.streets.roads, 8)));
  // Straight over the crossing: the rest of 4.1, 1.2 m, 5.1 to its sixth point.
  const auto& lane = p.streets.roads.lanes[plan.legs.back().way];
  EXPECT_EQ(plan.legs.size(), 3u);
  EXPECT_NEAR(length_of(plan), 0.6 + 1.2 + lane.points[5].s, 0.01);
}

TEST(RoutePlan, round_again_to_the_same_checkpoint) {
  const Planner p;
  control::RoutePlan plan = p.from("4.1", 0.1);
  const auto& checkpoint = *find_checkpoint(p.streets.roads, 7);
  ASSERT_TRUE(extend(p.corridors, plan, checkpoint));
  const double once = length_of(plan);
  ASSERT_TRUE(extend(p.corridors, plan, checkpoint));
  EXPECT_GT(length_of(plan), once + 5.0);
}

TEST(RoutePlan, avoids_what_it_is_told_to) {
  const Planner p;
  control::RoutePlan straight = p.from("4.1", 2.0);
  ASSERT_TRUE(extend(p.corridors, straight, *find_checkpoint(p.streets.roads, 8)));
  control::RoutePlan round = p.from("4.1", 2.0);
  ASSERT_TRUE(extend(p.corridors, round, *find_checkpoint(p.streets.roads, 8), straight.legs[1].way));
  EXPECT_GT(length_of(round), length_of(straight) + 1.0);
}

// Boundary: a cut in a lane ends at its next point, on an exit at that exit's end.
TEST(RoutePlan, is_cut_at_the_next_point) {
  const Planner p;
  control::RoutePlan plan = p.from("4.1", 0.1);
  ASSERT_TRUE(extend(p.corridors, plan, *find_checkpoint(p.streets.roads, 9)));
  const double exit = plan.legs[1].start;
  for (const double s : {0.0, 0.3, exit - 0.1, exit + 0.1}) {
    control::RoutePlan cut = plan;
    cut_after(p.corridors, cut, s);
    EXPECT_GE(length_of(cut), s);
    EXPECT_LT(length_of(cut), s + 1.4);
    ASSERT_TRUE(extend(p.corridors, cut, *find_checkpoint(p.streets.roads, 9)));
    EXPECT_NEAR(length_of(cut), length_of(plan), 1e-9) << s;
  }
}

TEST(StartPoses, stand_apart_on_lanes_and_come_from_the_seed) {
  const world::RoadNetwork roads = simville();
  const auto poses = control::start_poses(roads, 50, 1, 0.5);
  ASSERT_EQ(poses.size(), 50u);
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE(std::hypot(poses[i].x - poses[j].x, poses[i].y - poses[j].y), 0.5);
  EXPECT_EQ(poses[7].x, control::start_poses(roads, 50, 1, 0.5)[7].x);
  EXPECT_NE(poses[7].x, control::start_poses(roads, 50, 2, 0.5)[7].x);
  EXPECT_THROW(control::start_poses(roads, 500, 1, 0.5), base::InputError);
}

// ---- Meetings of ways: any two points on two ways that do not meet are clear of each other.

TEST(Corridors, ways_that_do_not_meet_are_clear_of_each_other) {
  const Planner p;
  const auto& ways = p.corridors.ways();
  using Kind = control::Way::Kind;
  int meets = 0;
  for (std::uint32_t a = 0; a < ways.size(); ++a) {
    if (ways[a].kind != Kind::exit || !ways[a].at_end) continue;
    for (std::uint32_t b = 0; b < ways.size(); ++b) {
      if (b == a || ways[b].kind != Kind::exit || !ways[b].at_end || ways[a].from == ways[b].from) continue;
      for (std::size_t i = 0; i < ways[a].points.size(); ++i) {
        for (std::size_t k = 0; k < ways[b].points.size(); ++k) {
          if (length(ways[a].points[i] - ways[b].points[k]) >= 0.34) continue;
          const bool known = std::any_of(ways[a].gates.begin(), ways[a].gates.end(), [&](const control::Gate& gate) {
            return std::any_of(gate.meetings.begin(), gate.meetings.end(), [&](const control::Meeting& m) {
              const double s = i * ways[a].step, t = k * ways[b].step;
              return m.way == b && m.from <= s && s <= m.to + 1e-9 && m.other_from <= t && t <= m.other_to + 1e-9;
            });
          });
          // What follows the other way is a following, no meeting.
          if (ways[a].into == ways[b].from || ways[b].into == ways[a].from) continue;
          EXPECT_TRUE(known) << a << " " << b;
          ++meets;
        }
      }
    }
  }
  EXPECT_GT(meets, 1000);
}

// ---- One robot alone.

double run_until_done(Streets& t, std::uint32_t row, double most) {
  while (!t.controllers[row]->done() && 1e-9 * double(t.time) < most) t.tick();
  return 1e-9 * double(t.time);
}

TEST(Route, drives_every_checkpoint_of_simville) {
  Streets t;
  Numbers all;
  for (const auto& checkpoint : t.roads.checkpoints) all.push_back(checkpoint.id);
  t.add(on_lane(t.roads, "1.1", 0.3), "route", go(all));
  t.begin();
  double worst = 0.0;
  std::set<std::uint32_t> headed;
  while (!t.controllers[0]->done() && t.time < 3'000'000'000'000) {
    t.tick();
    worst = std::max(worst, std::abs(t.controllers[0]->error()));
    headed.insert(t.intents[0].checkpoint);
  }
  EXPECT_TRUE(t.controllers[0]->done()) << "reached " << t.route(0).reached();
  EXPECT_EQ(t.route(0).reached(), all.size());
  for (const double id : all) EXPECT_TRUE(headed.count(std::uint32_t(id))) << id;
  EXPECT_LT(worst, 0.02);  // [m] from its line
  EXPECT_EQ(t.contacts, 0);
}

TEST(Route, drives_a_mission_round_and_round) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 0.3), "route",
        {{"mission", std::string(SF_SOURCE_DIR "/worlds/simville/simville.mdf"), ""}, {"loop", true, ""}});
  t.begin();
  while (t.route(0).reached() < 20 && t.time < 2'000'000'000'000) t.tick();
  EXPECT_GE(t.route(0).reached(), 20u);
  EXPECT_FALSE(t.controllers[0]->done());
}

// 6.2.3 is a stop sign; 1.3.17 too. Every time it comes to one it stands, its front within 5 cm of the line.
TEST(Route, stops_fully_at_every_stop_sign) {
  Streets t;
  t.add(on_lane(t.roads, "1.3", 0.3), "route", go({8, 4, 8, 4, 9, 8}));
  t.begin();
  int crossed = 0;
  bool stood = false;
  Vec2 last{t.pose(0).x + 0.165 * std::cos(t.pose(0).yaw), t.pose(0).y + 0.165 * std::sin(t.pose(0).yaw)};
  while (!t.controllers[0]->done() && t.time < 1'500'000'000'000) {
    t.tick();
    const Pose& X = t.pose(0);
    const Vec2 front{X.x + 0.165 * std::cos(X.yaw), X.y + 0.165 * std::sin(X.yaw)};
    for (const world::StopLine& stop : t.roads.stops) {
      const Vec2 middle = 0.5 * (stop.left + stop.right), across = stop.left - stop.right;
      const Vec2 along{across.y, -across.x};
      const double before = dot(last - middle, along) / length(along),
                   after = dot(front - middle, along) / length(along);
      if (length(front - middle) > 0.2) continue;
      if (before > -0.05 && before <= 0.0 && t.fleet->reports()[0].velocity.forward == 0.0) stood = true;
      if (before <= 0.0 && after > 0.0) {
        EXPECT_TRUE(stood) << "at " << middle.x << " " << middle.y;
        stood = false;
        ++crossed;
      }
    }
    last = front;
  }
  EXPECT_TRUE(t.controllers[0]->done());
  EXPECT_GE(crossed, 5);
}

// ---- Lights: all states, the front against the line on every tick.

struct LightCase {
  world::LightState state;
  bool crosses;  ///< within a minute
  bool stands;   ///< before
  const char* why;
};

TEST(Route, obeys_every_state_of_a_light) {
  using enum world::LightState;
  for (const LightCase& c :
       {LightCase{red, false, true, "red is shut"}, LightCase{green, true, false, "green is open"},
        LightCase{yellow, false, true, "yellow for ever, and it can stop"},
        LightCase{flashing_red, true, true, "as a stop sign"},
        LightCase{flashing_yellow, true, false, "open, with care"}, LightCase{dark, true, true, "as a stop sign"}}) {
    Streets t;
    t.world.lights = {light("it", {"6.1.3"}, {{c.state, 1.0}})};
    t.add(on_lane(t.roads, "6.1", 0.2), "route", go({10}));
    t.begin();
    bool crossed = false, stood = false;
    for (int i = 0; i < 300 && !crossed; ++i) {
      t.tick();
      crossed = t.pose(0).x + 0.165 > 2.8;
      stood = stood || t.fleet->reports()[0].velocity.forward == 0.0;
    }
    EXPECT_EQ(crossed, c.crosses) << c.why;
    EXPECT_EQ(stood, c.stands) << c.why;
  }
}

TEST(Route, never_crosses_a_red_light) {
  using enum world::LightState;
  int crossings = 0;
  for (int k = 0; k < 24; ++k) {
    Streets t;
    t.world.lights = {light("it", {"6.1.3"}, {{green, 4.0}, {yellow, 1.0}, {red, 5.0}}, 0.41 * k)};
    t.add(on_lane(t.roads, "6.1", 0.2), "route", go({10}));
    t.begin();
    for (int i = 0; i < 250; ++i) {
      const double before = t.pose(0).x + 0.165;
      t.tick();
      if (before > 2.8 || t.pose(0).x + 0.165 <= 2.8) continue;
      EXPECT_NE(t.signals[0].state, red) << "offset " << 0.41 * k;
      ++crossings;
    }
  }
  EXPECT_EQ(crossings, 24);
}

// ---- What it refuses.

std::string refusal(const std::vector<Setting>& settings, const Pose& X_WM) {
  Streets t;
  t.add(X_WM, "route", settings);
  try {
    t.begin();
    t.tick();
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Route, refuses_what_cannot_be_driven) {
  const Pose lane = on_lane(simville(), "1.1", 1.0);
  EXPECT_NE(refusal(go({99}), lane).find("'checkpoints' names 99"), std::string::npos);
  EXPECT_NE(refusal(go({1.5}), lane).find("names 1.5"), std::string::npos);
  EXPECT_NE(refusal({}, lane).find("nowhere to go"), std::string::npos);
  EXPECT_NE(refusal({{"park", std::string("13.9"), ""}}, lane).find("no parking spot '13.9'"), std::string::npos);
  EXPECT_NE(refusal({{"mission", std::string("none.mdf"), ""}}, lane).find("none.mdf"), std::string::npos);
  EXPECT_NE(refusal(go({1}), {5.3, 5.0, 0, 0}).find("no lane"), std::string::npos);
  EXPECT_NE(refusal(go({1}, {{"speed", 0.0, ""}}), lane).find("'speed'"), std::string::npos);
  EXPECT_NE(refusal(go({1}, {{"tour", true, ""}}), lane).find("'tour'"), std::string::npos);
  EXPECT_EQ(refusal(go({1}), lane), "");
}

// A network of one lane that goes nowhere: the second time round there is no way.
TEST(Route, says_where_no_way_leads) {
  Streets t;
  t.roads.exits.clear();
  t.add(on_lane(t.roads, "1.1", 1.0), "route", go({4}));
  t.begin();
  try {
    t.tick();
    FAIL() << "no exception";
  } catch (const base::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no way to checkpoint 4 (way-point 1.3.6)"), std::string::npos)
        << error.what();
  }
}

// ---- Two and more.

TEST(Route, follows_a_slower_robot_without_touching_it) {
  for (const double slow : {0.02, 0.1, 0.19}) {
    Streets t;
    t.add(on_lane(t.roads, "1.3", 2.0), "route", go({8}, {{"speed", slow, ""}}));
    t.add(on_lane(t.roads, "1.3", 0.5), "route", go({8}));
    t.begin();
    double least = 9.0;
    for (int i = 0; i < 300; ++i) {
      t.tick();
      least = std::min(least, t.distance(0, 1));
    }
    EXPECT_EQ(t.contacts, 0) << slow;
    EXPECT_GT(least, 0.36) << slow;  // two radii and a gap
    if (slow < 0.19) EXPECT_NEAR(t.fleet->reports()[1].velocity.forward, slow, 0.01) << slow;
  }
}

// Behind somebody who stands for ever it stands too, near but not touching.
TEST(Route, stands_behind_who_stands) {
  Streets t;
  t.add(on_lane(t.roads, "4.1", 2.0), "route", go({7}, {{"speed", 0.01, ""}}));
  t.add(on_lane(t.roads, "4.1", 0.5), "route", go({8}));
  t.begin();
  struct Stands final : control::Controller {
    Twist step(const control::Input&) override { return {}; }
  };
  t.controllers[0] = std::make_unique<Stands>();
  for (int i = 0; i < 300; ++i) t.tick();
  EXPECT_EQ(t.fleet->reports()[1].velocity.forward, 0.0);
  EXPECT_GT(t.distance(0, 1), 0.37);
  EXPECT_LT(t.distance(0, 1), 0.5);
  EXPECT_EQ(t.contacts, 0);
}

// ---- Right of way.

// 12.2 has a stop sign, 2.2 has none: who comes along 2.2 goes first, though the other stood there before it came.
TEST(RightOfWay, who_need_not_stop_goes_first) {
  Streets t;
  t.add(on_lane(t.roads, "12.2", 3.4), "route", go({4, 8}));
  t.add(on_lane(t.roads, "2.2", 2.45), "route", go({4, 8}));
  t.begin();
  double first = 0.0, second = 0.0;
  for (int i = 0; i < 300; ++i) {
    t.tick();
    if (second == 0.0 && t.pose(0).x < 6.5) second = 0.1 * i;
    if (first == 0.0 && t.pose(1).x < 6.5) first = 0.1 * i;
  }
  EXPECT_GT(first, 0.0);
  EXPECT_GT(second, first);
  EXPECT_EQ(t.contacts, 0);
}

// Two dark lights face each other across a third: of those that stood, the first that stood goes first.
TEST(RightOfWay, first_come_first_served) {
  for (const bool other_first : {false, true}) {
    Streets t;
    t.world.lights = {light("a", {"6.1.3", "10.2.3"}, {{world::LightState::dark, 1.0}})};
    t.add(on_lane(t.roads, "6.1", other_first ? 0.3 : 0.7), "route", go({10}));
    t.add(on_lane(t.roads, "10.2", other_first ? 0.8 : 0.4), "route", go({10}));
    t.begin();
    double a = 0.0, b = 0.0;
    for (int i = 0; i < 300; ++i) {
      t.tick();
      if (a == 0.0 && t.pose(0).x > 4.0) a = 0.1 * i;
      if (b == 0.0 && t.pose(1).x > 4.0) b = 0.1 * i;
    }
    EXPECT_GT(a, 0.0);
    EXPECT_GT(b, 0.0);
    EXPECT_EQ(b < a, other_first);
    EXPECT_EQ(t.contacts, 0);
  }
}

// The bridge is flat: of two that come to it at right angles one waits, and nobody waits for ever.
TEST(RightOfWay, lanes_that_cross_without_a_sign) {
  for (int k = 0; k < 10; ++k) {
    Streets t;
    t.add(on_lane(t.roads, "7.1", 1.0 + 0.1 * k), "route", go({11, 5}));
    t.add(on_lane(t.roads, "12.1", 0.1), "route", go({13, 7}));
    t.begin();
    for (int i = 0; i < 300; ++i) t.tick();
    EXPECT_EQ(t.contacts, 0) << k;
    EXPECT_GE(t.route(0).reached(), 1u) << k;
    EXPECT_GE(t.route(1).reached(), 1u) << k;
  }
}

// A lane full of standing robots beyond a crossing: who comes stops before the crossing, not within.
TEST(RightOfWay, does_not_block_the_box) {
  Streets t;
  struct Stands final : control::Controller {
    Twist step(const control::Input&) override { return {}; }
  };
  t.add(on_lane(t.roads, "5.1", 0.2), "route", go({8}));
  t.add(on_lane(t.roads, "4.1", 1.0), "route", go({8}));
  t.begin();
  t.controllers[0] = std::make_unique<Stands>();
  for (int i = 0; i < 200; ++i) t.tick();
  const double line = 4.0;  // [m] where 4.1 ends
  EXPECT_GT(t.pose(1).x - 0.165, line);
  EXPECT_LT(t.pose(1).x - 0.165, line + 0.05);
}

// ---- Parking.

TEST(Parking, stops_with_its_front_at_the_end_of_every_spot) {
  for (std::uint32_t spot = 0; spot < 6; ++spot) {
    Streets t;
    t.add(on_lane(t.roads, "10.2", 0.3), "route", {{"park", "13." + std::to_string(spot + 1), ""}});
    t.begin();
    bool docking = false;
    for (int i = 0; i < 1200 && !t.controllers[0]->done(); ++i) {
      t.tick();
      docking = docking || t.intents[0].docking;
    }
    ASSERT_TRUE(t.controllers[0]->done()) << spot;
    EXPECT_TRUE(docking);
    const world::RoadSpot& s = t.roads.spots[spot];
    const Vec2 d = s.end - s.entry;
    const Pose& X = t.pose(0);
    const Vec2 front{X.x + 0.165 * std::cos(X.yaw), X.y + 0.165 * std::sin(X.yaw)};
    EXPECT_LT(length(front - s.end), 0.02) << spot;
    EXPECT_LT(std::abs(base::wrap_angle(X.yaw - std::atan2(d.y, d.x))), 3.0 * M_PI / 180) << spot;
    EXPECT_EQ(t.contacts, 0);
  }
}

// Five leave their spots for the streets while a sixth comes in: one after another, whatever they all want at once.
TEST(Parking, a_full_car_park_empties_while_another_comes_in) {
  Streets t;
  const control::Corridors corridors(t.roads, t.world, {});
  for (std::uint32_t spot = 0; spot < 5; ++spot)
    t.add(corridors.parked(spot), "route", go({8, 9.0 + spot % 2}, {{"loop", true, ""}}));
  t.add(on_lane(t.roads, "10.2", 0.3), "route", {{"park", std::string("13.6"), ""}});
  t.begin();
  for (int i = 0; i < 3000; ++i) {
    t.tick();
    int about = 0;
    for (std::uint32_t row = 0; row < 6; ++row) {
      const Vec2 p{t.pose(row).x, t.pose(row).y};
      const bool stands = control::spot_at(corridors, t.pose(row)).has_value();
      about += corridors.inside(0, p) && !stands;
    }
    ASSERT_LE(about, 1) << 0.1 * i;
  }
  EXPECT_TRUE(t.controllers[5]->done());
  for (std::uint32_t row = 0; row < 5; ++row) EXPECT_GT(t.route(row).reached(), 2u) << row;
  EXPECT_EQ(t.contacts, 0);
}

// ---- Convoys.

TEST(Convoy, a_chain_of_five_keeps_its_gaps) {
  Streets t;
  for (int k = 0; k < 5; ++k) {
    const Pose X_WM = on_lane(t.roads, "1.1", 4.0 - 0.6 * k);
    if (k == 0) t.add(X_WM, "route", go({6, 7, 8, 2}, {{"loop", true, ""}}));
    if (k > 0) t.add(X_WM, "convoy", {{"leader", double(k), ""}});
  }
  t.begin();
  double longest = 0.0, least = 9.0, farthest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    t.tick();
    for (std::uint32_t k = 1; k < 5; ++k) {
      EXPECT_EQ(t.intents[k].follows, k);
      least = std::min(least, t.distance(k, k - 1));
      farthest = std::max(farthest, t.distance(k, k - 1));
    }
    longest = std::max(longest, t.distance(0, 4));
  }
  EXPECT_EQ(t.contacts, 0);
  EXPECT_GT(t.route(0).reached(), 6u);
  EXPECT_GT(least, 0.4);
  // One may have to stop at a stop sign where the one ahead has just gone.
  EXPECT_LT(farthest, 2.5);
}

// Where a robot is along the way that the leader of all has driven: the order of a convoy.
struct Trail {
  std::vector<Vec2> points;
  void add(const Pose& X) { points.push_back({X.x, X.y}); }
  std::size_t nearest(const Pose& X) const {
    std::size_t best = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (length(points[i] - Vec2{X.x, X.y}) <= length(points[best] - Vec2{X.x, X.y})) best = i;
    return best;
  }
};

// Robot 4 waits at the stop sign of 12.2 and comes in behind robot 1, which robots 2 and 3 follow in a chain.
TEST(Convoy, lets_a_robot_in_between) {
  Streets t;
  t.add(on_lane(t.roads, "2.2", 2.2), "route", go({4, 8}));
  t.add(on_lane(t.roads, "2.2", 1.6), "convoy", {{"leader", 1.0, ""}});
  t.add(on_lane(t.roads, "2.2", 1.0), "convoy", {{"leader", 2.0, ""}});
  t.add(on_lane(t.roads, "12.2", 3.5), "route", go({4, 8}, {{"merge_behind", 1.0, ""}}));
  t.begin();
  Trail trail;
  for (int i = 0; i < 420; ++i) {
    t.tick();
    trail.add(t.pose(0));
  }
  EXPECT_EQ(t.contacts, 0);
  EXPECT_EQ(t.intents[3].follows, 1u);
  EXPECT_EQ(t.intents[1].follows, 4u);  // it followed 1 until 4 was there
  EXPECT_EQ(t.intents[2].follows, 2u);
  EXPECT_GT(trail.nearest(t.pose(3)), trail.nearest(t.pose(1)));
  EXPECT_GT(trail.nearest(t.pose(1)), trail.nearest(t.pose(2)));
}

// The same from the lane beside: robot 4 drives on 1.2 and comes over to the convoy on 1.1.
TEST(Convoy, lets_a_robot_in_from_the_lane_beside) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 2.0), "route", go({2, 5}, {{"speed", 0.15, ""}}));
  t.add(on_lane(t.roads, "1.1", 1.4), "convoy", {{"leader", 1.0, ""}});
  t.add(on_lane(t.roads, "1.1", 0.8), "convoy", {{"leader", 2.0, ""}});
  t.add(on_lane(t.roads, "1.2", 2.2), "route", go({2, 5}, {{"merge_behind", 1.0, ""}}));
  t.begin();
  Trail trail;
  for (int i = 0; i < 500; ++i) {
    t.tick();
    trail.add(t.pose(0));
  }
  EXPECT_EQ(t.contacts, 0);
  EXPECT_EQ(t.intents[3].follows, 1u);
  EXPECT_EQ(t.intents[1].follows, 4u);
  EXPECT_GT(trail.nearest(t.pose(3)), trail.nearest(t.pose(1)));
  EXPECT_GT(trail.nearest(t.pose(1)), trail.nearest(t.pose(2)));
}

// ---- Passing.

TEST(Passing, goes_round_a_slower_robot_and_comes_back) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 2.4), "route", go({5}, {{"speed", 0.03, ""}}));
  t.add(on_lane(t.roads, "1.1", 1.2), "route", go({5}));
  t.begin();
  const control::Corridors corridors(t.roads, t.world, {});
  bool beside = false, back = false;
  for (int i = 0; i < 400; ++i) {
    t.tick();
    const auto place = place_on_lane(corridors, t.pose(1));
    if (!place || place->offset > 0.02) continue;
    const std::string lane = name_of(t.roads, t.roads.lanes[place->way]);
    beside = beside || lane == "1.2";
    back = back || (beside && lane == "1.1" && t.pose(1).x > t.pose(0).x + 0.4);
  }
  EXPECT_TRUE(beside);
  EXPECT_TRUE(back);
  EXPECT_EQ(t.contacts, 0);
}

// Robots on the other lane, one beside and one coming up from behind as fast: it stays where it is.
TEST(Passing, waits_until_the_other_lane_is_free) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 2.4), "route", go({5}, {{"speed", 0.03, ""}}));
  t.add(on_lane(t.roads, "1.1", 1.6), "route", go({5}));
  t.add(on_lane(t.roads, "1.2", 2.4), "route", go({5}, {{"speed", 0.03, ""}, {"pass", false, ""}}));
  t.begin();
  double farthest = 0.0;
  for (int i = 0; i < 200; ++i) {
    t.tick();
    farthest = std::max(farthest, std::abs(t.controllers[1]->error()));
    EXPECT_LT(t.pose(1).x, t.pose(0).x) << "it passed";
  }
  EXPECT_LT(farthest, 0.02);
  EXPECT_EQ(t.contacts, 0);
}

// Boundary: `pass false` never changes lanes.
TEST(Passing, does_not_where_it_must_not) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 2.4), "route", go({5}, {{"speed", 0.03, ""}}));
  t.add(on_lane(t.roads, "1.1", 1.2), "route", go({5}, {{"pass", false, ""}}));
  t.begin();
  for (int i = 0; i < 300; ++i) t.tick();
  EXPECT_LT(t.pose(1).x, t.pose(0).x);
  EXPECT_EQ(t.contacts, 0);
}

// ---- Crowds.

struct Crowd {
  int contacts = 0;
  std::uint64_t goals = 0, least = 0;
  double longest_stand = 0.0;  // [s]
  double x = 0.0;              // of one robot, at the end
};

Crowd crowd(std::size_t count, double seconds, std::uint64_t seed, bool lights) {
  Streets t;
  if (lights) t.add_lights();
  for (const Pose& pose : control::start_poses(t.roads, count, seed, 0.5)) t.add(pose, "route", {{"tour", true, ""}});
  t.begin(seed);
  std::vector<double> stands(count);
  Crowd c;
  for (int i = 0; i < seconds * 10; ++i) {
    t.tick();
    for (std::size_t k = 0; k < count; ++k) {
      const Twist& v = t.fleet->reports()[k].velocity;
      stands[k] = v.forward == 0.0 && v.turn == 0.0 ? stands[k] + 0.1 : 0.0;
      c.longest_stand = std::max(c.longest_stand, stands[k]);
    }
  }
  c.contacts = t.contacts;
  c.least = ~0ull;
  for (std::uint32_t k = 0; k < count; ++k) {
    c.goals += t.route(k).reached();
    c.least = std::min(c.least, t.route(k).reached());
  }
  c.x = t.pose(3).x;
  return c;
}

TEST(Crowd, fifty_touch_nobody_and_all_get_on) {
  for (const std::uint64_t seed : {1u, 2u}) {
    const Crowd c = crowd(50, 600, seed, seed == 2);
    EXPECT_EQ(c.contacts, 0) << seed;
    EXPECT_GT(c.goals, 100u) << seed;
    EXPECT_LT(c.longest_stand, 240.0) << seed;
  }
}

TEST(Crowd, twenty_all_reach_checkpoints) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Crowd c = crowd(20, 400, seed, seed % 2 == 0);
    EXPECT_EQ(c.contacts, 0) << seed;
    EXPECT_GT(c.least, 0u) << seed;
    EXPECT_LT(c.longest_stand, 90.0) << seed;
  }
}

TEST(Crowd, goes_the_same_way_again_and_another_with_another_seed) {
  EXPECT_EQ(crowd(20, 60, 1, true).x, crowd(20, 60, 1, true).x);
  EXPECT_NE(crowd(20, 60, 1, true).x, crowd(20, 60, 3, true).x);
}

}  // namespace
}  // namespace sf::traffic
