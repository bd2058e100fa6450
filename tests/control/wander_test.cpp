#include "control/wander.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "base/error.h"
#include "robots/fleet.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::control {
namespace {

using base::Pose;
using base::ReadingBlock;
using base::Twist;

sensors::LaserSettings laser(double fov, std::uint32_t samples, double range_max, const Pose& X_MS = {}) {
  sensors::LaserSettings l;
  l.X_MS = X_MS;
  l.fov = fov;
  l.samples = samples;
  l.range_max = range_max;
  return l;
}

// Returns the lasers of the mover in that row.
std::vector<sensors::SensorSpec> lasers_in(const world::World& world, std::uint32_t row = 0) {
  const sensors::SensorSet sensor_set(world);
  const auto specs = sensor_set.of(sensors::kLaser, row);
  return {specs.begin(), specs.end()};
}

// Returns the range along a bearing to walls and the bodies of other movers, by brute force.
double cast(const world::World& world, std::span<const base::Report> reports, std::size_t own, glm::dvec2 p,
            double bearing, double range_max) {
  const glm::dvec2 u{std::cos(bearing), std::sin(bearing)};
  double range = range_max;
  const auto meet = [&](glm::dvec2 a, glm::dvec2 b) {
    const double area = base::cross(u, b - a);
    const double t = base::cross(a - p, b - a) / area, s = base::cross(a - p, u) / area;
    if (area != 0.0 && t >= 0.0 && s >= 0.0 && s <= 1.0) range = std::min(range, t);
  };
  for (const auto& wall : world.walls) meet(wall.a, wall.b);
  for (std::size_t row = 0; row < reports.size(); ++row) {
    if (row == own) continue;
    for (const auto& s : world.movers[row].body)
      meet(transform(reports[row].X_WM, s.a), transform(reports[row].X_WM, s.b));
  }
  return range;
}

// A fleet with `wander` and ideal lasers.
struct WanderWalk {
  explicit WanderWalk(const world::World& w, std::uint64_t seed = 1) : world(w), fleet(world) {
    for (std::uint32_t row = 0; row < world.movers.size(); ++row)
      wanderers.emplace_back(world.movers[row], lasers_in(world, row), row, seed);
  }
  void tick() {
    std::vector<Twist> commands;
    for (std::uint32_t row = 0; row < wanderers.size(); ++row) {
      const base::Report& state = fleet.reports()[row];
      const std::vector<sensors::LaserSettings> lasers = sensors::lasers_of(world.movers[row]);
      std::vector<std::vector<double>> ranges(lasers.size());
      std::vector<ReadingBlock> blocks;
      for (std::uint32_t i = 0; i < lasers.size(); ++i) {
        const Pose X_WS = compose(state.X_WM, lasers[i].X_MS);
        for (std::uint32_t k = 0; k < lasers[i].samples; ++k) {
          const double along = lasers[i].samples > 1 ? double(k) / (lasers[i].samples - 1) - 0.5 : 0.0;
          ranges[i].push_back(cast(world, fleet.reports(), row, {X_WS.x, X_WS.y}, X_WS.yaw + along * lasers[i].fov,
                                   lasers[i].range_max));
        }
        blocks.push_back({.mover = row, .sensor = i, .type = 1, .values = ranges[i]});
      }
      commands.push_back(wanderers[row].step({state.time, state, blocks, fleet.contacts()[row] != 0}));
    }
    fleet.move(commands, kTick);
    for (const auto contact : fleet.contacts()) contacts += contact;
  }
  world::World world;
  robots::Fleet fleet;
  std::vector<Wander> wanderers;
  int contacts = 0;
};

// Results of one robot in a closed world.
struct Walked {
  double distance = 0.0;      // [m]
  std::size_t cells = 0;      // of 1 m visited
  double longest_stay = 0.0;  // [s] within 0.2 m of one place
  int contacts = 0;
};

Walked walk(const world::World& world, double seconds, std::uint64_t seed = 1) {
  WanderWalk w(world, seed);
  Walked result;
  std::set<std::pair<int, int>> cells;
  Pose last = w.fleet.reports()[0].X_WM, anchor = last;
  double stay = 0.0;
  for (int i = 0; i < seconds * 10; ++i) {
    w.tick();
    const Pose X = w.fleet.reports()[0].X_WM;
    result.distance += std::hypot(X.x - last.x, X.y - last.y);
    stay = std::hypot(X.x - anchor.x, X.y - anchor.y) < 0.2 ? stay + 0.1 : 0.0;
    if (stay == 0.0) anchor = X;
    result.longest_stay = std::max(result.longest_stay, stay);
    cells.insert({int(std::floor(X.x)), int(std::floor(X.y))});
    last = X;
  }
  result.cells = cells.size();
  result.contacts = w.contacts;
  return result;
}

world::World arena() {
  world::World world = scenes::boxed_world(8, 8);
  scenes::add_outline(world.walls, scenes::rectangle({5, 5}, 1.5, 0.5));
  scenes::add_outline(world.walls, scenes::rectangle({2, 6}, 0.4, 1.5));
  return world;
}

TEST(Wander, WithAScannerCoversGroundWithoutContact) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    world::World world = arena();
    scenes::add_create(world, {2, 2, 0, 0.3})
        .sensors.push_back(sensors::laser_sensor(laser(M_PI, 181, 8.0, {0.1, 0, 0, 0})));
    const Walked w = walk(world, 60, seed);
    EXPECT_GT(w.distance, 10.0) << "seed " << seed;
    EXPECT_GT(w.cells, 12u) << "seed " << seed;
    EXPECT_LT(w.longest_stay, 6.0) << "seed " << seed;
    EXPECT_LE(w.contacts, 3) << "seed " << seed;
  }
}

