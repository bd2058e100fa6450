#include "world/append_object.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/world/read_world.h"
#include "world/lights.h"

namespace sf::world {
namespace {

constexpr const char* kYard = R"(
model( name "room" size [6 4 1] boundary 1 noblocks 0 )
position( name "roomba1" size [0.3 0.3 0.1] )
define crate model( size [0.4 0.2 0.2] )
crate( name "tag9" pose [1 1 0 30] )
crate( name "box" pose [2 -1 0.1 90] model( name "lid" size [0.1 0.1 0.3] ) )
model( name "pole" pose [0 1 0 0] size [0.1 0.1 0.1] magnetic_moment 3000 )
model( name "wall" pose [0 -1 0 0] size [0.1 0.1 0.1] ir_emitter "virtual_wall" )
light( name "light1" pose [-2 1 0 45] size [0.1 0.1 0.5] phases 1 phase[0] ["green" 1] stop_lines "1.1.1" )
)";

std::uint32_t append(World& world, const std::string& name, const std::vector<std::uint32_t>& ids) {
  return append_joining(world, joining_template(world, name), ids);
}

/// Each outline of a copy at the place of the original is that of the original.
TEST(AppendObject, AStaticModelBecomesATagWithItsParts) {
  World world = read_world(kYard);
  const World before = world;
  EXPECT_EQ(outline_size(world, joining_template(world, "box")), 8u) << "with its lid";
  const std::uint32_t row = append(world, "box", {4, 7});
  ASSERT_EQ(world.movers.size(), before.movers.size() + 2);
  const Mover& copy = world.movers[row];
  EXPECT_EQ(copy.name, "box_4");
  EXPECT_EQ(world.movers[row + 1].id, 7u);
  EXPECT_TRUE(copy.is_tag);
  EXPECT_EQ(world.models[copy.model].mover, row);
  ASSERT_EQ(copy.body.size(), 8u);
  for (const Segment& side : copy.body) {
    EXPECT_EQ(world.models[side.model].mover, row);
    const auto same = [&](const Segment& wall) {
      return length(wall.a - transform(copy.X_WM, side.a)) < 1e-12 &&
             length(wall.b - transform(copy.X_WM, side.b)) < 1e-12 &&
             std::abs(wall.z_min - side.z_min - copy.X_WM.z) < 1e-12;
    };
    EXPECT_TRUE(std::any_of(before.walls.begin(), before.walls.end(), same));
  }
  EXPECT_EQ(world.walls.size(), before.walls.size());
  EXPECT_NE(world.hash, before.hash);
}

TEST(AppendObject, TagsAndTheirTypeAreCopied) {
  World world = read_world(kYard);
  for (const char* name : {"tag9", "crate"}) {
    const JoiningTemplate of = joining_template(world, name);
    EXPECT_EQ(of.kind, JoiningKind::object) << name;
    EXPECT_EQ(world.models[of.row].name, "tag9") << name;
  }
  const std::uint32_t row = append(world, "tag9", {20});
  EXPECT_EQ(world.movers[row].body.size(), 4u);
  EXPECT_EQ(joining_template(world, "roomba1").kind, JoiningKind::robot);
}

TEST(AppendObject, ACopyHasTheMagnetsOfTheModel) {
  World world = read_world(kYard);
  ASSERT_EQ(world.magnets.size(), 1u);
  const Mover& copy = world.movers[append(world, "pole", {30})];
  ASSERT_EQ(copy.magnets.size(), 1u);
  EXPECT_NEAR(length(copy.magnets[0].p), 0.0, 1e-12) << "at its middle";
  EXPECT_EQ(copy.magnets[0].moment, world.magnets[0].moment);
  EXPECT_EQ(world.magnets.size(), 1u) << "the original stays";
}

TEST(AppendObject, ALightHasAPostThatMoves) {
  World world = read_world(kYard);
  const std::uint32_t row = append(world, "light1", {20, 21});
  ASSERT_EQ(world.lights.size(), 3u);
  EXPECT_EQ(carrier_of(world, world.lights[0]), kNone);
  EXPECT_EQ(carrier_of(world, world.lights[2]), row + 1);
  EXPECT_EQ(world.lights[2].name, "light1_21");
  EXPECT_TRUE(world.lights[2].points.empty()) << "it governs no stop line";
  EXPECT_EQ(world.movers[row].body.size(), 8u);
  const World back = from_snapshot(snapshot(world));
  EXPECT_EQ(carrier_of(back, back.lights[2]), row + 1);
}

TEST(AppendObject, WhatCannotMoveIsRefused) {
  World world = read_world(kYard);
  const auto refusal = [&](const std::string& name) { return refusal_of([&] { joining_template(world, name); }); };
  EXPECT_NE(refusal("wall").find("'wall' cannot join: infrared emitters"), std::string::npos);
  EXPECT_NE(refusal("bax").find("has no robot, object or light 'bax'"), std::string::npos);
  append(world, "box", {4});
  EXPECT_NE(refusal_of([&] { append(world, "box", {4}); }).find("the name 'box_4' is taken"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
