#include "robots/contact_sectors.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "base/random.h"
#include "base/report.h"
#include "tests/robots/scenes.h"

namespace sf::robots {
namespace {

using base::Pose;

Footprint square() {
  world::World world = scenes::empty_world();
  return footprint_of(scenes::add_square(world, {}));
}

Footprint disc() {
  world::World world = scenes::empty_world();
  return footprint_of(scenes::add_create(world, {}));
}

world::Segment wall(glm::dvec2 a, glm::dvec2 b, double z_min = 0.0, double z_max = 1.0) {
  return {.a = a, .b = b, .z_min = z_min, .z_max = z_max, .solid_left = false};
}

std::uint32_t bit(int k) { return 1u << ((k + 32) % 32); }

TEST(Sectors, PostTouchesOneSector) {
  // Sector 0 begins at bearing 0; the square's right side is at x = 0.2.
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.2005, 0.01}, {0.2005, 0.012})), bit(0));
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.2005, -0.01}, {0.2005, -0.012})), bit(-1));
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.01, 0.2005}, {0.012, 0.2005})), bit(7));
  EXPECT_EQ(contact_sectors(square(), {}, wall({-0.2005, 0.01}, {-0.2005, 0.012})), bit(15));
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.01, -0.2005}, {0.012, -0.2005})), bit(24));
}

TEST(Sectors, WallAlongASideTouchesAllSectorsOfTheSide) {
  const std::uint32_t side = bit(0) | bit(1) | bit(2) | bit(3) | bit(-1) | bit(-2) | bit(-3) | bit(-4);
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.2005, -0.2}, {0.2005, 0.2})), side) << "from -45 to 45 degrees";
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.2005, -5.0}, {0.2005, 5.0})), side | bit(4) | bit(-5))
      << "a longer wall is within a millimetre of the corners on their other side, too";
}

TEST(Sectors, DiscTouchesAWallAtTheNearestPoint) {
  const std::uint32_t front = contact_sectors(disc(), {}, wall({0.1655, -5.0}, {0.1655, 5.0}));
  EXPECT_EQ(front, bit(0) | bit(-1)) << "its corner at bearing 0 is on the border of two";
}

TEST(Sectors, EndWhereTheSurfaceIsAMillimetreAway) {
  EXPECT_NE(contact_sectors(square(), {}, wall({0.20099, -1.0}, {0.20099, 1.0})), 0u);
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.20101, -1.0}, {0.20101, 1.0})), 0u);
}

TEST(Sectors, CornerTouchesASurfaceAtExactlyAMillimetre) {
  world::World world = scenes::empty_world();
  const Footprint diamond = footprint_of(scenes::add_mover(world, {}, {{1, 0}, {0, 1}, {-1, 0}, {0, -1}}));
  const double x = diamond.radius + kContactDistance;
  ASSERT_LE(x - diamond.radius, kContactDistance) << "by rounding";
  EXPECT_EQ(contact_sectors(diamond, {}, wall({x, -0.1}, {x, 0.1})), bit(0) | bit(-1));
}

TEST(Sectors, ObjectsAboveOrBelowDoNotTouch) {
  EXPECT_NE(contact_sectors(square(), {0, 0, 0.5, 0}, wall({0.2, -1.0}, {0.2, 1.0})), 0u);
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.2, -1.0}, {0.2, 1.0}, 0.1, 1.0)), 0u) << "the square is 0.1 m high";
  EXPECT_EQ(contact_sectors(square(), {0, 0, 1.0, 0}, wall({0.2, -1.0}, {0.2, 1.0})), 0u);
}

TEST(Sectors, WallThroughTheBodyCountsAsInside) {
  const std::uint32_t through = contact_sectors(square(), {}, wall({0.1, -5.0}, {0.1, 5.0}));
  EXPECT_EQ(through & (bit(0) | bit(-1)), bit(0) | bit(-1)) << "ahead";
  EXPECT_EQ(through & (bit(15) | bit(16)), 0u) << "and not behind";
  EXPECT_EQ(contact_sectors(square(), {}, wall({0.1, 0.01}, {0.1, 0.011})), bit(0)) << "wholly inside";
}