// Touched only from behind, the robot drives forward if there is room, otherwise turns. Touched elsewhere, it backs
// off.
TEST(Wander, DrivesForwardWhenTouchedFromBehind) {
  world::World world = arena();
  scenes::add_create(world, {2, 2, 0, 0.3}).sensors.push_back(sensors::laser_sensor(laser(M_PI, 181, 8.0)));
  const auto first_twist = [&](double range, std::uint32_t contact_mask) {
    Wander wander(world.movers[0], lasers_in(world), 0, 1);
    const std::vector<double> ranges(181, range);
    const ReadingBlock block{.mover = 0, .sensor = 0, .type = 1, .values = ranges};
    base::Report state{.X_WM = world.movers[0].X_WM, .contact_mask = contact_mask};
    return wander.step({0, state, {&block, 1}, true});
  };
  EXPECT_GT(first_twist(8.0, 1u << 16).forward, 0.0) << "straight behind";
  EXPECT_GT(first_twist(8.0, 1u << 8).forward, 0.0) << "first sector of the rear";
  EXPECT_GT(first_twist(8.0, 1u << 23).forward, 0.0) << "last sector of the rear";
  EXPECT_EQ(first_twist(0.17, 1u << 16).forward, 0.0) << "no room ahead";
  EXPECT_NE(first_twist(0.17, 1u << 16).turn, 0.0);
  EXPECT_LT(first_twist(8.0, 1u << 7).forward, 0.0) << "last sector of the front, left";
  EXPECT_LT(first_twist(8.0, 1u << 24).forward, 0.0) << "first sector of the front, right";
  EXPECT_LT(first_twist(8.0, (1u << 16) | 1u).forward, 0.0) << "both";
  EXPECT_LT(first_twist(8.0, 0u).forward, 0.0) << "in an unknown direction";
}

TEST(Wander, WithTwelveSingleBeamsKeepsMoving) {
  world::World world = arena();
  world::Mover& mover = scenes::add_create(world, {2, 2, 0, 0.3});
  for (int i = 0; i < 12; ++i) {
    const double yaw = M_PI * i / 6;
    mover.sensors.push_back(
        sensors::laser_sensor(laser(0, 1, 0.5, {0.16 * std::cos(yaw), 0.16 * std::sin(yaw), 0, yaw})));
  }
  const Walked w = walk(world, 120);
  EXPECT_GT(w.distance, 12.0);
  EXPECT_GT(w.cells, 12u);
  EXPECT_LT(w.longest_stay, 10.0);
}

