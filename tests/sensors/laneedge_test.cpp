// The lane edge sensor on exact markings: definitions one by one, exact geometry, and invariances.

#include <gtest/gtest.h>

#include <cmath>

#include "farm/farm.h"
#include "sensors/laneedge_settings.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/sensors/scenes.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using base::Pose;
using sensors::EdgeReading;

constexpr double kLineWidth = 0.1;

/// Returns the distance from `X_WS` along `bearing` [rad, sensor frame] to the left edge of a straight marking, by its
/// formula.
long double face_distance(const world::LaneMarking& s, const Pose& X_WS, double bearing) {
  const long double tx = static_cast<long double>(s.line[1].x) - s.line[0].x;
  const long double ty = static_cast<long double>(s.line[1].y) - s.line[0].y;
  const long double size = std::sqrt(tx * tx + ty * ty);
  const long double nx = -ty / size;
  const long double ny = tx / size;
  const long double off = nx * (static_cast<long double>(X_WS.x) - s.line[0].x) +
                          ny * (static_cast<long double>(X_WS.y) - s.line[0].y) - 0.5L * s.width;
  const long double a = static_cast<long double>(X_WS.yaw) + bearing;
  return -off / (nx * std::cos(a) + ny * std::sin(a));
}

/// A marking along +x with its near edge `d` [m] ahead of a sensor at the origin, at an angle of `degrees`.
EdgeReading askew(double d, double degrees, const Settings& settings = {{"perpendicular", {0}}}) {
  world::World world;
  world.lane_markings.push_back(marking({20.0, 0.0}, {-20.0, 0.0}, kLineWidth));
  // The marking's left side is -y.
  add_edge_eye(world, {0.0, -d - 0.5 * kLineWidth, 0.0, (90.0 + degrees) * kDegree}, settings);
  return read_edges(world)[0];
}

TEST(LaneEdge, ReadsTheDistanceToTheFaceAtAnyAngle) {
  for (const double degrees : {0.0, 1.0, 30.0, 45.0, 60.0, 80.0, 89.0, -1.0, -30.0, -45.0, -60.0, -80.0, -89.0}) {
    const double d = std::fabs(degrees) > 70.0 ? 0.02 : 0.25;
    const EdgeReading r = askew(d, degrees);
    EXPECT_NEAR(r.distance, d / std::cos(degrees * kDegree), 1e-10) << degrees;
    EXPECT_GE(r.points, 10) << degrees;
    EXPECT_LT(r.residual, 1e-12) << degrees;
    EXPECT_LT(r.sigma, 1e-5) << degrees;
  }
}

/// Within 1 nm of the edge, a sensor touches it. Farther inside, it is on paint and reads the distance to the border.
/// Markings of the deck and of the floor below it. A sensor reads those of the road that its robot is on, and occluders
/// at its own height. Boundary: 5 cm of errors of heights.
TEST(LaneEdge, ReadsTheMarkingsOfItsRoad) {
  world::World world;
  for (const double x : {0.3, 0.4}) world.lane_markings.push_back(marking({x, -5}, {x, 5}, 0.02));
  add_edge_eye(world, {});
  world.ramps = {{{-1, 0}, {1, 0}, 1.0, 1.0, 0.5}};
  world.marking_heights = {{0.0, 0.0}, {1.0, 1.0}};
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::int64_t now = 0;
  const auto distance = [&](double z) {
    const base::Report report{0, now += 100'000'000, {0, 0, z, 0}, {}};
    return farm.tick(now, {&report, 1})[0].values[0];
  };
  const double floor = distance(0.0);
  EXPECT_NEAR(distance(1.0) - floor, 0.1, 1e-9) << "the deck's";
  EXPECT_EQ(distance(0.04), floor);
  EXPECT_TRUE(std::isnan(distance(0.5))) << "between the two";
}

TEST(LaneEdge, OnTheEdgeItselfAndOnPaint) {
  EXPECT_NEAR(askew(0.0, 10.0).distance, 0.0, 1e-9);
  EXPECT_NEAR(askew(1e-6, 10.0).distance, 1e-6 / std::cos(10.0 * kDegree), 1e-12);
  EXPECT_NEAR(askew(-0.04, 0.0).distance, 0.06, 1e-10) << "the far face, 0.1 m beyond the near one";
}

TEST(LaneEdge, IgnoresAMarkingBehind) {
  const EdgeReading r = askew(0.25, 180.0);
  EXPECT_TRUE(std::isnan(r.distance));
  EXPECT_EQ(r.points, 0);
}

