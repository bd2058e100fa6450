#include "world/copies.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/refusal.h"
#include "world/random_starts.h"
#include "world/shapes.h"
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

TEST(RandomStarts, SizesAreUniformAboutThatOfTheFile) {
  const RandomStart random{.size_spread = {0.5, 0.0, 0.25}};
  glm::dvec3 least{1e9}, most{-1e9}, sum{};
  constexpr int kRuns = 4'000;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    const glm::dvec3 size = draw_size(random, {1.0, 2.0, 0.5}, seed, 0);
    least = glm::min(least, size), most = glm::max(most, size), sum += size;
  }
  EXPECT_GE(least.x, 0.5);
  EXPECT_LE(most.x, 1.5);
  EXPECT_GT(most.x - least.x, 0.995);
  EXPECT_EQ(least.y, 2.0);
  EXPECT_EQ(most.y, 2.0);
  EXPECT_NEAR(sum.x / kRuns, 1.0, 5.0 * 0.5 / std::sqrt(3.0 * kRuns));  // five standard errors
  EXPECT_NEAR(sum.z / kRuns, 0.5, 5.0 * 0.25 / std::sqrt(3.0 * kRuns));
}

TEST(RandomStarts, VariationsAreUniformUpToTheirKeys) {
  const RandomStart random{.slip = 0.2, .acceleration = 0.5, .noise = 1.0};
  Variation sum{0.0, 0.0, 0.0};
  constexpr int kRuns = 4'000;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    const Variation v = draw_variation(random, seed, 1u << 31);
    EXPECT_TRUE(v.slip >= 0.0 && v.slip <= 0.2 && v.acceleration >= 0.5 && v.acceleration <= 1.0 && v.noise >= 0.0 &&
                v.noise <= 1.0);
    sum = {sum.slip + v.slip, sum.acceleration + v.acceleration, sum.noise + v.noise};
  }
  const double error = 5.0 / std::sqrt(12.0 * kRuns);  // five standard errors of a unit interval
  EXPECT_NEAR(sum.slip / kRuns, 0.1, 0.2 * error);
  EXPECT_NEAR(sum.acceleration / kRuns, 0.75, 0.5 * error);
  EXPECT_NEAR(sum.noise / kRuns, 0.5, error);
}

constexpr const char* kVaried =
    "model( name \"crate\" size [0.4 0.6 1] random_size [0.2 0.3 0.5] model( name \"lid\" size [0.1 0.1 0.1] ) ) "
    "position( name \"r\" random_slip 0.2 random_noise 0.5 ) position( name \"s\" )";

TEST(RandomStarts, ASizeScalesTheModelsOwnOutline) {
  World world = build_world("random.world", kVaried);
  const Mover before = world.movers[0];
  draw_starts(world, 3);
  const Mover& crate = world.movers[0];
  const glm::dvec3 size = size_of(world, crate);
  EXPECT_NE(size.x, 0.4);
  EXPECT_EQ(world.models[crate.model].size.x, size.x);
  for (std::size_t i = 0; i < crate.body.size(); ++i) {
    const bool own = crate.body[i].model == crate.model;
    EXPECT_EQ(std::abs(crate.body[i].a.x), own ? size.x / 2.0 : std::abs(before.body[i].a.x)) << i;
    EXPECT_EQ(crate.body[i].z_max == before.body[i].z_max, !own) << i;
  }
  EXPECT_EQ(crate.radius, radius_of(crate));
}

TEST(RandomStarts, VariationsSurviveASnapshot) {
  World world = build_world("random.world", kVaried);
  const std::uint64_t plain = world.hash;
  draw_variations(world, 3);
  EXPECT_NE(world.hash, plain);
  ASSERT_EQ(world.variations.size(), 3u);
  EXPECT_EQ(world.variation_of(2), Variation{});  // without a key
  EXPECT_GT(world.variation_of(1).slip, 0.0);
  EXPECT_EQ(from_snapshot(snapshot(world)).variations, world.variations);
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
  EXPECT_EQ(refused("model( size [1 1 1] random_size [1 0 0] )"),
            "random.world:1: 'random_size' is [1 0 0] m around a size of [1 1 1] m; expected less than it");
  EXPECT_NE(refused("model( size [1 1 1] random_size [-0.1 0 0] )"), "");
  expect_in("a robot, whose controllers", refused("position( random_size [0.05 0.05 0] )"));
  expect_in("a magnet", refused("model( magnetic_moment 1 random_size [0.05 0.05 0] )"));
  expect_in("a mark for fiducial finders", refused("model( fiducial_return 1 random_size [0.05 0.05 0] )"));
  EXPECT_EQ(refused("position( random_slip 0.95 )"),
            "random.world:1: 'random_slip' is 0.95; expected a number from 0 to 0.9");
  EXPECT_NE(refused("position( random_noise -0.1 )"), "");
  expect_in("which 'r' has none of", refused("position( name \"r\" random_acceleration 0.5 )"));
}

}  // namespace
}  // namespace sf::world