TEST(Wander, WithoutALaserWandersByTouch) {
  world::World world = arena();
  scenes::add_create(world, {2, 2, 0, 0.3});
  const Walked w = walk(world, 120);
  EXPECT_GT(w.distance, 12.0);
  EXPECT_GT(w.cells, 12u);
  EXPECT_LT(w.longest_stay, 10.0);
  EXPECT_GT(w.contacts, 0);
}

TEST(Wander, TinyRobotWithAShortRange) {
  world::World world = scenes::boxed_world(1, 1);
  std::vector<glm::dvec2> corners;
  for (int i = 0; i < 12; ++i) corners.push_back(0.035 * glm::dvec2{std::cos(M_PI * i / 6), std::sin(M_PI * i / 6)});
  world::Mover& mover = scenes::add_mover(world, {0.5, 0.5, 0, 1}, corners);
  mover.max_forward = 0.3;
  for (int i = -2; i <= 2; ++i)
    mover.sensors.push_back(sensors::laser_sensor(laser(0, 1, 0.1, {0.035, 0, 0, 0.5 * i})));
  EXPECT_GT(walk(world, 60).distance, 3.0);
}

TEST(Wander, CarKeepsMoving) {
  world::World world = arena();
  world::Mover& mover = scenes::add_square(world, {2, 2, 0, 0.3});
  mover.drive = world::Drive::car;
  mover.wheelbase = 0.3;
  mover.sensors.push_back(sensors::laser_sensor(laser(M_PI, 61, 8.0)));
  const Walked w = walk(world, 120);
  EXPECT_GT(w.distance, 12.0);
  EXPECT_GT(w.cells, 6u);
}

TEST(Wander, CrowdKeepsMoving) {
  world::World world = arena();
  for (int i = 0; i < 12; ++i) {
    scenes::add_create(world, {1.0 + i % 4, 1.0 + i / 4, 0, 0.5 * i})
        .sensors.push_back(sensors::laser_sensor(laser(M_PI, 61, 8.0)));
  }
  WanderWalk w(world);
  std::vector<double> distance(12);
  for (int i = 0; i < 600; ++i) {
    w.tick();
    for (int k = 0; k < 12; ++k) distance[k] += 0.1 * std::abs(w.fleet.reports()[k].velocity.forward);
  }
  for (const double d : distance) EXPECT_GT(d, 5.0);
}

TEST(Wander, DependsOnTheSeed) {
  world::World world = arena();
  scenes::add_create(world, {2, 2, 0, 0.3}).sensors.push_back(sensors::laser_sensor(laser(M_PI, 61, 8.0)));
  WanderWalk a(world, 1), b(world, 1), c(world, 2);
  for (int i = 0; i < 300; ++i) a.tick(), b.tick(), c.tick();
  EXPECT_EQ(a.fleet.reports()[0].X_WM.x, b.fleet.reports()[0].X_WM.x);
  EXPECT_NE(a.fleet.reports()[0].X_WM.x, c.fleet.reports()[0].X_WM.x);
}

// ---- Odd readings.

TEST(Wander, StaysFiniteWhateverItReads) {
  world::World world = scenes::empty_world();
  world::Mover& mover = scenes::add_create(world, {});
  mover.sensors.push_back(sensors::laser_sensor(laser(M_PI, 37, 8.0)));
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double range : {0.0, 1e-300, 0.3, 8.0, inf, -inf, -1.0, nan}) {
    Wander wander(mover, lasers_in(world), 0, 1);
    const std::vector<double> ranges(37, range);
    const std::vector<ReadingBlock> blocks{{.type = 1, .values = ranges}};
    for (int i = 0; i < 200; ++i) {
      const Twist v = wander.step({i * kTick, {.X_WM = {0, 0, 0, 0.1 * i}}, blocks, i % 17 == 0});
      ASSERT_TRUE(std::isfinite(v.forward) && std::isfinite(v.left) && std::isfinite(v.turn)) << range;
      ASSERT_LE(std::abs(v.forward), mover.max_forward);
      ASSERT_LE(std::abs(v.turn), mover.max_turn);
    }
  }
}