TEST(LaneEdge, EndOfADashIsNotAnEdge) {
  world::World world;
  world.lane_markings.push_back(marking({0.3, 0.0}, {2.0, 0.0}, 0.2));
  add_edge_eye(world, {});
  add_edge_eye(world, {1.0, -0.3, 0.0, 0.5 * M_PI});
  const auto readings = read_edges(world);
  EXPECT_TRUE(std::isnan(readings[0].distance)) << "only the end is in sight";
  EXPECT_EQ(readings[0].points, 0);
  EXPECT_NEAR(readings[1].distance, 0.2, 1e-12);
}

/// A gap wider than the field of view, a narrower one, and one seen from far enough.
TEST(LaneEdge, DashesFormOneEdge) {
  world::World world;
  add_dashes(world, {0.0, 0.0}, {20.0, 0.0}, 0.05, 0.3, 0.3);
  add_edge_eye(world, {0.45, -0.325, 0.0, 0.5 * M_PI});
  add_edge_eye(world, {0.35, -0.325, 0.0, 0.5 * M_PI});
  add_edge_eye(world, {0.45, -0.725, 0.0, 0.5 * M_PI});
  const auto readings = read_edges(world);
  EXPECT_TRUE(std::isnan(readings[0].distance));
  EXPECT_NEAR(readings[1].distance, 0.3, 1e-10);
  EXPECT_NEAR(readings[2].distance, 0.7, 1e-10);
  EXPECT_LT(readings[2].points, 30);
}

/// The thesis' robot faces -y and its sensor its own +x, which is its left. This project's robot faces +x and its
/// sensor +y. Both detect the same edge, by default perpendicular to the robot.
TEST(LaneEdge, MatchesTheThesisFrame) {
  world::World world;
  world.lane_markings.push_back(marking({5.0, 0.5}, {-5.0, 0.5}, kLineWidth));
  for (const double tilt : {0.0, 20.0, -20.0}) {
    world::Mover ours;
    ours.X_WM = {0.0, 0.0, 0.0, tilt * kDegree};
    ours.sensors.push_back(edge_sensor({}, {0.0, 0.225, 0.0, 0.5 * M_PI}));
    world::Mover thesis = ours;
    thesis.X_WM.yaw += 0.5 * M_PI;
    thesis.sensors[0] = edge_sensor({}, {0.225, 0.0, 0.0, 0.0});
    world.movers.push_back(ours);
    world.movers.push_back(thesis);
  }
  const auto readings = read_edges(world);
  for (std::size_t i = 0; i < readings.size(); i += 2) {
    const double tilt = 20.0 * kDegree * (i == 0 ? 0.0 : 1.0);
    EXPECT_NEAR(readings[i].distance, 0.45 / std::cos(tilt) - 0.225, 1e-12) << i;
    EXPECT_NEAR(readings[i].distance, readings[i + 1].distance, 1e-12) << i;
  }
}

TEST(LaneEdge, PerpendicularIsTheRobotAxisNearestToTheView) {
  struct Case {
    double yaw, expected;  ///< [deg] yaw of the sensor, and direction of the distance, in the robot's frame
  };
  for (const Case c : {Case{0, 0}, Case{44, 0}, Case{45, 90}, Case{46, 90}, Case{90, 90}, Case{135, 90}, Case{136, 180},
                       Case{180, 180}, Case{-135, -90}, Case{-90, -90}, Case{-45, -90}, Case{-44, 0}}) {
    const auto edge = sensors::lane_edge_of(edge_sensor({}, {0, 0, 0, c.yaw * kDegree}), 0, 0);
    const glm::dvec2 in_robot = base::rotate(c.yaw * kDegree, edge.perpendicular);
    EXPECT_NEAR(in_robot.x, std::cos(c.expected * kDegree), 1e-12) << c.yaw;
    EXPECT_NEAR(in_robot.y, std::sin(c.expected * kDegree), 1e-12) << c.yaw;
  }
}

TEST(LaneEdge, RejectsInvalidSettingsWithTheirLine) {
  const Settings bad[] = {{{"samples", {2.5}}}, {{"fov", {0}}},          {{"range_max", {2}}, {"range_min", {3}}},
                          {{"noise", {0, 0}}},  {{"noise", {-1, 0, 0}}}, {{"noise", {0, 0, 400}}}};
  for (const Settings& settings : bad)
    expect_in("hand.world:" + std::to_string(7 + settings.size()),
              refusal_of([&] { sensors::lane_edge_of(edge_sensor(settings), 0, 0); }));
}

