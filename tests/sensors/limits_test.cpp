// Limits of the farm: refusals, and success just below the limit.

#include <gtest/gtest.h>

#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

const farm::FarmOptions kLimitsOnDevice{.scene = {.caster = raycast::CasterChoice::vulkan}};

void add_thin(std::vector<world::Segment>& out, glm::dvec2 a, glm::dvec2 b, std::uint32_t model) {
  world::Segment s;
  s.a = a;
  s.b = b;
  s.z_max = 1.0;
  s.model = model;
  s.solid_left = false;
  out.push_back(s);
}

/// `count` rails beside the x axis, 4 um from it, all within one direction sector, with a wall behind them. A beam
/// along the axis passes between all of them, and each is edge-on.
world::World rails(int count) {
  world::World world;
  world.models.push_back({"rails", "model"});
  for (int i = 0; i < count; ++i) {
    const double x = 1.0 + 5.0 * i / count;
    const double y = (i % 2 ? 1.0 : -1.0) * 4e-6;
    add_thin(world.walls, {x, y}, {x + 2e-4, y}, 0);
  }
  world.models.push_back({"behind", "model"});
  add_thin(world.walls, {7, -0.2}, {7, 0.2}, 1);
  add_eye(world, {0.0, 0.0, 0.0, 0.05}, eye(5, 0.1, 8.0));
  return world;
}

/// Thin rails are listed twice, once per side visible from the cell: 5 500 of them are 11 000 entries.
TEST(Limits, ListsNearlyAsLongAsTheBoundAreReadToTheEnd) {
  const world::World world = rails(5'500);
  const Glance glance(world, kLimitsOnDevice);
  EXPECT_NEAR(glance.readings[0].values[0], 7.0, 1e-12) << "the last of the list is what the first beam meets";
  EXPECT_EQ(glance.readings[0].hits[0], 1u);
  EXPECT_GT(glance.farm.stats().work.uncertain, 0u) << "the test is meant to send every entry to the 64-bit decision";
  expect_exact("5 500 rails", sweep(world));
}

/// A mover with nearly as many segments as its limit, beside walls with nearly as many as theirs.
TEST(Limits, WallsAndMoversTogetherStayWithinTheLoopsBudget) {
  world::World world = rails(5'500);
  const std::uint32_t m = add_eye(world, {6.0, 0.0, 0.0, 0.0}, eye(1, 0.0, 8.0));
  world::Mover& mover = world.movers[m];
  scenes::remove_lasers(mover);
  for (int i = 0; i < 1'950; ++i) {
    const double y = (i % 2 ? 1.0 : -1.0) * 4e-6;
    add_thin(mover.body, {1.5e-4 * i, y}, {1.5e-4 * i + 1e-5, y}, mover.model);
  }
  add_thin(mover.body, {0.5, -0.01}, {0.5, 0.01}, mover.model);
  mover.radius = 0.51;
  const Glance glance(world);
  EXPECT_NEAR(glance.readings[0].values[0], 6.5, 1e-12) << "the last of the mover's list";
  EXPECT_EQ(glance.readings[0].hits[0], mover.model);
}

/// One more than the limit, and many more: scans run on the host and are counted.
TEST(Limits, MoreWallsInOneSectorThanTheBoundAreCastOnTheHost) {
  for (const int count : {5'601, 12'500}) {
    const world::World world = rails(count);
    const Glance glance(world, kLimitsOnDevice);
    EXPECT_NEAR(glance.readings[0].values[0], 7.0, 1e-12);
    EXPECT_EQ(glance.readings[0].hits[0], 1u);
    EXPECT_EQ(glance.farm.stats().work.host_scans, 1u) << count;
    expect_exact("rails", sweep(world));
  }
  EXPECT_EQ(Glance(rails(5'500), kLimitsOnDevice).farm.stats().work.host_scans, 0u);
}

TEST(Limits, MoreOfMoversInOneSectorThanTheBoundAreCastOnTheHost) {
  world::World world;
  add_eye(world, {}, eye(1, 0.0, 8.0));
  const std::uint32_t m = add_eye(world, {7.0, 0.0, 0.0, 0.0}, eye(1, 0.0, 8.0));
  const auto at = [](int i) { return glm::dvec2{0.0, 1e-4 * i - 0.625}; };
  for (int i = 0; i < 12'500; ++i) add_thin(world.movers[m].body, at(i), at(i + 1), 0);
  world.movers[m].radius = 0.63;
  const Glance glance(world, kLimitsOnDevice);
  EXPECT_NEAR(glance.readings[0].values[0], 7.0, 1e-12);
  EXPECT_EQ(glance.farm.stats().work.host_scans, 1u);
}

/// Further device limits: a dispatch of several rows of groups, and one whose last lanes are padding.
TEST(Limits, AMillionBeamsOfOneSensor) {
  world::World world = scenes::boxes(10, 8.0, 1);
  add_eye(world, {0.3, 0.2, 0, 0}, eye(1'000'000, 2.0 * M_PI, 12.0));
  expect_exact("a million beams", sweep(world));
}

/// Far away, cell indices exceed 32 bits: a short range makes small cells.
TEST(Limits, ShortRangesFarAway) {
  for (const double far : {1e5, 1e7}) {
    world::World world;
    scenes::add_outline(world, {{far + 0.01, -1}, {far + 1, -1}, {far + 1, 1}, {far + 0.01, 1}}, "wall");
    add_eye(world, {far, 0, 0, 0}, eye(5, 0.1, 0.02));
    add_eye(world, {far - 4.0, 0, 0, 0}, eye(5, 0.1, 0.02));
    const Tally tally = sweep(world);
    expect_exact("a range of 2 cm at " + std::to_string(far) + " m", tally);
    EXPECT_EQ(tally.met, 5u);
  }
}

}  // namespace
}  // namespace sf::trial