TEST(Wander, IgnoresReadingsThatAreNotItsOwnLasers) {
  world::World world = scenes::empty_world();
  world::Mover& mover = scenes::add_create(world, {});
  mover.sensors.push_back(sensors::laser_sensor(laser(M_PI, 3, 8.0)));
  const std::vector<double> zeros(3, 0.0), few;
  Wander wander(mover, lasers_in(world), 0, 1);
  const std::vector<ReadingBlock> blocks{
      {.sensor = 7, .type = 1, .values = zeros}, {.type = 9, .values = zeros}, {.type = 1, .values = few}};
  EXPECT_GT(wander.step({0, {}, blocks, false}).forward, 0.3);
}

TEST(Wander, BacksOffAfterAContactThenTurns) {
  world::World world = scenes::empty_world();
  Wander wander(scenes::add_create(world, {}), {}, 0, 1);
  EXPECT_GT(wander.step({0, {}, {}, false}).forward, 0.0);
  EXPECT_LT(wander.step({kTick, {}, {}, true}).forward, 0.0);
  const Twist later = wander.step({20 * kTick, {}, {}, false});
  EXPECT_EQ(later.forward, 0.0);
  EXPECT_NE(later.turn, 0.0);
}

// ---- Single decisions: a Create with a laser of 181 beams over 180 degrees, 8 m range, at its centre.

TEST(Wander, DistancesDependOnBodySpeedAndRange) {
  world::World world = scenes::empty_world();
  world::Mover& mover = scenes::add_create(world, {});
  struct Sized {
    double max_forward, radius, sight, stop, resume, slow;
    const char* why;
  };
  for (const Sized& s : {Sized{0.5, 0.165, 8.0, 0.2, 0.4, 1.0, "what it can stop in: 0.4 s of its speed"},
                         Sized{0.3, 0.4, 8.0, 0.2, 0.4, 1.0, "half its radius"},
                         Sized{0.5, 0.165, 0.6, 0.18, 0.36, 0.57, "0.3, 0.6 and 0.95 of a short sight"}}) {
    mover.max_forward = s.max_forward;
    mover.radius = s.radius;
    const WanderSettings settings = wander_settings(mover, s.sight);
    EXPECT_NEAR(settings.stop, s.stop, 1e-12) << s.why;
    EXPECT_NEAR(settings.resume, s.resume, 1e-12) << s.why;
    EXPECT_NEAR(settings.slow, s.slow, 1e-12) << s.why;
    EXPECT_NEAR(settings.speed, 0.8 * s.max_forward, 1e-12) << s.why;
  }
  mover.max_turn = 1.0;
  EXPECT_NEAR(wander_settings(mover, 8.0).turn, 0.8, 1e-12);
  mover.max_turn = 4.0;
  EXPECT_EQ(wander_settings(mover, 8.0).turn, 1.5) << "at most";
}

struct Eyes {
  Eyes() {
    scenes::add_create(world, {}).sensors.push_back(sensors::laser_sensor(laser(M_PI, 181, 8.0)));
    wander.emplace(world.movers[0], lasers_in(world), 0, 1);
  }
  /// @param front [m] range of the 3 middle beams, including 0.165 m to the body's front
  Twist look(double seconds, double front, double right = 8.0, double left = 8.0, double yaw = 0.0,
             bool contact = false) {
    std::vector<double> ranges(181, right);
    std::fill(ranges.begin() + 89, ranges.end(), front);
    std::fill(ranges.begin() + 92, ranges.end(), left);
    const ReadingBlock block{.type = 1, .values = ranges};
    return wander->step({static_cast<std::int64_t>(1e9 * seconds), {.X_WM = {0, 0, 0, yaw}}, {&block, 1}, contact});
  }
  world::World world = scenes::empty_world();
  std::optional<Wander> wander;
};

// `--set speed=0.1`; at most the robot's maximum.
TEST(Wander, AcceptsASpeed) {
  world::World world = scenes::boxed_world(6.0, 4.0, {-3.0, -2.0});
  scenes::add_mover(world, {0.0, 0.0, 0.0, 0.0}, scenes::rectangle({0.0, 0.0}, 0.3, 0.3));
  const auto first_command = [&](std::vector<Setting> settings) {
    auto made = make_controller({.world = world}, {"wander", 0.0, Settings("wander", std::move(settings))});
    ControllerInput input{};
    return made.controller->step(input).forward;
  };
  EXPECT_DOUBLE_EQ(first_command({}), 0.8 * world.movers[0].max_forward);
  EXPECT_DOUBLE_EQ(first_command({{"speed", 0.1, ""}}), 0.1);
  EXPECT_DOUBLE_EQ(first_command({{"speed", world.movers[0].max_forward, ""}}), world.movers[0].max_forward);
  EXPECT_THROW(first_command({{"speed", world.movers[0].max_forward + 0.01, ""}}), base::InputError);
  EXPECT_THROW(first_command({{"speed", -0.1, ""}}), base::InputError);
}