TEST(LaneEdge, DefaultsMatchTheThesis) {
  const auto edge = sensors::lane_edge_of(edge_sensor({}, {0, 0, 0.02, 0}), 0, 0);
  EXPECT_EQ(edge.fan.samples, 61u);
  EXPECT_NEAR(edge.fan.fov, 30.0 * kDegree, 1e-15);
  EXPECT_EQ(edge.fan.range_max, 1.0);
  EXPECT_EQ(edge.fan.range_min, 0.0);
  EXPECT_FALSE(edge.single);
  EXPECT_EQ(edge.row.limit, 10.0);
}

/// Movers occlude markings and are not edges. The sensor's own robot occludes nothing.
TEST(LaneEdge, OccludingMoverIsNotAnEdge) {
  world::World world;
  world.lane_markings.push_back(marking({5.0, 0.0}, {-5.0, 0.0}, kLineWidth));
  add_edge_eye(world, {0.0, -0.55, 0.0, 0.5 * M_PI});
  EXPECT_EQ(read_edges(world)[0].points, 61);
  scenes::add_robot(world, {0.2, -0.25, 0.0, 0.0}, scenes::laser());
  const EdgeReading half = read_edges(world)[0];
  EXPECT_GT(half.points, 20);
  EXPECT_LT(half.points, 60);
  EXPECT_NEAR(half.distance, 0.5, 1e-10);
  scenes::add_robot(world, {0.0, -0.25, 0.0, 0.0}, scenes::laser());
  const EdgeReading hidden = read_edges(world)[0];
  EXPECT_TRUE(std::isnan(hidden.distance) || hidden.points < 20);
}

/// Static outlines are also edges, as in the thesis' roads, unless the model disables this.
TEST(LaneEdge, WallsAtItsHeightAreEdges) {
  world::World world;
  scenes::add_outline(world, {{0.4, -2}, {0.5, -2}, {0.5, 2}, {0.4, 2}}, "kerb");
  for (world::Segment& s : world.walls) s.z_max = 0.01;
  add_edge_eye(world, {});
  world.movers[0].sensors[0].X_MS.z = 0.005;
  EXPECT_NEAR(read_edges(world)[0].distance, 0.4, 1e-12);
  world.movers[0].sensors[0].X_MS.z = 0.02;
  EXPECT_TRUE(std::isnan(read_edges(world)[0].distance)) << "over its top";
  world.movers[0].sensors[0].X_MS.z = 0.005;
  for (world::Segment& s : world.walls) s.seen_by_laneedge = false;
  EXPECT_TRUE(std::isnan(read_edges(world)[0].distance));
  for (world::Segment& s : world.walls) s.seen_by_laneedge = true, s.seen_by_laser = false;
  EXPECT_TRUE(std::isnan(read_edges(world)[0].distance));
}

/// Straight markings at any angle and position, with robots around them; `offset` moves everything.
struct Scene {
  world::World world;
  std::vector<long double> truth;
};

Scene straight_scene(std::uint32_t sensors_wanted, double most_degrees, std::uint64_t seed, glm::dvec2 offset = {}) {
  Scene scene;
  Chance chance(seed);
  constexpr std::uint32_t kStripes = 40;
  for (std::uint32_t i = 0; i < sensors_wanted; ++i) {
    const std::uint32_t k = i % kStripes;
    const double a = 0.31 * k;
    const glm::dvec2 o = offset + glm::dvec2{7.0 * (k % 8), 7.0 * (k / 8.0)};
    const glm::dvec2 t{std::cos(a), std::sin(a)};
    const glm::dvec2 n{-t.y, t.x};
    if (i < kStripes) scene.world.lane_markings.push_back(marking(o - 3.0 * t, o + 3.0 * t, kLineWidth));
    const double tilt = chance.between(-most_degrees, most_degrees) * kDegree;
    const double d = chance.between(0.02, std::fabs(tilt) > 60.0 * kDegree ? 0.1 : 0.6);
    const glm::dvec2 p = o + chance.between(-0.5, 0.5) * t + (0.5 * kLineWidth + d) * n;
    const Pose X_WS{p.x, p.y, 0.0, std::atan2(-n.y, -n.x) + tilt};
    add_edge_eye(scene.world, X_WS, {{"perpendicular", {0}}});
    scene.truth.push_back(face_distance(scene.world.lane_markings[k], X_WS, 0.0));
  }
  return scene;
}

