// Properties of any scan in any world: translated, rotated, mirrored, with objects added, sampled more densely.
// Counterexamples are shrunk to small worlds.

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sensors/brute_force.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {

using base::Pose;

/// A box on a lattice of 1/64 m, rotated in steps of 1/64 turn.
struct Block {
  int x, y, w, h, turn;
};
/// Pose of a sensor on the same lattice; `turn` in 1/1000 turn.
struct Viewpoint {
  int x, y, turn;
};

std::ostream& operator<<(std::ostream& out, const Block& b) {
  return out << "box " << b.w << " x " << b.h << " at " << b.x << ", " << b.y << " turned " << b.turn;
}
std::ostream& operator<<(std::ostream& out, const Viewpoint& s) {
  return out << "eye at " << s.x << ", " << s.y << " turned " << s.turn;
}

}  // namespace sf::trial

namespace rc {

template <>
struct Arbitrary<sf::trial::Block> {
  static Gen<sf::trial::Block> arbitrary() {
    const auto place = gen::inRange(-250, 251), size = gen::inRange(1, 80);
    return gen::construct<sf::trial::Block>(place, place, size, size, gen::inRange(0, 64));
  }
};

template <>
struct Arbitrary<sf::trial::Viewpoint> {
  static Gen<sf::trial::Viewpoint> arbitrary() {
    const auto place = gen::inRange(-300, 301);
    return gen::construct<sf::trial::Viewpoint>(place, place, gen::inRange(0, 1000));
  }
};

}  // namespace rc

