#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/refusal.h"
#include "tests/robots/scenes.h"
#include "tests/world/read_world.h"
#include "world/append_robot.h"
#include "world/free_space.h"
#include "world/wall_tree.h"
#include "world/world.h"

namespace sf::world {
namespace {

double nearest_wall(const World& world, glm::dvec2 p) {
  double nearest = HUGE_VAL;
  for (const Segment& wall : world.walls) nearest = std::min(nearest, distance(p, wall.a, wall.b));
  return nearest;
}

glm::dvec2 at(const Mover& mover) { return {mover.X_WM.x, mover.X_WM.y}; }

// Two rooms of 6 m x 6 m without a door between them; the robot is in the left one.
World two_rooms() {
  World world = scenes::boxed_world(12, 6);
  scenes::add_wall(world, {6, 0}, {6, 6});
  scenes::add_outline(world.walls, scenes::rectangle({3, 3}, 2, 2));
  scenes::add_create(world, {1, 1, 0.2, 0});
  return world;
}

TEST(CloneRobots, AllPosesAreClear) {
  World world = two_rooms();
  clone_robots(world, 40, 1);
  ASSERT_EQ(world.movers.size(), 40u);
  int to_the_right = 0;
  for (const Mover& mover : world.movers) {
    EXPECT_GE(nearest_wall(world, at(mover)), mover.radius + 0.05 - 1e-12);
    EXPECT_LE(std::abs(mover.X_WM.yaw), M_PI);
    to_the_right += mover.X_WM.yaw < 0.0;
    EXPECT_EQ(mover.X_WM.z, 0.2) << "at the first robot's height";
    for (const Mover& other : world.movers) {
      if (&other == &mover) continue;
      EXPECT_GE(length(at(other) - at(mover)), 2 * mover.radius + 0.05);
    }
  }
  EXPECT_NEAR(to_the_right, 20, 10) << "headings are of the whole turn";
}

TEST(CloneRobots, AllPosesAreReachableFromTheFirstRobot) {
  World world = two_rooms();
  clone_robots(world, 60, 1);
  for (const Mover& mover : world.movers) {
    const glm::dvec2 p = at(mover);
    EXPECT_TRUE(p.x > 0 && p.x < 6 && p.y > 0 && p.y < 6) << "outside, or behind the wall: " << p.x << ", " << p.y;
    EXPECT_FALSE(std::abs(p.x - 3) < 1 && std::abs(p.y - 3) < 1) << "in the block";
  }
}

TEST(CloneRobots, DoorLeadsToTheOtherRoom) {
  World world = scenes::boxed_world(12, 6);
  scenes::add_wall(world, {6, 1}, {6, 6});
  scenes::add_create(world, {1, 1, 0, 0});
  clone_robots(world, 60, 1);
  EXPECT_TRUE(std::any_of(world.movers.begin(), world.movers.end(), [](const Mover& m) { return m.X_WM.x > 6; }));
}

TEST(CloneRobots, PosesDoNotDependOnTheCount) {
  World few = two_rooms(), many = two_rooms();
  clone_robots(few, 10, 7);
  clone_robots(many, 60, 7);
  for (std::size_t k = 0; k < few.movers.size(); ++k) {
    EXPECT_EQ(few.movers[k].X_WM.x, many.movers[k].X_WM.x);
    EXPECT_EQ(few.movers[k].X_WM.yaw, many.movers[k].X_WM.yaw);
  }
}

TEST(CloneRobots, AnotherSeedGivesOtherPoses) {
  World a = two_rooms(), b = two_rooms();
  clone_robots(a, 1, 1);
  clone_robots(b, 1, 2);
  EXPECT_NE(a.movers[0].X_WM.x, b.movers[0].X_WM.x);
}

TEST(CloneRobots, AreTheSame100KmAway) {
  World world = scenes::boxed_world(6, 6, {1e5, 1e5});
  scenes::add_create(world, {1e5 + 3, 1e5 + 3, 0, 0});
  clone_robots(world, 30, 1);
  for (const Mover& mover : world.movers) {
    EXPECT_GT(nearest_wall(world, at(mover)), 0.2);
    EXPECT_LT(std::abs(mover.X_WM.x - 1e5 - 3), 3.0);
  }
}

/// Free places are enumerated from the region's corner, wherever it is.
TEST(CloneRobots, MovedWorldMovesTheCopies) {
  World here = two_rooms(), there = two_rooms();
  const glm::dvec2 by{-32.0, 16.0};  // keeps sums of the cells' coordinates exact
  for (Segment& wall : there.walls) wall.a += by, wall.b += by;
  there.movers[0].X_WM.x += by.x, there.movers[0].X_WM.y += by.y;
  update_extent_and_hash(there);
  clone_robots(here, 30, 1);
  clone_robots(there, 30, 1);
  for (std::size_t k = 0; k < here.movers.size(); ++k) {
    EXPECT_LT(length(at(there.movers[k]) - at(here.movers[k]) - by), 1e-9) << k;
    EXPECT_EQ(there.movers[k].X_WM.yaw, here.movers[k].X_WM.yaw) << k;
  }
}

TEST(CloneRobots, DistantObjectDoesNotCoarsenTheRoom) {
  World world = two_rooms();
  scenes::add_wall(world, {1e5, 1e5}, {1e5, 1e5 + 1});
  clone_robots(world, 40, 1);
  for (const Mover& mover : world.movers) EXPECT_TRUE(mover.X_WM.x > 0 && mover.X_WM.x < 6);
}

TEST(CloneRobots, BridgesDoNotMatterToLowRobots) {
  World world = scenes::boxed_world(1, 1);
  for (double x = 0.1; x < 1.0; x += 0.1) scenes::add_wall(world, {x, 0}, {x, 1}, 1.0, 2.0);
  scenes::add_create(world, {0.5, 0.5, 0, 0});
  EXPECT_NO_THROW(clone_robots(world, 1, 1));
}

// A robot without sensors before two robots with sensors, and a tag before all of these.
World with_a_dummy() {
  World world = scenes::boxed_world(8, 8);
  scenes::add_create(world, {1, 1, 0, 0}).is_tag = true;
  scenes::add_create(world, {2, 2, 0, 0}).name = "dummy";
  scenes::add_create(world, {4, 4, 0, 0}).sensors.push_back(scenes::magnetometers(5));
  scenes::add_create(world, {6, 6, 0, 0}).sensors.push_back({.type = "laser"});
  return world;
}

TEST(CloneRobots, CopiesCarryTheFiducialsOfTheOriginal) {
  World world = read_world(R"(model( size [8 8 1] boundary 1 noblocks 1 )
    model( name "mark" pose [3 3 0 0] size [0.1 0.1 1] fiducial_return 9 )
    position( name "a" size [0.4 0.4 0.2] fiducial_return 5 laser( ) )
    position( name "b" pose [1 1 0 0] size [0.4 0.4 0.2] fiducial_return 6 ))");
  ASSERT_EQ(world.fiducials.size(), 3u);
  clone_robots(world, 2, 1);
  ASSERT_EQ(world.fiducials.size(), 3u) << "those of the removed robots are removed";
  EXPECT_EQ(world.models[world.fiducials[0].model].name, "mark");
  for (std::uint32_t i = 1; i < 3; ++i) {
    EXPECT_EQ(world.fiducials[i].id, 5u);
    EXPECT_EQ(world.models[world.fiducials[i].model].mover, i - 1);
  }
  append_robot(world, 0, "late", {});
  ASSERT_EQ(world.fiducials.size(), 4u);
  EXPECT_EQ(world.models[world.fiducials[3].model].name, "late");
  EXPECT_EQ(world.fiducials[3].id, 5u);
}

TEST(CloneRobots, CopiesTheFirstWithSensorsOrTheNamedRobot) {
  EXPECT_EQ(robot_to_copy(with_a_dummy()), 2u);
  EXPECT_EQ(robot_to_copy(with_a_dummy(), "dummy"), 1u);
  EXPECT_EQ(robot_to_copy(with_a_dummy(), "robot4"), 3u);
  World world = with_a_dummy();
  world.movers[2].sensors.clear();
  EXPECT_EQ(robot_to_copy(world), 3u);
  world.movers[3].sensors.clear();
  EXPECT_EQ(robot_to_copy(world), 1u) << "none has any: the first";
  World copies = with_a_dummy();
  clone_robots(copies, 5, 1);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(copies.movers[k].sensors.size(), 1u);
  clone_robots(copies = with_a_dummy(), 5, 1, "dummy");
  for (std::size_t k = 0; k < 5; ++k) EXPECT_TRUE(copies.movers[k].sensors.empty());
}

TEST(CloneRobots, TagKeepsItsMount) {
  for (const char* const of : {"", "dummy"}) {
    World world = with_a_dummy();
    world.movers[0].X_MT = {0.1, 0.2, 0.3, 0.4};
    clone_robots(world, 3, 1, of);
    ASSERT_EQ(world.movers.size(), 4u);
    EXPECT_TRUE(world.movers[3].is_tag);
    EXPECT_EQ(world.movers[3].X_MT.yaw, 0.4);
    EXPECT_EQ(world.movers[0].X_MT.yaw, 0.0);
  }
}

TEST(CloneRobots, NameOfNoRobotIsRejected) {
  for (const auto& [name, said] : {std::pair{"robot44", "has no robot 'robot44' to copy; did you mean 'robot4'?"},
                                   std::pair{"robot1", "has no robot 'robot1' to copy"}})
    expect_in(said, sf::refusal_of([&] { robot_to_copy(with_a_dummy(), name); }));
}

// Boundary: a pocket of three walls, larger than the room, that is open only at the end of the searched area.
TEST(CloneRobots, PocketAtAnySideOfTheSearchedAreaIsOutside) {
  for (int side = 0; side < 4; ++side) {
    World world = scenes::boxed_world(4, 4, {-2, -2});
    scenes::add_outline(world.walls, scenes::rectangle({0, 0}, 0.6, 0.6));
    const auto turned = [&](glm::dvec2 p) {
      for (int i = 0; i < side; ++i) p = {-p.y, p.x};
      return p;
    };
    scenes::add_wall(world, turned({10, -4}), turned({4, -4}));
    scenes::add_wall(world, turned({4, -4}), turned({4, 4}));
    scenes::add_wall(world, turned({4, 4}), turned({10, 4}));
    scenes::add_create(world, {0, 0, 0, 0});  // inside a solid; the floor is searched for 10 m around it
    clone_robots(world, 10, 1);
    for (const Mover& mover : world.movers) {
      const glm::dvec2 p = at(mover);
      EXPECT_TRUE(std::abs(p.x) < 2 && std::abs(p.y) < 2) << side << ": " << p.x << ", " << p.y;
    }
  }
}

TEST(CloneRobots, LackOfRoomIsReportedWithNumbers) {
  World world = scenes::boxed_world(2, 2);
  scenes::add_create(world, {1, 1, 0, 0});
  const std::string error = sf::refusal_of([&] { clone_robots(world, 1000, 1); });
  expect_in(" of 1000 robots", error);
  EXPECT_TRUE(error.starts_with("scene.world: placed ")) << error;
}

TEST(CloneRobots, NoRobotOrZeroCopiesIsRejected) {
  World empty = scenes::boxed_world(2, 2);
  EXPECT_THROW(clone_robots(empty, 3, 1), base::InputError);
  World tags = two_rooms();
  tags.movers[0].is_tag = true;
  EXPECT_THROW(clone_robots(tags, 3, 1), base::InputError) << "a tag is not a robot";
  World world = two_rooms();
  EXPECT_THROW(clone_robots(world, 0, 1), base::InputError);
}

// A tag, two robots with a carried model each, and a post, in mixed order.
World mixed() {
  World world = scenes::boxed_world(8, 8);
  scenes::add_create(world, {6, 6, 0, 0}).is_tag = true;
  world.movers[0].name = world.models[1].name = "tag3";
  world.movers[0].id = 3;
  scenes::add_create(world, {2, 2, 0, M_PI / 2});
  world.movers[1].name = world.models[2].name = "roomba17";
  world.models.push_back(
      {.name = "roomba17.laser:0", .type = "laser", .parent = 2, .mover = 1, .X_WM = {2, 2.1, 0, M_PI / 2}});
  world.models.push_back({.name = "hat", .type = "model", .parent = 2, .mover = 1, .X_WM = {2, 2, 0, 0}});
  scenes::add_create(world, {4, 4, 0, 0});
  world.models.push_back({.name = "post", .type = "model"});
  scenes::add_outline(world.walls, scenes::rectangle({4, 4}, 0.1, 0.1));
  for (auto s = world.walls.end() - 4; s != world.walls.end(); ++s)
    s->model = static_cast<std::uint32_t>(world.models.size() - 1);
  world.movers[1].body[0].model = 4;  // a segment of the carried model
  return world;
}

TEST(CloneRobots, RowsNamesAndIds) {
  World world = mixed();
  clone_robots(world, 3, 1);
  ASSERT_EQ(world.movers.size(), 4u);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Mover& mover = world.movers[k];
    const std::string name = "roomba" + std::to_string(k + 1);
    EXPECT_EQ(mover.name, name);
    EXPECT_EQ(mover.id, k + 1);
    EXPECT_EQ(world.models[mover.model].name, name);
    EXPECT_EQ(world.models[mover.model].X_WM.x, mover.X_WM.x);
    EXPECT_EQ(world.models[mover.body[0].model].name, name + ".hat");
    EXPECT_EQ(world.models[mover.body[1].model].name, name);
  }
  EXPECT_EQ(world.movers[3].name, "tag3");
  EXPECT_EQ(world.models[world.movers[3].model].name, "tag3");
  EXPECT_EQ(world.models[world.walls.back().model].name, "post");
}

TEST(CloneRobots, ModelsStayConsistent) {
  World world = mixed();
  clone_robots(world, 5, 1);
  std::set<std::string> names;
  for (const Model& model : world.models) {
    EXPECT_TRUE(names.insert(model.name).second) << model.name << " twice";
    if (model.parent == kNone) continue;
    const Model& parent = world.models.at(model.parent);
    EXPECT_EQ(parent.mover, model.mover);
    if (model.type != "laser") continue;
    EXPECT_NEAR(std::hypot(model.X_WM.x - parent.X_WM.x, model.X_WM.y - parent.X_WM.y), 0.1, 1e-12);
  }
  EXPECT_EQ(names.size(), 3u + 5u * 3u) << "walls, post, tag; three models a robot";
}

/// Tags follow the copies; each keeps its own models.
TEST(CloneRobots, EveryTagHasItsOwnRow) {
  World world = mixed();
  for (const std::uint32_t id : {8u, 9u}) {
    scenes::add_create(world, {7, 1.0 * (id - 7), 0, 0}).is_tag = true;
    Mover& tag = world.movers.back();
    tag.id = id;
    tag.name = world.models[tag.model].name = "tag" + std::to_string(id);
  }
  clone_robots(world, 4, 1);
  ASSERT_EQ(world.movers.size(), 7u);
  std::set<std::string> tags;
  for (std::uint32_t row = 4; row < 7; ++row) {
    EXPECT_TRUE(world.movers[row].is_tag) << row;
    EXPECT_EQ(world.models[world.movers[row].model].name, world.movers[row].name);
    EXPECT_EQ(world.models[world.movers[row].model].mover, row);
    tags.insert(world.movers[row].name);
  }
  EXPECT_EQ(tags, (std::set<std::string>{"tag3", "tag8", "tag9"}));
}

TEST(CloneRobots, CopiesKeepClearOfTags) {
  World world = mixed();
  clone_robots(world, 60, 1);
  for (std::size_t k = 0; k < 60; ++k) EXPECT_GT(length(at(world.movers[k]) - at(world.movers[60])), 0.33 + 0.05);
}

}  // namespace
}  // namespace sf::world