TEST(Wander, SlowsDownProportionallyAndTurnsWhenBlocked) {
  // 0.4 m/s from 1 m on, a quarter of it at 0.2 m; below that the robot turns.
  for (const auto& [ahead, speed] : {std::pair{5.0, 0.4}, {1.01, 0.4}, {0.6, 0.4 * 0.625}, {0.201, 0.1}})
    EXPECT_NEAR(Eyes().look(0.0, ahead + 0.165).forward, speed, 1e-3) << ahead;
  const Twist blocked = Eyes().look(0.0, 0.199 + 0.165);
  EXPECT_EQ(blocked.forward, 0.0);
  EXPECT_NEAR(std::abs(blocked.turn), 0.8 * M_PI / 2, 1e-12);
}

// On free ground 0.3 of the turn rate times the difference of both sides, near an obstacle the full rate; plus a drift
// of 0.25.
TEST(Wander, SteersTowardsTheFreerSide) {
  const double most = 0.8 * M_PI / 2, drift = 0.25 * most;
  EXPECT_NEAR(Eyes().look(0.0, 8.0, 4.0, 8.0).turn, 0.3 * most * 2.0 / 3.0, 1.1 * drift) << "left";
  EXPECT_NEAR(Eyes().look(0.0, 8.0, 8.0, 4.0).turn, -0.3 * most * 2.0 / 3.0, 1.1 * drift) << "right";
  EXPECT_GT(Eyes().look(0.0, 0.365, 2.0, 8.0).turn, most - 2.0 * drift) << "near, and much freer: as far as it may";
  EXPECT_LE(Eyes().look(0.0, 0.365, 2.0, 8.0).turn, most);
  const double left = Eyes().look(0.0, 8.0, 2.0, 8.0).turn, right = Eyes().look(0.0, 8.0, 8.0, 2.0).turn;
  EXPECT_NEAR(left - right, 2.0 * 0.3 * most, 0.05) << "one seed, one drift";
}

TEST(Wander, TurnsToTheFreerSideUntilItMayResume) {
  for (const double side : {1.0, -1.0}) {
    Eyes eyes;
    const double right = side > 0.0 ? 1.0 : 3.0, left = 4.0 - right;
    EXPECT_GT(side * eyes.look(0.0, 0.3, right, left).turn, 0.0);
    EXPECT_GT(side * eyes.look(0.1, 0.3, left, right, 0.1).turn, 0.0) << "the direction is kept";
    EXPECT_EQ(eyes.look(0.2, 0.39 + 0.165, 3.0, 3.0, 0.2).forward, 0.0) << "more than 0.2 m, less than 0.4 m";
    EXPECT_GT(eyes.look(0.3, 0.41 + 0.165, 3.0, 3.0, 0.3).forward, 0.0);
  }
}

TEST(Wander, RequiresLessRoomAfterOneTurnAndBacksOffAfterTwo) {
  Eyes eyes;
  eyes.look(0.0, 0.3);
  double turned = 0.0, seconds = 0.0;
  const auto turn_on = [&](double front) { return eyes.look(seconds += 0.1, front, 8.0, 8.0, turned += 0.5); };
  while (turned < 6.0) EXPECT_EQ(turn_on(0.3 + 0.165).forward, 0.0) << turned << ": 0.3 m are not enough yet";
  EXPECT_EQ(turn_on(0.19 + 0.165).forward, 0.0) << "6.5 rad: less than 0.2 m";
  EXPECT_GT(turn_on(0.21 + 0.165).forward, 0.0) << "but 0.21 m are";
  Eyes stuck;
  stuck.look(0.0, 0.3);
  turned = 0.0;
  while (turned < 12.5) EXPECT_GE(stuck.look(seconds += 0.1, 0.3, 8.0, 8.0, turned += 0.5).forward, 0.0) << turned;
  EXPECT_LT(stuck.look(seconds += 0.1, 0.3, 8.0, 8.0, turned += 0.5).forward, 0.0) << "two rounds: backwards";
}