struct Errors {
  double worst = 0.0;
  std::size_t seen = 0;
};

Errors errors(const Scene& scene) {
  Errors e;
  const auto readings = read_edges(scene.world);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (std::isnan(readings[i].distance)) continue;
    ++e.seen;
    e.worst = std::max(e.worst, std::fabs(static_cast<double>(readings[i].distance - scene.truth[i])));
  }
  return e;
}

/// The documented bound is 1 mm; the actual error is only rounding: far away, that of coordinates, magnified by points
/// half a metre apart.
TEST(LaneEdge, ExactPaintMatchesItsFormulaAtAnyDistanceFromTheOrigin) {
  struct Case {
    double far, most_degrees, worst;
  };
  for (const Case& c : {Case{0.0, 85.0, 1e-9}, {1e5, 45.0, 1e-8}, {-1e7, 45.0, 1e-6}}) {
    const Errors e = errors(straight_scene(2000, c.most_degrees, 3, {c.far, -c.far}));
    EXPECT_GE(e.seen, 1995u) << c.far;
    EXPECT_LT(e.worst, c.worst) << c.far;
  }
}

glm::dvec2 mirrored(glm::dvec2 p) { return {p.x, -p.y}; }

/// Rotated, translated and mirrored, with an additional robot that occludes nothing: the reading is the same.
TEST(LaneEdge, InvariantUnderMotionAndReflection) {
  world::World world;
  Chance chance(8);
  add_dashes(world, {-3.0, 0.0}, {3.0, 0.7}, 0.05, 0.2, 0.1);
  world.lane_markings.push_back(arc({0.0, -3.0}, 2.0, 0.3, 2.7, 0.08));
  for (int i = 0; i < 300; ++i)
    add_edge_eye(world, {chance.between(-2.5, 2.5), chance.between(-1.5, 1.2), 0.0, chance.between(-M_PI, M_PI)},
                 {{"perpendicular", {chance.between(-40.0, 40.0)}}});
  const auto before = read_edges(world);

  world::World moved = world;
  world::World mirror = world;
  const Pose X{31.0, -17.0, 0.0, 1.234};
  for (world::LaneMarking& s : moved.lane_markings)
    for (glm::dvec2& p : s.line) p = base::transform(X, p);
  for (world::LaneMarking& s : mirror.lane_markings)
    for (glm::dvec2& p : s.line) p = mirrored(p);
  for (std::size_t i = 0; i < world.movers.size(); ++i) {
    moved.movers[i].X_WM = base::compose(X, world.movers[i].X_WM);
    const Pose& p = world.movers[i].X_WM;
    mirror.movers[i].X_WM = {p.x, -p.y, 0.0, -p.yaw};
    mirror.movers[i].sensors[0].settings[0].numbers[0] *= -1.0;
  }
  world::World crowded = world;
  scenes::add_robot(crowded, {20.0, 20.0, 0.0, 0.0}, scenes::laser());
  std::size_t seen = 0;
  std::size_t differ = 0;
  for (const world::World* other : {&moved, &mirror, &crowded}) {
    const auto after = read_edges(*other);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const bool none = std::isnan(before[i].distance);
      seen += none ? 0 : 1;
      // A ray on a corner may hit or miss it, and add or remove a point.
      if (before[i].points != after[i].points || none != std::isnan(after[i].distance)) {
        ++differ;
        continue;
      }
      if (none) continue;
      EXPECT_NEAR(before[i].distance, after[i].distance, 1e-9 + before[i].sigma) << i;
    }
  }
  EXPECT_GT(seen, 300u);
  EXPECT_LE(differ, 3u);
}

/// Two lanes paint their shared edge twice: it counts once.
TEST(LaneEdge, OverlappingPaintCountsOnce) {
  world::World world;
  world.lane_markings.push_back(marking({-2, 0}, {2, 0}));
  world.lane_markings.push_back(marking({2, 0}, {-2, 0}));
  add_edge_eye(world, {0.1, -0.4, 0.0, 1.5});
  const EdgeReading twice = read_edges(world)[0];
  world.lane_markings.pop_back();
  const EdgeReading once = read_edges(world)[0];
  EXPECT_EQ(once.distance, twice.distance);
  EXPECT_EQ(once.points, twice.points);
}

}  // namespace
}  // namespace sf::trial
