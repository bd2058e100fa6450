// Every lane edge reading stays within its stated bound or is flagged, according to the edges' formulas in `long
// double`.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/instrumented.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/laneedge_trial.h"

namespace sf::trial {
namespace {

using base::Pose;
using base::QualityFlag;
using Wide = long double;

constexpr double kWidth = 0.1;  // [m]

/// A straight edge: one side of a marking whose centre line runs from `a` to `b`.
struct Face {
  glm::dvec2 a, b;
  Wide side = 0.0;  ///< [m] offset to the left of the centre line
};

void add_sides(std::vector<Face>& faces, glm::dvec2 a, glm::dvec2 b) {
  for (const Wide side : {0.5L * kWidth, -0.5L * kWidth}) faces.push_back({a, b, side});
}

void add_straight(world::World& world, std::vector<Face>& faces, glm::dvec2 a, glm::dvec2 b) {
  world.lane_markings.push_back(marking(a, b, kWidth));
  add_sides(faces, a, b);
}

/// Returns the distance [m] of `read`, along `bearing` from `p`, from the nearest true edge; infinite if there is none.
/// The choice among several edges is not an error.
Wide error_of(Wide read, const std::vector<Face>& faces, const Pose& p, Wide bearing) {
  Wide least = HUGE_VALL;
  for (const Face& f : faces) {
    const Wide dx = static_cast<Wide>(f.b.x) - f.a.x, dy = static_cast<Wide>(f.b.y) - f.a.y;
    const Wide size = std::hypot(dx, dy), tx = dx / size, ty = dy / size;
    const Wide px = static_cast<Wide>(p.x) - f.a.x, py = static_cast<Wide>(p.y) - f.a.y;
    const Wide ex = std::cos(bearing), ey = std::sin(bearing);
    const Wide t = (f.side - (tx * py - ty * px)) / (tx * ey - ty * ex);
    const Wide along = tx * (px + t * ex) + ty * (py + t * ey);
    // At the vertices of a marking, its outer edge continues for 0.1 mm.
    if (t > -1e-9L && along >= -1e-4L && along <= size + 1e-4L) least = std::min(least, std::abs(t - read));
  }
  return least;
}

struct Seen {
  int read = 0, stated = 0, beyond = 0;
  double worst = 0.0;  ///< as a fraction of the bound
  std::string example;
};

/// Takes one reading from every pose and checks the readings that state a bound.
Seen judge(world::World world, const std::vector<Face>& faces, const std::vector<Pose>& poses,
           const Settings& settings = {{"perpendicular", {0}}}) {
  for (const Pose& pose : poses) add_edge_eye(world, pose, settings);
  EdgeRig rig(world);
  std::vector<sensors::DueSample> due;
  for (std::uint32_t row = 0; row < poses.size(); ++row) due.push_back({row, 0});
  Seen seen;
  const double bearing = settings[0].second[0] * M_PI / 180.0;
  for (const base::ReadingBlock& r : rig.tick(due, poses)) {
    EXPECT_EQ(std::isinf(r.bound), std::isnan(r.values[0]) || !r.quality.empty()) << "a bound holds, or is left out";
    if (std::isnan(r.values[0])) continue;
    ++seen.read;
    if (std::isinf(r.bound)) continue;
    ++seen.stated;
    const auto error =
        static_cast<double>(error_of(r.values[0], faces, r.X_WS, static_cast<Wide>(r.X_WS.yaw) + bearing));
    seen.worst = std::max(seen.worst, error / r.bound);
    if (error <= r.bound) continue;
    ++seen.beyond;
    seen.example = "pose " + std::to_string(r.X_WS.x) + " " + std::to_string(r.X_WS.y) + " " +
                   std::to_string(r.X_WS.yaw) + ": " + std::to_string(r.values[0]) + " is off by " +
                   std::to_string(error);
  }
  return seen;
}

/// Returns random poses in a square around `middle`.
std::vector<Pose> anywhere(int count, glm::dvec2 middle, double half, std::uint64_t seed) {
  Chance chance(seed);
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const glm::dvec2 p = middle + chance.in_square(half);
    poses.push_back({p.x, p.y, 0.0, chance.between(-M_PI, M_PI)});
  }
  return poses;
}

TEST(LaneEdgeBounds, HoldOnStraightPaintAndAtItsEnds) {
  for (const double far : {0.0, 1e5, 1e7}) {
    world::World world;
    std::vector<Face> faces;
    const glm::dvec2 o{far, -far};
    add_straight(world, faces, o + glm::dvec2{-1.0, 0.2}, o + glm::dvec2{1.0, -0.3});
    const Seen seen = judge(world, faces, anywhere(4000, o, 1.2, 7));
    EXPECT_EQ(seen.beyond, 0) << far << ": " << seen.example;
    EXPECT_GT(seen.stated, seen.read / 2) << far;
    EXPECT_LT(seen.stated, seen.read) << far << ": some look past an end";
    EXPECT_GT(seen.read, 1000);
  }
}

TEST(LaneEdgeBounds, HoldWhereStripesCross) {
  world::World world;
  std::vector<Face> faces;
  add_straight(world, faces, {-1.0, 0.0}, {1.0, 0.0});
  add_straight(world, faces, {-0.4, -1.0}, {0.4, 1.0});
  add_straight(world, faces, {-1.0, 0.35}, {1.0, 0.25});  // a second edge behind the first
  const Seen seen = judge(world, faces, anywhere(6000, {}, 0.8, 8));
  EXPECT_EQ(seen.beyond, 0) << seen.example;
  EXPECT_GT(seen.stated, 500);
  EXPECT_LT(seen.stated, seen.read);
}

/// Straight, a bend of the thesis' radius, straight: the same as on its test path.
TEST(LaneEdgeBounds, HoldIntoAndOutOfABend) {
  world::World world;
  std::vector<Face> faces;
  world::LaneMarking whole = arc({0.0, 0.68}, 0.68, -0.5 * M_PI, 0.0, kWidth);
  whole.line.front() = {0.0, 0.0};
  whole.line.back() = {0.68, 0.68};
  whole.line.insert(whole.line.begin(), {-1.0, 0.0});
  whole.line.push_back({0.68, 1.68});
  world.lane_markings = {whole};
  // A bend is made of chords. Within a chord, 2 mm long, an edge is straight.
  for (std::size_t i = 0; i + 1 < whole.line.size(); ++i) add_sides(faces, whole.line[i], whole.line[i + 1]);
  const Seen seen = judge(world, faces, anywhere(8000, {0.0, 0.5}, 1.0, 9));
  EXPECT_EQ(seen.beyond, 0) << seen.example;
  EXPECT_GT(seen.stated, 500) << "on the straights";
  const Seen ahead = judge(world, faces, anywhere(8000, {0.0, 0.5}, 1.0, 10), {{"perpendicular", {20}}});
  EXPECT_EQ(ahead.stated, 0) << "the perpendicular is outside the fan: no ray covers the edge there";
  EXPECT_GT(ahead.read, 500);
}

/// Edges continue between two dashes, but not before the first and after the last.
TEST(LaneEdgeBounds, HoldOnDashes) {
  world::World world;
  std::vector<Face> faces;
  add_straight(world, faces, {-1.0, 0.0}, {1.0, 0.0});
  world.lane_markings.clear();
  add_dashes(world, {-1.0, 0.0}, {1.0, 0.0}, kWidth, 0.1, 0.1);
  const Seen seen = judge(world, faces, anywhere(4000, {}, 1.2, 11));
  EXPECT_EQ(seen.beyond, 0) << seen.example;
  EXPECT_GT(seen.stated, 300);
}

/// Wide scans near a corner see two edges at once. Narrow ones with few rays see little of either.
TEST(LaneEdgeBounds, HoldForAnyFan) {
  world::World world;
  std::vector<Face> faces;
  add_straight(world, faces, {-1.0, 0.0}, {1.0, 0.0});
  add_straight(world, faces, {0.0, -1.0}, {0.0, 1.0});
  for (const double fov : {0.5, 5.0, 120.0, 300.0})
    for (const double samples : {3.0, 4.0, 5.0, 200.0}) {
      const Settings settings{{"perpendicular", {0}}, {"fov", {fov}}, {"samples", {samples}}};
      const Seen seen = judge(world, faces, anywhere(instrumented() ? 100 : 1000, {}, 0.9, 12), settings);
      EXPECT_EQ(seen.beyond, 0) << fov << " deg, " << samples << " samples: " << seen.example;
      EXPECT_GT(seen.read, 0);
    }
}

/// The range of a single ray is the reading. It is also valid on bends, unless the ray grazes.
TEST(LaneEdgeBounds, SingleRayHasTheBoundOfItsRange) {
  world::World world;
  std::vector<Face> faces;
  add_straight(world, faces, {-1.0, 0.0}, {1.0, 0.0});
  for (const double x : {-1.0, 1.0}) faces.push_back({{x, -0.5 * kWidth}, {x, 0.5 * kWidth}, 0.0});  // ends count
  const Settings one{{"perpendicular", {0}}, {"samples", {1}}};
  const Seen seen = judge(world, faces, anywhere(2000, {}, 0.9, 13), one);
  EXPECT_EQ(seen.beyond, 0) << seen.example;
  EXPECT_GT(seen.stated, 300);
  add_edge_eye(world, {-0.9, 0.05 + 1e-5, 0.0, -1e-4}, one);  // hits the edge 0.1 m ahead, at 1e-4 rad
  EdgeRig rig(world);
  const auto& blocks = rig.tick({{0, 0}}, {world.movers[0].X_WM});
  ASSERT_EQ(blocks[0].quality.size(), 1u);
  EXPECT_EQ(blocks[0].quality[0], QualityFlag::grazing);
  EXPECT_TRUE(std::isinf(blocks[0].bound));
}

/// Returns the quality flag of one sensor at `pose`. A flagged reading states no bound.
QualityFlag said(world::World world, const Pose& pose, const Settings& settings = {{"perpendicular", {0}}}) {
  add_edge_eye(world, pose, settings);
  EdgeRig rig(world);
  const auto& blocks = rig.tick({{0, 0}}, {pose});
  EXPECT_FALSE(std::isnan(blocks[0].values[0]));
  EXPECT_EQ(std::isinf(blocks[0].bound), !blocks[0].quality.empty());
  return blocks[0].quality.empty() ? QualityFlag::none : blocks[0].quality[0];
}

TEST(LaneEdgeBounds, FlagGivesTheReason) {
  world::World line;
  line.lane_markings.push_back(marking({-1.0, 0.0}, {1.0, 0.0}, kWidth));
  EXPECT_EQ(said(line, {0.0, -0.3, 0.0, 0.5 * M_PI}), QualityFlag::none);
  EXPECT_EQ(said(line, {1.02, -0.3, 0.0, 0.5 * M_PI}), QualityFlag::extrapolated) << "2 cm past the end";
  EXPECT_EQ(said(line, {0.0, -0.3, 0.0, 0.5 * M_PI}, {{"perpendicular", {-20}}}), QualityFlag::extrapolated);
  world::World curvature;
  curvature.lane_markings.push_back(arc({0.0, 0.0}, 0.68, 0.0, 3.0, kWidth));
  EXPECT_EQ(said(curvature, {0.0, 0.4, 0.0, 0.5 * M_PI}), QualityFlag::not_straight);
  world::World two = line;
  two.lane_markings.push_back(marking({0.0, 0.3}, {1.0, 0.3}, kWidth));
  two.lane_markings[0].line[1] = {0.02, 0.0};
  EXPECT_EQ(said(two, {0.0, -0.3, 0.0, 0.5 * M_PI}), QualityFlag::not_straight) << "another edge behind its end";
}

/// With noise or pixels, no bound is stated and sigma applies.
TEST(LaneEdgeBounds, NoneWithNoiseOrPixels) {
  world::World world;
  world.lane_markings.push_back(marking({-1.0, 0.0}, {1.0, 0.0}, kWidth));
  const Pose pose{0.0, -0.3, 0.0, 0.5 * M_PI};
  add_edge_eye(world, pose, {{"perpendicular", {0}}, {"noise", {0.002, 0, 0}}});
  EXPECT_TRUE(std::isinf(EdgeRig(world).tick({{0, 0}}, {pose})[0].bound));
  EXPECT_LT(EdgeRig(world, 0, 0, false).tick({{0, 0}}, {pose})[0].bound, 1.1e-8) << "with its noise off";
  world.road_resolution = 0.01;
  EXPECT_TRUE(std::isinf(EdgeRig(world, 0, 0, false).tick({{0, 0}}, {pose})[0].bound));
}

}  // namespace
}  // namespace sf::trial
