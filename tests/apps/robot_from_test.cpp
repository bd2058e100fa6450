// `--robot-from FILE:NAME`: puts a user's robot into a map.

#include <gtest/gtest.h>

#include "base/error.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {
namespace {

/// Writes a room of 8 m x 8 m as a ROS map.
std::string write_map(const Folder& folder) {
  std::string pixels = "P2 80 80 255\n";
  for (int i = 0; i < 80 * 80; ++i) pixels += i % 80 == 0 || i % 80 == 79 || i < 80 || i >= 79 * 80 ? "0 " : "254 ";
  folder.write("house.pgm", pixels);
  return folder.write("house.yaml",
                      "image: house.pgm\nresolution: 0.1\norigin: [-4, -4, 0]\nnegate: 0\n"
                      "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
}
const char* const kOwn = "define scout position( size [0.4 0.3 0.2] laser( samples 7 fov 90 range_max 5 ) )\n";

TEST(RobotFrom, ReplacesTheDefaultRobotOfAMap) {
  const Folder folder;
  const std::string map = write_map(folder), own = folder.write("own.inc", kOwn) + ":scout";
  const Outcome one = run_successfully({"run", map, "--robot-from", own, "--duration", "1", "--json"});
  EXPECT_EQ(Json(one.out).number("/robots"), 1);
  EXPECT_EQ(one.err.find("using the default robot"), std::string::npos) << one.err;
  const Outcome many =
      run_successfully({"run", map, "--robot-from", own, "--robots", "5", "--duration", "1", "--json"});
  EXPECT_EQ(Json(many.out).number("/robots"), 5);
  const Outcome sense = run_successfully({"sense", map, "--robot-from", own});
  EXPECT_NE(sense.err.find("scout1 at ("), std::string::npos) << sense.err;
  EXPECT_NE(run_program({"sense", map}).err.find("give --robot-from FILE:NAME"), std::string::npos);
  for (const Words& words : std::vector<Words>{{"serve", map, "--port", "0", "--duration", "0.2"},
                                               {"serve", map, "--lockstep", "--port", "0", "--duration", "0.2"},
                                               {"robot", map, "--name", "scout1", "--port", "9", "--duration", "0.1"},
                                               {"explain", map}}) {
    const Outcome outcome = run_program(with(words, {"--robot-from", own}));
    EXPECT_EQ(outcome.err.find("using the default robot"), std::string::npos) << words[0] << outcome.err;
    EXPECT_EQ(outcome.code, words[0] == "robot" ? 1 : 0) << words[0] << outcome.err;  // no farm answers
  }
}

/// Worlds with robots are unchanged, except for copies.
TEST(RobotFrom, IsClonedInAnyWorld) {
  const Folder folder;
  const std::string own = folder.write("own.inc", kOwn) + ":scout", cave = our_world("cave.world");
  const Outcome copies =
      run_successfully({"run", cave, "--robot-from", own, "--robots", "3", "--duration", "0.5", "--json"});
  EXPECT_EQ(Json(copies.out).number("/robots"), 3);
  expect_refused({"run", cave, "--robot-from", own}, "has its own robots; --robot-from is for worlds without");
}

/// Like worlds, FILE may also be an installed file.
TEST(RobotFrom, FilesAreFoundAsWorldsAre) {
  const Folder folder;
  const std::string map = write_map(folder);
  for (const char* own :
       {"worlds/robots.inc:create", "worlds/simville/simville.world:car", "worlds/simville/simville.world:roomba0"}) {
    const Outcome outcome = run_successfully({"serve", map, "--robot-from", own, "--port", "0", "--duration", "0.1"});
    EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << own << ": " << outcome.err;
  }
}

TEST(RobotFrom, MistakesAreReported) {
  const Folder folder;
  const std::string map = write_map(folder), file = folder.write("own.inc", kOwn);
  expect_refused({"run", map, "--robot-from", file + ":scuot"},
                 "own.inc: has no robot 'scuot'; did you mean 'scout'? Expected one of: scout");
  expect_refused({"run", map, "--robot-from", file},
                 "requires the name of a robot, as in FILE:NAME; expected one of: scout");
  expect_refused({"run", map, "--robot-from", folder.path("none.inc") + ":a"}, "none.inc: no such file");
  expect_refused({"run", map, "--robot-from", ""}, "expected FILE:NAME");
  expect_refused({"run", SF_SOURCE_DIR "/experiments/mapping.toml", "--robot-from", file + ":scout"},
                 "applies to worlds; a scenario sets `world`");
}

}  // namespace
}  // namespace sf
