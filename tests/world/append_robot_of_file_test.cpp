// Robots of other world files.

#include <gtest/gtest.h>

#include "tests/folder.h"
#include "tests/world/read_world.h"
#include "world/append_robot.h"
#include "world/free_space.h"

namespace sf::world {
namespace {

const std::string kInclude =
    "# a comment\ndefine wheeled position( size [0.4 0.3 0.2] )\n"
    "define scout wheeled( name \"ann\" laser( samples 7\n fow 90 ) model( size [0.1 0.1 0.1] ) )\n"
    "define box model( size [1 1 1] )";

class RobotOfFile : public FolderTest {
 protected:
  static std::string error(const std::string& file, const std::string& name) {
    World world;
    const std::string error = sf::refusal_of([&] { append_robot_of(world, file, name, kWithLasers); });
    return error.substr(error.rfind('/') + 1);
  }
};

TEST_F(RobotOfFile, MayBeDefinedInTheFile) {
  World world = read_world("model( name \"wall\" size [1 1 1] pose [5 0 0 0] )");
  const std::uint64_t before = world.hash;
  const std::uint32_t row = append_robot_of(world, write("own.inc", kInclude), "scout", kWithLasers);
  ASSERT_EQ(world.movers.size(), 1u);
  const Mover& robot = world.movers[row];
  EXPECT_EQ(robot.name, "scout") << "not the name of its definition, of which there are many";
  EXPECT_EQ(robot.id, 1u);
  EXPECT_EQ(robot.X_WM.x, 0.0);
  EXPECT_FALSE(robot.is_tag);
  ASSERT_EQ(robot.sensors.size(), 1u);
  EXPECT_EQ(world.models[robot.model].name, "scout");
  EXPECT_EQ(world.models[robot.model].type, "scout");
  EXPECT_EQ(world.models[robot.model].parent, kNone);
  for (const Segment& side : robot.body) {
    EXPECT_EQ(world.models[side.model].mover, row) << "its models come with it";
    EXPECT_TRUE(world.models[side.model].name.starts_with("scout")) << world.models[side.model].name;
  }
  EXPECT_NE(world.hash, before);
  EXPECT_EQ(world.walls.size(), 4u) << "nothing else of the file";
}

/// Mistakes in the definition are reported with their lines. The place of a robot in its own world does not matter.
TEST_F(RobotOfFile, WarningsOfTheFileAreKept) {
  World world;
  append_robot_of(world, write("own.world", kInclude + "\nbox( )\n"), "scout", kWithLasers);
  ASSERT_EQ(world.warnings.size(), 1u) << warnings_of(world);
  EXPECT_EQ(world.warnings[0].line, 4);
  EXPECT_NE(world.warnings[0].message.find("'fow'"), std::string::npos);
}

TEST_F(RobotOfFile, MayBeARobotOfAWorld) {
  const std::string file =
      write("two.world",
            "model( size [9 0.1 1] pose [0 4 0 0] )\n"
            "position( name \"roomba4\" pose [3 1 0 90] size [0.3 0.3 0.1] laser( pose [0.1 0 0 0] "
            "samples 3 ) )\nmodel( name \"tag2\" pose [1 1 0 0] size [0.1 0.1 0.1] )\n");
  World world = read_world("model( name \"roomba4\" size [1 1 1] pose [5 0 0 0] )"),
        there = load_world(file, kWithLasers);
  const std::uint32_t row = append_robot_of(world, file, "roomba4", kWithLasers);
  EXPECT_EQ(world.movers[row].name, "roomba4_") << "a wall has its name";
  EXPECT_EQ(world.movers[row].X_WM.yaw, 0.0);
  ASSERT_EQ(world.movers[row].body.size(), there.movers[0].body.size());
  for (std::size_t i = 0; i < there.movers[0].body.size(); ++i)
    EXPECT_EQ(world.movers[row].body[i].a, there.movers[0].body[i].a);
  EXPECT_EQ(world.movers[row].sensors[0].X_MS.x, there.movers[0].sensors[0].X_MS.x);
  clone_robots(world, 5, 3, "roomba4_");
  EXPECT_EQ(world.movers.size(), 5u);
}

TEST_F(RobotOfFile, UnknownNamesListTheExistingOnes) {
  const std::string file = write("own.world", kInclude + "\nscout( name \"bob\" )\nmodel( name \"tag1\" )\n");
  EXPECT_EQ(error(file, "scuot"),
            "own.world: has no robot 'scuot'; did you mean 'scout'? Expected one of: bob, scout, wheeled");
  EXPECT_EQ(error(file, "bobb"),
            "own.world: has no robot 'bobb'; did you mean 'bob'? Expected one of: bob, scout, wheeled");
  EXPECT_EQ(error(file, "box"),
            "own.world: has no robot 'box'; did you mean 'bob'? Expected one of: bob, scout, wheeled")
      << "is no robot";
  EXPECT_NE(error(file, "tag1").find("has no robot 'tag1'"), std::string::npos);
  EXPECT_EQ(error(file, ""),
            "own.world: requires the name of a robot, as in FILE:NAME; expected one of: bob, scout, wheeled");
}

TEST_F(RobotOfFile, FilesWithoutRobotsAreRejected) {
  EXPECT_NE(
      error(write("walls.world", "model( size [1 1 1] )"), "a").find("has no robots; expected a world file with one"),
      std::string::npos);
  write("m.pgm", "P2 3 2 255\n0 128 255\n255 255 255\n");
  EXPECT_NE(error(write("m.yaml", "image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n"), "a").find("has no robots"),
            std::string::npos);
  EXPECT_NE(error(write("s.toml", "world = \"x\"\n"), "a").find("is not a world"), std::string::npos);
  EXPECT_NE(error(path("none.inc"), "a").find("no such file"), std::string::npos);
  std::string many;
  for (int i = 0; i < 30; ++i) many += "define r" + std::to_string(i) + " position( )\n";
  EXPECT_NE(error(write("many.inc", many), "zzz").find(" and 10 more"), std::string::npos);
}

/// Every robot in the shipped definitions.
TEST_F(RobotOfFile, ShippedRobotsLoad) {
  for (const char* name : {"create", "pioneer3at", "khepera2"}) {
    World world;
    append_robot_of(world, SF_SOURCE_DIR "/worlds/robots.inc", name, kWithLasers);
    EXPECT_EQ(world.movers.size(), 1u) << name;
    EXPECT_EQ(warnings_of(world), "") << name;
  }
}

}  // namespace
}  // namespace sf::world
