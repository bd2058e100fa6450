#include "world/copies.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/refusal.h"
#include "world/random_starts.h"
#include "world/stage/build_world.h"

namespace sf::world {
namespace {

World two_movers(const char* keys = "") {
  return build_world(
      "two.world",
      std::string("position( name \"a\" pose [0 0 0 0] ) model( name \"tag1\" pose [2 0 0 0] ") + keys + ")");
}

TEST(CopyIndex, AWorldWithoutCopiesMayGrow) {
  World world = two_movers();
  const CopyIndex copies(world);
  EXPECT_EQ(copies.row_of(7), 7u);  // a row that joined later
  EXPECT_EQ(copies.copy_of(7), 0u);
  EXPECT_EQ(copies.rows_with(1, 5), std::pair(0u, 5u));
}

TEST(CopyIndex, RowsOfCopies) {
  World world = two_movers();
  copy_movers(world, 3);
  const CopyIndex copies(world);
  ASSERT_EQ(world.movers.size(), 6u);
  EXPECT_EQ(copies.copy_of(5), 2u);
  EXPECT_EQ(copies.row_of(5), 1u);
  EXPECT_EQ(copies.in_copy_of(4, 1), 5u);
  EXPECT_EQ(copies.rows_with(3, 6), std::pair(2u, 4u));
  EXPECT_TRUE(copies.meet(2, 3));
  EXPECT_FALSE(copies.meet(1, 2));
}

TEST(CopyMovers, KeepsNamesIdsAndModels) {
  World world = two_movers();
  copy_movers(world, 2);
  EXPECT_EQ(world.movers[2].name, "a");
  EXPECT_EQ(world.movers[3].id, world.movers[1].id);
  EXPECT_EQ(world.movers[3].model, world.movers[1].model);
}

TEST(CopyMovers, Refuses) {
  World world = two_movers();
  EXPECT_EQ(refusal_of([&] { copy_movers(world, 0); }), "0 worlds requested; expected from 1 to 100000");
  EXPECT_NE(refusal_of([&] { copy_movers(world, 100'001); }), "");
  world.movers.resize(20, world.movers[0]);
  EXPECT_NE(refusal_of([&] { copy_movers(world, 50'001); }).find("expected fewer worlds"), std::string::npos);
  World magnetic = two_movers("magnetic_moment 1 size [0.1 0.1 0.1] ");
  EXPECT_NE(refusal_of([&] { copy_movers(magnetic, 2); }).find("'tag1' carries magnets"), std::string::npos);
}

TEST(CopyMovers, OneCopyMayCarryMagnets) {
  World magnetic = two_movers("magnetic_moment 1 size [0.1 0.1 0.1] ");
  copy_movers(magnetic, 1);
  EXPECT_EQ(magnetic.movers.size(), 2u);
}

TEST(RandomStarts, AreUniformWithinTheirSpread) {
  Mover mover;
  mover.is_tag = true;
  mover.random_start = {{2.0, 0.0, M_PI}, 0.25};
  int present = 0;
  double least = 1e9, most = -1e9, sum = 0.0;
  constexpr int kRuns = 4'000;
  for (int seed = 0; seed < kRuns; ++seed) {
    draw_start(mover, {1.0, 5.0, 0.5, 0.0}, static_cast<std::uint64_t>(seed), 3);
    least = std::min(least, mover.X_WM.x), most = std::max(most, mover.X_WM.x), sum += mover.X_WM.x;
    present += !mover.absent;
    EXPECT_EQ(mover.X_WM.y, 5.0);
    EXPECT_LE(std::abs(mover.X_WM.yaw), M_PI);
  }
  EXPECT_GE(least, -1.0);
  EXPECT_LE(most, 3.0);
  EXPECT_GT(most - least, 3.98);
  EXPECT_NEAR(sum / kRuns, 1.0, 5.0 * 2.0 / std::sqrt(3.0 * kRuns));  // five standard errors
  EXPECT_NEAR(present, 0.25 * kRuns, 5.0 * std::sqrt(0.25 * 0.75 * kRuns));
}

TEST(RandomStarts, DependOnSeedAndRow) {
  Mover mover;
  mover.random_start = {{1.0, 1.0, 1.0}, 1.0};
  std::set<double> places;
  for (const std::uint64_t seed : {1u, 2u})
    for (const std::uint32_t row : {0u, 1u}) {
      draw_start(mover, {}, seed, row);
      places.insert(mover.X_WM.x);
    }
  EXPECT_EQ(places.size(), 4u);
  const double last = mover.X_WM.x;
  draw_start(mover, {}, 2, 1);
  EXPECT_EQ(mover.X_WM.x, last);
}

TEST(RandomStarts, AModelWithThemIsAnObjectWithTheNextNumber) {
  const World world = build_world("random.world",
                                  "model( name \"tag1\" ) model( name \"crate\" random_pose [1 2 45] ) "
                                  "model( name \"wall\" ) position( name \"r\" random_pose [0 0 180] )");
  ASSERT_EQ(world.movers.size(), 3u);
  EXPECT_EQ(world.movers[1].name, "crate");
  EXPECT_TRUE(world.movers[1].is_tag);
  EXPECT_EQ(world.movers[1].id, 2u);
  EXPECT_EQ(world.movers[1].random_start.spread, (glm::dvec3{1.0, 2.0, M_PI_4}));
  EXPECT_FALSE(world.movers[2].is_tag);
}

TEST(RandomStarts, Refusals) {
  const auto refused = [](const std::string& text) { return refusal_of([&] { build_world("random.world", text); }); };
  EXPECT_EQ(refused("model( random_pose [1 -2 0] )"),
            "random.world:1: 'random_pose' expects [x y yaw]: the largest distances from 'pose', at least 0");
  EXPECT_NE(refused("model( random_pose [1 2 361] )"), "");
  EXPECT_NE(refused("model( random_pose [1 2 3 4] )"), "");
  EXPECT_EQ(refused("model( random_present 1.5 )"),
            "random.world:1: 'random_present' is 1.5; expected a probability from 0 to 1");
  EXPECT_EQ(refused("position( random_present 0.5 )"),
            "random.world:1: a robot cannot be missing; expected 'random_present' in another model");
  EXPECT_NE(refused("position( name \"r\" model( name \"box\" random_pose [1 1 0] ) )").find("stands free"),
            std::string::npos);
}

}  // namespace
}  // namespace sf::world