TEST(Sectors, TurnWithTheMover) {
  const world::Segment post = wall({1.2005, 2.01}, {1.2005, 2.012});
  EXPECT_EQ(contact_sectors(square(), {1, 2, 0, 0}, post), bit(0));
  EXPECT_EQ(contact_sectors(square(), {1, 2, 0, M_PI / 2}, post), bit(24)) << "the post is now on its right";
}

TEST(Sectors, AnotherOutlineEqualsItsEdges) {
  const std::uint32_t right = contact_sectors(square(), {}, square(), {0.4005, 0, 0, 0});
  EXPECT_EQ(right, bit(0) | bit(1) | bit(2) | bit(3) | bit(-1) | bit(-2) | bit(-3) | bit(-4));
  EXPECT_EQ(contact_sectors(square(), {}, square(), {0.4011, 0, 0, 0}), 0u);
  EXPECT_EQ(contact_sectors(square(), {}, square(), {0.4005, 0, 0.2, 0}), 0u) << "above";
  EXPECT_EQ(contact_sectors(square(), {}, square(), {0.4 + 0.4 * (M_SQRT2 - 1.0) / 2 + 0.0005, 0, 0, M_PI / 4}),
            bit(0) | bit(-1))
      << "a corner";
}

TEST(Sectors, AllAreTouchedInsideALargerSolid) {
  world::World world = scenes::empty_world();
  const Footprint large = footprint_of(scenes::add_mover(world, {}, scenes::rectangle({}, 4.0, 4.0)));
  EXPECT_EQ(contact_sectors(square(), {0.5, 0.2, 0, 1}, large, {}), ~0u);
  EXPECT_EQ(contact_sectors(square(), {2.5, 0.2, 0, 0}, large, {}), 0u);
}

TEST(Sectors, EmptyOutlineTouchesNothing) {
  EXPECT_EQ(contact_sectors(Footprint{.step = 1.0}, {}, wall({0.0, -1.0}, {0.0, 1.0})), 0u);
  EXPECT_EQ(contact_sectors(Footprint{.step = 1.0}, {}, square(), {}), 0u);
}

TEST(Sectors, AreTheSame100KmAway) {
  const Pose X{1e5, -1e5, 0, 0.3};
  const auto moved = [&](glm::dvec2 p) { return transform(X, p); };
  EXPECT_EQ(contact_sectors(square(), X, wall(moved({0.2005, -0.01}), moved({0.2005, -0.012}))), bit(-1));
}

// Reference: many points along the wall, within reach of the outline or inside it, with distances in long double.
TEST(Sectors, AgreeWithPointsAlongTheWall) {
  const Footprint outline = disc();
  int pressed = 0;
  for (std::uint32_t k = 0; k < 300; ++k) {
    const auto u = base::random_uniform({.seed = 21, .stream = base::RandomStream::placement, .a = k}, 0);
    const auto v = base::random_uniform({.seed = 21, .stream = base::RandomStream::placement, .a = k}, 1);
    const Pose X{u[0], u[1], 0, 6.0 * v[0]};
    const double bearing = 2.0 * M_PI * v[1];
    const double far =
        0.1 + 0.08 * base::random_uniform({.seed = 21, .stream = base::RandomStream::placement, .a = k}, 2)[0];
    const glm::dvec2 middle = transform(X, base::rotate(bearing, {far, 0.0}));
    const glm::dvec2 along = base::rotate(bearing + X.yaw + 0.5 * M_PI + 0.8 * (v[0] - 0.5), {0.1, 0.0});
    const world::Segment w = wall(middle - along, middle + along);
    std::uint32_t expected = 0, border = 0;
    for (int i = 0; i <= 4000; ++i) {
      const glm::dvec2 p = base::rotate(-X.yaw, w.a + i / 4000.0 * (w.b - w.a) - glm::dvec2{X.x, X.y});
      double depth = HUGE_VAL;  // [m] smallest distance inside all sides; negative outside
      for (const FootprintEdge& e : outline.edges)
        depth = std::min(depth, base::cross(e.b - e.a, p - e.a) / length(e.b - e.a));
      const double sector = (base::wrap_angle(std::atan2(p.y, p.x)) + (p.y < 0.0 ? 2.0 * M_PI : 0.0)) * 16.0 / M_PI;
      // Skips points at the limit of the reach or of the sector.
      const bool doubtful = std::abs(depth + kContactDistance) < 1e-4 || std::abs(sector - std::round(sector)) < 0.01;
      if (depth > -kContactDistance - 1e-4) (doubtful ? border : expected) |= bit(static_cast<int>(sector));
      if (doubtful) border |= bit(static_cast<int>(std::round(sector))) | bit(static_cast<int>(std::round(sector)) - 1);
    }
    const std::uint32_t actual = contact_sectors(outline, X, w);
    EXPECT_EQ(actual & ~border, expected & ~border) << "wall " << k;
    EXPECT_EQ(expected & ~actual, 0u) << "wall " << k;
    pressed += std::popcount(actual);
  }
  EXPECT_GT(pressed, 300) << "the walls should touch something";
}

