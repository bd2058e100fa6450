// Files that request excessive resources are rejected before the work is done, with the limit in the message.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/folder.h"
#include "tests/world/read_world.h"
#include "world/stage/document.h"
#include "world/toml.h"

namespace sf::world {
namespace {

class HostileFiles : public FolderTest {
 protected:
  static std::string error(const std::string& file) {
    return sf::refusal_of([&] { load_world(file); });
  }
  void expect_error(const std::string& file, const std::string& says) const { expect_in(says, error(file)); }
};

const std::string kMap = "resolution: 0.05\norigin: [0, 0, 0]\n";

// Reading a device never ends, and opening a pipe without a writer blocks. Both are rejected.
TEST_F(HostileFiles, OnlyRegularFilesAreRead) {
  const std::string pipe = path("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& image : {std::string("/dev/zero"), pipe, folder_.string()}) {
    const std::string map = write("m.yaml", kMap + "image: " + image + "\n");
    expect_error(map, "m.yaml:3: 'image': " + image + ": a folder, a device or a pipe, not a file");
    expect_error(image, "not a file");
  }
  expect_error(write("m.yaml", kMap + "image: none.pgm\n"),
               "m.yaml:3: 'image': " + path("none.pgm") + ": no such file");
  expect_error(write("a.world", "model(\n bitmap \"/dev/zero\" )"), "a.world:2: cannot find the bitmap \"/dev/zero\"");
  expect_error(write("b.world", "\ninclude \"pipe\"\n"), "b.world:2: cannot find the include \"pipe\"");
}

/// `include "robots.inc"` in a user's world works in any folder, like `run worlds/cave.world`.
TEST_F(HostileFiles, IncludesAreFoundAmongTheInstalledWorlds) {
  const std::string world = write("own.world", "include \"shipped.inc\"\nposition( name \"mine\" )\n");
  expect_error(world, "and the installed worlds");
  std::filesystem::create_directories(path("data/worlds"));
  write("data/worlds/shipped.inc", "define wheels position( size [0.3 0.3 0.2] )\n");
  setenv("SENSORFARM_DATA", path("data").c_str(), 1);
  EXPECT_EQ(load_world(world).movers.size(), 1u);
  unsetenv("SENSORFARM_DATA");
}

TEST_F(HostileFiles, EmptyFileIsNotAWorld) {
  for (const char* name : {"a.world", "a.yaml"}) {
    expect_error(write(name, ""), "is empty");
    expect_error(write(name, " \n\t\r\n"), "only whitespace");
  }
  write("a.inc", "");
  expect_error(write("b.world", "include \"a.inc\"\n"), "a.inc: is empty");
  write("a.pgm", "");
  expect_error(write("m.yaml", kMap + "image: a.pgm\n"), "a.pgm: is empty");
}

TEST_F(HostileFiles, ReadErrorIsNotEndOfFile) {
  const std::string memory = "/proc/self/mem";  // a regular file whose first byte cannot be read
  if (!std::filesystem::exists(memory)) GTEST_SKIP() << "no /proc here";
  expect_error(memory, "cannot be read: ");
}

TEST_F(HostileFiles, CheckerboardIsNotAFloorPlan) {
  constexpr int kSide = 1200;  // 1.4 million cells, each with a boundary all around
  std::string pixels = fmt::format("P5 {0} {0} 255\n", kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) pixels += (x + y) % 2 == 0 ? '\0' : '\xff';
  write("board.pgm", pixels);
  expect_error(write("a.world", "model( size [1 1 1]\n bitmap \"board.pgm\" )"),
               "a.world:2: 'bitmap': " + path("board.pgm") + ": an outline of more than 2000000 straight pieces");
  expect_error(write("m.yaml", kMap + "image: board.pgm\n"), "m.yaml:3: 'image': ");
}

// A repeated plan takes no reading time, but as much memory as the first.
TEST_F(HostileFiles, ManyPlansAreBoundedTogether) {
  std::string pixels = "P5 300 300 255\n";
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 300; ++x) pixels += (x + y) % 2 == 0 ? '\0' : '\xff';
  write("board.pgm", pixels);
  std::string text = "define plan model( size [1 1 1] bitmap \"board.pgm\" )\n";
  for (int i = 0; i < 20; ++i) text += "plan()\n";
  expect_error(write("a.world", text), "segments; expected at most 2000000: leave out models");
}

TEST(HostileWorlds, ArcsOfTenThousandKilometresAreRejected) {
  std::string text = "path( pieces 20\n";
  for (int i = 0; i < 20; ++i) text += fmt::format("arc[{}] [1e7 360 1]\n", i);
  const std::string said = error_of(text + "left \"solid_white\" )");
  EXPECT_TRUE(said.starts_with("test.world:2: the world now has 7")) << said;
  EXPECT_NE(said.find("points of paint along paths; expected at most 4000000"), std::string::npos) << said;
}

// A mile of motorway ramp is a valid world.
TEST(HostileWorlds, ArcsOfRoadsAreAccepted) {
  EXPECT_EQ(error_of("path( pieces 1 arc[0] [1600 90 3.5] left \"solid_white\" right \"broken_white\" dash [3 9] )"),
            "");
}

TEST(HostileWorlds, ExcessiveDashesAreRejected) {
  EXPECT_EQ(error_of("path( pieces 1 straight[0] [300000 1]\nleft \"broken_white\" )"),
            "test.world:2: 'left' without a 'dash' gives more than 1000000 dashes; expected longer ones: dash "
            "[length gap]");
}

TEST(HostileWorlds, SamplesOfAllSensorsAreBoundedTogether) {
  std::string text = "define eye laser( samples 1000000 )\nposition(\n";
  EXPECT_EQ(error_of(text + "eye() )"), "");
  for (int i = 0; i < 11; ++i) text += "eye()\n";
  EXPECT_EQ(
      error_of(text + ")"),
      "test.world:1: the world now has 11000000 samples of sensors; expected at most 10000000: give fewer 'samples'");
}

TEST(HostileWorlds, OutlineSelfChecksAreBounded) {
  std::string text = "define big model( size [1 1 1] block( points 2000\n";
  for (int i = 0; i < 2000; ++i) text += fmt::format("point[{}] [{} {}]\n", i, i, i % 2);
  text += ") )\n";
  for (int i = 0; i < 51; ++i) text += "big()\n";
  EXPECT_NE(error_of(text).find("pairs of edges in blocks; expected at most 100000000"), std::string::npos);
}

// With a linear search, this number of keys in one model took minutes.
TEST(HostileWorlds, ManyKeysOfOneModelAreReadOnce) {
  std::string text = "path( pieces 10000\n";
  for (int i = 0; i < 10'000; ++i) text += fmt::format("straight[{}] [1 1]\n", i);
  EXPECT_EQ(read_world(text + ")").paths.at(0).pieces.size(), 10'000u);
  for (int i = 0; i < 100'000; ++i) text += fmt::format("x{} 1\n", i);
  const World world = read_world(text + ")");
  EXPECT_EQ(world.paths.at(0).pieces.size(), 10'000u);
  EXPECT_EQ(world.warnings.size(), 10'001u) << "so many, and that there are more";
  EXPECT_NE(world.warnings.back().message.find("more than 10000 warnings"), std::string::npos);
}

TEST(HostileWorlds, ManyModelsOfOneName) {
  std::string text;
  for (int i = 0; i < 5'000; ++i) text += "model( name \"a\" noblocks 1 )\n";
  const World world = read_world(text);
  EXPECT_EQ(world.models.back().name, "a#5000");
}

std::string toml_error(const std::string& text) {
  return sf::refusal_of([&] { parse_toml("f.toml", text); });
}

std::string repeated(const std::string& piece, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += piece;
  return text;
}

// Each part of a key is a table in a table. The recursive destruction of deep tables overflowed the stack.
TEST(HostileToml, KeysOfManyPartsAreRejected) {
  const std::string deep = repeated("a.", 150'000) + "a";
  const std::string says = "f.toml:2: nested too deeply: a key of more than 32 parts";
  for (const std::string& text : {"\n" + deep + " = 1", "\n[" + deep + "]", "\n[[" + deep + "]]",
                                  "\nx = { " + deep + " = 1 }", "\n" + repeated("\"a\" . ", 100) + "a = 1"})
    EXPECT_EQ(toml_error(text).substr(0, says.size()), says) << text.substr(0, 40);
  EXPECT_EQ(toml_error(repeated("a.", 30) + "a = 1"), "");
  EXPECT_NE(toml_error("[" + repeated("a.", 20) + "a]\n" + repeated("b.", 20) + "b = 1").find("nested too deeply"),
            std::string::npos);
}

TEST(HostileToml, DotsInTextsAndCommentsAreNotKeys) {
  const std::string points = repeated("x.", 100);
  EXPECT_EQ(toml_error("a = \"" + points + "\"\nb = '" + points + "'\n# " + points + "\nc = '''\n" + points +
                       "\n'''\nd = \"\"\"\n\\\"" + points + "\\\"\n\"\"\"\n"),
            "");
  EXPECT_EQ(toml_error("a = [" + repeated("1.5, ", 100) + "]"), "");
  EXPECT_NE(toml_error("a = \"" + points + "\nb = 1"), "") << "a text that is never closed";
}

TEST(HostileToml, NestedValuesAndLargeFiles) {
  EXPECT_NE(toml_error("a = " + repeated("[", 100'000)), "");
  EXPECT_NE(toml_error("a = " + repeated("{ a = ", 100'000)), "");
  EXPECT_NE(toml_error(repeated("#\n", 3 << 20)).find("larger than 4 MiB"), std::string::npos);
}

TEST_F(HostileFiles, EndlesslyNestedYamlIsRejected) {
  for (const char* bracket : {"[", "{", "- ", "? ", "a: {"}) {
    const std::string map = write("m.yaml", repeated(bracket, 100'000));
    EXPECT_NE(error(map), "") << bracket;
  }
  expect_error(write("m.yaml", kMap + "#" + std::string(2u << 20, 'x')), "larger than 1 MiB");
}

}  // namespace
}  // namespace sf::world