namespace sf::trial {
namespace {

using Blocks = std::vector<Block>;
using Viewpoints = std::vector<Viewpoint>;
using Scans = std::vector<std::vector<double>>;

constexpr double kRange = 6.0;          ///< [m]
constexpr std::uint32_t kSamples = 73;  ///< 72 = 2 x 2 x 2 x 3 x 3 steps
constexpr double kFov = 1.5 * M_PI;

/// Rounds to a lattice that is fine enough for any box and coarse enough to add 1e6 m without rounding.
double snap(double x) { return std::round(x * 1048576.0) / 1048576.0; }

using Map = glm::dvec2 (*)(glm::dvec2);
glm::dvec2 same(glm::dvec2 p) { return p; }
/// Keeps the solid on the left by reversing the order of corners.
glm::dvec2 mirrored_point(glm::dvec2 p) { return {p.x, -p.y}; }

world::World build(const Blocks& blocks, Map map = same, bool reverse = false) {
  world::World world;
  for (const Block& b : blocks) {
    std::vector<glm::dvec2> corners;
    for (const glm::dvec2& sign : {glm::dvec2{-1, -1}, glm::dvec2{1, -1}, glm::dvec2{1, 1}, glm::dvec2{-1, 1}}) {
      const glm::dvec2 p = base::rotate(2.0 * M_PI * b.turn / 64, {sign.x * b.w / 128.0, sign.y * b.h / 128.0});
      corners.push_back(map({snap(b.x / 64.0 + p.x), snap(b.y / 64.0 + p.y)}));
    }
    if (reverse) std::reverse(corners.begin(), corners.end());
    scenes::add_outline(world, corners, "box");
  }
  return world;
}

Pose pose_of(const Viewpoint& s) { return {s.x / 64.0, s.y / 64.0, 0.0, 2.0 * M_PI * s.turn / 1000}; }

Scans look(world::World world, const std::vector<Pose>& poses, std::uint32_t samples = kSamples) {
  for (const Pose& pose : poses) add_eye(world, pose, eye(samples, kFov, kRange));
  const Glance glance(world);
  Scans scans;
  for (const base::ReadingBlock& r : glance.readings) scans.emplace_back(r.values.begin(), r.values.end());
  return scans;
}

std::vector<Pose> poses_of(const Viewpoints& viewpoints) {
  std::vector<Pose> poses;
  for (const Viewpoint& viewpoint : viewpoints) poses.push_back(pose_of(viewpoint));
  return poses;
}

/// Returns the largest change [m] of the beam's range due to rounding the world again; infinite for a beam so close to
/// a silhouette that it may hit or miss it.
double slack(const world::World& world, const Pose& pose, std::uint32_t sample) {
  const auto walls = oracle::surfaces(world, {}, 0, 0.1);
  const long double direction = pose.yaw + (-0.5 + static_cast<double>(sample) / (kSamples - 1)) * kFov;
  const oracle::Truth truth = oracle::judge(walls, {pose.x, pose.y}, direction, kRange);
  return truth.ambiguous ? HUGE_VAL : 1e-12 / std::max(truth.first.sine, 1e-9) + 1e-12;
}

void expect_alike(const world::World& world, const std::vector<Pose>& poses, const Scans& before, const Scans& after,
                  bool reversed = false) {
  for (std::size_t e = 0; e < poses.size(); ++e)
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const double change = std::abs(before[e][i] - after[e][reversed ? kSamples - 1 - i : i]);
      if (change > 1e-12) RC_ASSERT(change <= slack(world, poses[e], i));
    }
}

/// At least one eye; additional eyes cost little.
Viewpoints some_viewpoints() { return *rc::gen::nonEmpty<Viewpoints>(); }

RC_GTEST_PROP(LaserProperties, TranslationChangesNoBit, (const Blocks& blocks)) {
  // Sums of lattice points are exact, so no bit may change.
  const Viewpoints viewpoints = some_viewpoints();
  static glm::dvec2 by;
  by = {1.0 * *rc::gen::inRange(-1'000'000, 1'000'001), 1.0 * *rc::gen::inRange(-1'000'000, 1'000'001)};
  std::vector<Pose> there = poses_of(viewpoints);
  for (Pose& pose : there) pose.x += by.x, pose.y += by.y;
  RC_ASSERT(look(build(blocks), poses_of(viewpoints)) ==
            look(build(blocks, [](glm::dvec2 p) { return p + by; }), there));
}

RC_GTEST_PROP(LaserProperties, RotationChangesNoRange, (const Blocks& blocks)) {
  const Viewpoints viewpoints = some_viewpoints();
  static double angle;
  angle = 2.0 * M_PI * *rc::gen::inRange(1, 1000) / 1000;
  std::vector<Pose> there = poses_of(viewpoints);
  for (Pose& pose : there) pose = base::compose({0, 0, 0, angle}, pose);
  const Scans after = look(build(blocks, [](glm::dvec2 p) { return base::rotate(angle, p); }), there);
  expect_alike(build(blocks), poses_of(viewpoints), look(build(blocks), poses_of(viewpoints)), after);
}

RC_GTEST_PROP(LaserProperties, MirroredWorldGivesMirroredScans, (const Blocks& blocks)) {
  const Viewpoints viewpoints = some_viewpoints();
  std::vector<Pose> there = poses_of(viewpoints);
  for (Pose& pose : there) pose.y = -pose.y, pose.yaw = -pose.yaw;
  expect_alike(build(blocks), poses_of(viewpoints), look(build(blocks), poses_of(viewpoints)),
               look(build(blocks, mirrored_point, true), there), true);
}

RC_GTEST_PROP(LaserProperties, AnotherObstacleLengthensNoRange, (const Blocks& blocks, const Block& another)) {
  const std::vector<Pose> poses = poses_of(some_viewpoints());
  Blocks more = blocks;
  more.push_back(another);
  const Scans before = look(build(blocks), poses), after = look(build(more), poses);
  for (std::size_t e = 0; e < poses.size(); ++e)
    for (std::size_t i = 0; i < kSamples; ++i)
      if (after[e][i] > before[e][i])
        RC_ASSERT(slack(build(more), poses[e], static_cast<std::uint32_t>(i)) == HUGE_VAL);
}

RC_GTEST_PROP(LaserProperties, MoreSamplesContainFewer, (const Blocks& blocks)) {
  const std::vector<Pose> poses = poses_of(some_viewpoints());
  const std::uint32_t every = *rc::gen::element(2u, 3u, 4u, 6u, 8u, 9u, 12u, 24u, 36u, 72u);
  const Scans fine = look(build(blocks), poses), coarse = look(build(blocks), poses, 72 / every + 1);
  for (std::size_t e = 0; e < poses.size(); ++e)
    for (std::uint32_t i = 0; i < kSamples; i += every) {
      const double change = std::abs(fine[e][i] - coarse[e][i / every]);
      if (change > 1e-12) RC_ASSERT(change <= slack(build(blocks), poses[e], i));
    }
}

/// Guards against a farm that detects nothing, which would satisfy the properties above.
TEST(LaserProperties, ScansHitSomething) {
  const Scans scans = look(build({{0, 0, 64, 64, 3}}), {pose_of({128, 0, 500})});
  EXPECT_GT(std::count_if(scans[0].begin(), scans[0].end(), [](double r) { return r < kRange; }), 5);
}

}  // namespace
}  // namespace sf::trial