/// Random pairs of discs and squares of all sizes: the quick tests must agree with the full tests that they replace.
TEST(Sectors, QuickTestsAgreeWithFullTests) {
  int deep = 0, fewer = 0;
  for (std::uint32_t k = 0; k < 20'000; ++k) {
    const auto u = base::random_uniform({.seed = 4, .a = k}, 0), v = base::random_uniform({.seed = 4, .a = k}, 1);
    Footprint outlines[2] = {k % 2 == 0 ? disc() : square(), k % 3 == 0 ? square() : disc()};
    world::World world = scenes::empty_world();
    world::Mover& mover = scenes::add_square(world, {});
    for (world::Segment& s : mover.body) s.a = (0.1 + 3.0 * u[0]) * s.a, s.b = (0.1 + 3.0 * u[0]) * s.b;
    if (k % 5 == 0) outlines[1] = footprint_of(mover);
    const Pose X{3.0, -2.0, 0.0, 6.0 * v[0]};
    const double apart = u[1] * (outlines[0].radius + outlines[1].radius), bearing = 6.28 * v[1];
    const Pose other{X.x + apart * std::cos(bearing), X.y + apart * std::sin(bearing), 0.0, 5.0 * u[0]};
    const std::uint32_t sectors = contact_sectors(outlines[0], X, outlines[1], other);
    const std::uint32_t asked = sectors_to_test(outlines[0], X, outlines[1], other, 0);
    EXPECT_EQ(sectors & ~asked, 0u) << k;
    for (const std::uint32_t known : {0x0000FFFFu, 0x55555555u, sectors}) {
      const std::uint32_t left = sectors_to_test(outlines[0], X, outlines[1], other, known);
      EXPECT_EQ(contact_sectors(outlines[0], X, outlines[1], other, left) | known, sectors | known) << k;
    }
    fewer += asked != kAllSectors;
    if (!surely_overlap(outlines[0], outlines[1], apart, 0.0)) continue;
    ++deep;
    std::vector<FootprintEdge> p(16), q(16);
    EXPECT_TRUE(touches(place_footprint(outlines[0], X, p), place_footprint(outlines[1], other, q))) << k;
    EXPECT_NE(sectors, 0u) << k;
  }
  EXPECT_GT(deep, 5'000);
  EXPECT_GT(fewer, 5'000);
}

TEST(Sectors, MoversAboveEachOtherDoNotSurelyOverlap) {
  EXPECT_TRUE(surely_overlap(disc(), disc(), 0.1, 0.099)) << "heights overlap by a millimetre";
  EXPECT_FALSE(surely_overlap(disc(), disc(), 0.1, 0.1)) << "one ends where the other begins";
  EXPECT_FALSE(surely_overlap(disc(), disc(), 0.1, -0.1));
  EXPECT_FALSE(surely_overlap(disc(), disc(), 0.33, 0.0)) << "the discs inside the outlines do not meet";
}

}  // namespace
}  // namespace sf::robots