// Half its speed for 0.3 to 0.8 s, then a turn of 0.5 to 2.5 rad, even if it is free ahead.
TEST(Wander, BacksOffBrieflyAndTurnsByARandomAngle) {
  std::set<double> backs, turns;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Eyes eyes;
    eyes.wander.emplace(eyes.world.movers[0], lasers_in(eyes.world), 0, seed);
    double seconds = 0.0, yaw = 0.0;
    EXPECT_NEAR(eyes.look(seconds, 8.0, 8.0, 8.0, 0.0, true).forward, -0.2, 1e-12);
    while (eyes.look(seconds += 0.01, 8.0).forward < 0.0) ASSERT_LT(seconds, 0.81);
    backs.insert(seconds);
    while (eyes.look(seconds, 8.0, 8.0, 8.0, yaw += 0.01).forward == 0.0) ASSERT_LT(yaw, 2.6);
    turns.insert(yaw);
  }
  EXPECT_GE(*backs.begin(), 0.3);
  EXPECT_LT(*backs.begin(), 0.4);
  EXPECT_GT(*backs.rbegin(), 0.7);
  EXPECT_GE(*turns.begin(), 0.49);
  EXPECT_LT(*turns.begin(), 0.8);
  EXPECT_GT(*turns.rbegin(), 2.2);
}

// ---- Clearance ahead.

Clearance clearance_of(const world::World& world, const std::vector<double>& ranges) {
  const ReadingBlock block{.type = 1, .values = ranges};
  return ClearanceEstimator(world.movers[0], lasers_in(world)).estimate({&block, 1});
}

struct Look {
  double range;
  double ahead;
  const char* why;
};

TEST(ClearanceEstimator, AheadIsMeasuredInTheLaneFromTheFront) {
  world::World world = scenes::empty_world();
  world::Mover& mover = scenes::add_square(world, {});
  mover.sensors.push_back(sensors::laser_sensor(laser(0, 1, 2.0, {0.1, 0, 0, 0})));
  EXPECT_NEAR(ClearanceEstimator(mover, lasers_in(world)).range(), 1.9, 1e-12);
  for (const Look& look : {Look{1.1, 1.0, "0.1 on the body, 0.2 to its front"}, Look{2.0, 1.9, "nothing in range"},
                           Look{5.0, 1.9, "beyond range"}, Look{0.0, 0.0, "within the body"}})
    EXPECT_NEAR(clearance_of(world, {look.range}).ahead, look.ahead, 1e-6) << look.why;
}

// The lane is 15 % and a centimetre wider than the half width of 0.2 m, on both sides.
TEST(ClearanceEstimator, LaneIsSlightlyWiderThanTheBody) {
  for (const auto& [aside, ahead] : {std::pair{0.0, 1.0}, {0.235, 1.0}, {-0.235, 1.0}, {0.245, 1.9}, {-0.245, 1.9}}) {
    world::World world = scenes::empty_world();
    world::Mover& mover = scenes::add_square(world, {});
    mover.sensors.push_back(sensors::laser_sensor(laser(0, 1, 2.0, {0.1, aside, 0, 0})));
    EXPECT_NEAR(clearance_of(world, {1.1}).ahead, ahead, 1e-6) << aside;
  }
}

TEST(ClearanceEstimator, IgnoresObstaclesOutsideTheLane) {
  world::World world = scenes::empty_world();
  world::Mover& mover = scenes::add_square(world, {});
  mover.sensors.push_back(sensors::laser_sensor(laser(M_PI, 3, 4.0)));
  const Clearance c = clearance_of(world, {0.5, 3.0, 1.5});  // right, ahead, left
  EXPECT_NEAR(c.ahead, 2.8, 1e-6);
  EXPECT_NEAR(c.left, 1.5, 1e-6);
  EXPECT_NEAR(c.right, 0.5, 1e-6);
}

}  // namespace
}  // namespace sf::control
