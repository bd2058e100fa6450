#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/folder.h"
#include "tests/world/read_world.h"

namespace sf::world {
namespace {

struct Bad {
  const char* reason;
  std::string text;
  int line;
  const char* says;
};

// One error each, with the line that the user has to correct.
const std::vector<Bad>& corpus() {
  static const std::vector<Bad> cases = {
      {"string without end", "name \"x\nmodel()", 1, "closing quote"},
      {"string without end at the end of the file", "\n\nname \"x", 3, "closing quote"},
      {"parenthesis without end", "model(\n pose [0 0 0 0]\n", 1, "never closed"},
      {"parenthesis that closes nothing", "model()\n)", 2, "no matching '('"},
      {"tuple without end", "model(\n size [1 2", 2, "never closed"},
      {"tuple that holds a parenthesis", "model(\n size [1 2 )", 2, "tuple of 'size'"},
      {"tuple with a wrong line", "model(\n size [1 2\n ) ]", 3, "tuple of 'size'"},
      {"commas in a tuple", "model( size [1, 2] )", 1, "blanks"},
      {"stray character", "model( size ; )", 1, "unexpected ';'"},
      {"zero byte", std::string("model(\n\0)", 9), 2, "\\x00"},
      {"half a number", "model(\n size [1x 2 3] )", 2, "not a number"},
      {"infinite number", "model( size [1e999 2 3] )", 1, "not a number"},
      {"not a number", "model( size [-nan 2 3] )", 1, "not a number"},
      {"infinity by name", "model( pose [infinity 0 0 0] )", 1, "found 'infinity'"},
      {"a hexadecimal number", "model( pose [0x10 0 0 0] )", 1, "not a number"},
      {"two dots", "model( size [1.2.3 2 3] )", 1, "not a number"},
      {"property without value", "model(\n size\n color \"red\" )", 2, "requires a value"},
      {"property at the end", "name", 1, "requires a value"},
      {"number where a property belongs", "model( 3 )", 1, "expected a property"},
      {"string at the top", "\"x\"", 1, "expected include"},
      {"pose too short", "model(\n pose [1 2] )", 2, "[x y z yaw]"},
      {"tag_pose too short", "model( name \"tag1\"\n tag_pose [1 2] )", 2, "[x y z yaw]"},
      {"tag_pose that is no tuple", "model( name \"tag1\" tag_pose 1 )", 1, "expects a tuple"},
      {"tag_pose of words", "model( name \"tag1\" tag_pose [\"up\" 0 0 0] )", 1, "expects a tuple of numbers"},
      {"tag_pose out of reach", "model( name \"tag1\"\n tag_pose [80 80 0 0] )", 2, "within 100 m"},
      {"size too short", "model( size [1] )", 1, "[x y z]"},
      {"size that is no tuple", "model( size 1 )", 1, "expects a tuple"},
      {"size of words", "model( size [\"a\" \"b\" \"c\"] )", 1, "tuple of numbers"},
      {"number as a name", "model( name 3 )", 1, "expects a \"string\""},
      {"text as a number", "model( boundary \"yes\" )", 1, "one number"},
      {"missing include", "\ninclude \"nowhere.inc\"", 2, "nowhere.inc"},
      {"include without a name", "include 3", 1, "include \"file\""},
      {"missing bitmap", "model(\n bitmap \"nowhere.png\" )", 2, "nowhere.png"},
      {"bitmap without area", "model( size [0 1 1] bitmap \"bitmaps/cave.png\" )", 1, "above zero"},
      {"define without a body", "define a model\nmodel()", 1, "expected '('"},
      {"define without a base", "define a (", 1, "define NEW-NAME"},
      {"define of itself", "\ndefine a a( )", 2, "defined in terms of itself"},
      {"block without points", "model(\n block( z [0 1] ) )", 2, "'points' is missing"},
      {"block with half a point", "model( block( points 2.5 ) )", 1, "whole number"},
      {"robot that cannot move", "position( velocity_bounds [0 0] )", 1,
       "xmax of 'velocity_bounds' is 0; expected more"},
      {"unknown drive", "position( drive \"legs\" )", 1, "\"diff\", \"omni\", \"car\" or \"skid\""},
      {"robot that never speeds up", "position(\n acceleration_bounds [0 0 0 0 0 0 -90 90] )", 2,
       "xmax of 'acceleration_bounds'"},
      {"robot that never turns faster", "position( acceleration_bounds [-1 1 0 0 0 0 -90 0] )", 1,
       "amax of 'acceleration_bounds'"},
      {"acceleration of one number", "position( acceleration_bounds [1] )", 1, "[xmin xmax"},
      {"no track", "position(\n track 0 )", 2, "'track' is 0 m; expected more than 0"},
      {"unknown command law", "position( command_law \"other\" )", 1, "\"direct\" or \"player_create\""},
      {"unknown dynamics", "position(\n dynamics \"boat\" )", 2, "\"car\" or a plug-in's file"},
      {"dynamics without a name", "position( dynamics \"\" )", 1, "expects one text"},
      {"dynamics with a word", "position( dynamics \"car fast\" )", 1, "'fast' in 'dynamics': expected a setting"},
      {"dynamics with a setting twice", "position( dynamics \"car mass=1 mass=2\" )", 1, "gives 'mass' twice"},
      {"dynamics of a tag", "model( name \"tag1\"\n dynamics \"car\" )", 2, "is not a robot"},
      {"dynamics under the Create's driver", "position( command_law \"player_create\"\n dynamics \"car\" )", 2,
       "leave it or 'dynamics' out"},
      {"dynamics that vary", "position( random_slip 0.1 dynamics \"car\" )", 1, "leave 'random_slip'"},
      {"light without a plan", "\nlight( )", 2, "a light requires 'phases'"},
      {"light that lacks a phase", "light( phases 2\n phase[0] [\"red\" 1] )", 1, "'phase[1]' is missing"},
      {"phase without a time", "light( phases 1\n phase[0] [\"red\"] )", 2, "[\"state\" seconds]"},
      {"phase turned round", "light( phases 1\n phase[0] [1 \"red\"] )", 2, "[\"state\" seconds]"},
      {"phase of no time", "light( phases 1\n phase[0] [\"red\" 0] )", 2, "more than 0"},
      {"phase without an end", "light( phases 1\n phase[0] [\"red\" 1e7] )", 2, "more than 0"},
      {"unknown state", "light( phases 1\n phase[0] [\"amber\" 1] )", 2, "\"flashing yellow\""},
      {"two lamps", "light( phases 1 phase[0] [\"red\" 1]\n lamps 2 )", 2, "1 or 3"},
      {"stop line that is no way-point", "light( phases 1 phase[0] [\"red\" 1]\n stop_lines \"1.2\" )", 2, "'1.2'"},
      {"stop line with more behind it", "light( phases 1 phase[0] [\"red\" 1]\n stop_lines \"1.2.3.4\" )", 2,
       "'1.2.3.4'"},
      {"stop line with a sign", "light( phases 1 phase[0] [\"red\" 1]\n stop_lines \"1.-2.3\" )", 2, "'1.-2.3'"},
      {"stop line of segment 0", "light( phases 1 phase[0] [\"red\" 1]\n stop_lines \"0.2.3\" )", 2, "'0.2.3'"},
      {"stop line of point 0", "light( phases 1 phase[0] [\"red\" 1]\n stop_lines \"1.2.0\" )", 2, "'1.2.0'"},
      {"stop line of a number too large", "light( phases 1 phase[0] [\"red\" 1]\n stop_lines \"1.32769.3\" )", 2,
       "'1.32769.3'"},
      {"light on a robot", "position(\n light( phases 1 phase[0] [\"red\" 1] ) )", 2, "cannot move"},
      {"unknown emitter", "model(\n ir_emitter \"torch\" )", 2, "\"virtual_wall\" or \"dock\""},
      {"emitter on a robot", "position(\n ir_emitter \"dock\" )", 2, "cannot move"},
      {"hole in a robot", "position(\n cliff_return 1 )", 2, "cannot move"},
      {"hole that is a line", "model(\n cliff_return 1 block( points 2 point[0] [0 0] point[1] [1 0] ) )", 2,
       "at least three corners"},
      {"hole that crosses itself",
       "model(\n cliff_return 1 block( points 4 point[0] [0 0] point[1] [1 1] point[2] [1 0] point[3] [0 1] ) )", 2,
       "cross themselves"},
      {"hole from a picture", "model( bitmap \"bitmaps/cave.png\"\n cliff_return 1 )", 2, "neither a bitmap"},
      {"hole with a rim", "model( boundary 1\n cliff_return 1 )", 2, "neither a bitmap"},
      {"two robots of one number", "position( name \"roomba1\" )\nposition( name \"pioneer1\" )", 2, "robot 1"},
      {"two tags of one number", "model( name \"tag4\" )\nmodel( model( name \"tag4\" ) )", 2, "tag 4"},
      {"unknown unit of length", "unit_length \"ft\"", 1, "\"m\", \"cm\" or \"mm\""},
      {"unknown unit of angle", "unit_angle \"grad\"", 1, "degrees"},
  };
  return cases;
}

TEST(BadInput, ReportsLineAndExpectedInput) {
  for (const Bad& bad : corpus()) {
    const std::string error = error_of(bad.text);
    EXPECT_TRUE(error.starts_with(fmt::format("test.world:{}: ", bad.line))) << bad.reason << ": " << error;
    EXPECT_NE(error.find(bad.says), std::string::npos) << bad.reason << ": " << error;
  }
}

TEST(BadInput, DeepNestingIsRejectedWithoutStackOverflow) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += "model(";
  EXPECT_NE(error_of(text).find("nested deeper"), std::string::npos);
}

TEST(BadInput, NestingThroughMacrosCountsToo) {
  std::string text = "define a0 model()\n";
  for (int i = 1; i < 200; ++i) text += fmt::format("define a{} model( a{}() )\n", i, i - 1);
  EXPECT_NE(error_of(text).find("nested deeper"), std::string::npos);
}

TEST(BadInput, MacrosThatDoubleEachTimeAreRejected) {
  std::string text = "define a0 model( size [1 1 1] )\n";
  for (int i = 1; i < 60; ++i) {
    text += fmt::format("define a{0} model( a{1}() a{1}() )\n", i, i - 1);
  }
  EXPECT_NE(error_of(text).find("expand to more than"), std::string::npos);
}

class Files : public FolderTest {
 protected:
  static std::string error(const std::string& file) {
    return sf::refusal_of([&] { load_world(file); });
  }
};

TEST_F(Files, MissingFileIsReported) { EXPECT_NE(error(path("none.world")).find("no such file"), std::string::npos); }

TEST_F(Files, FolderIsNotAWorld) { EXPECT_NE(error(folder_.string()).find("not a file"), std::string::npos); }

TEST_F(Files, IncludeCycleIsReportedInFull) {
  const std::string a = write("a.world", "include \"b.inc\"\n");
  write("b.inc", "\ninclude \"c.inc\"\n");
  write("c.inc", "include \"a.world\"\n");
  const std::string text = error(a);
  EXPECT_NE(text.find("c.inc:1: this include is circular"), std::string::npos) << text;
  EXPECT_LT(text.find("b.inc ->"), text.find("c.inc ->")) << text;
}

TEST_F(Files, IncludesThatDoubleEachTimeAreRejected) {
  const std::string a = write("f0.world", "include \"f1.inc\"\ninclude \"f1.inc\"\n");
  for (int i = 1; i < 30; ++i) {
    write(fmt::format("f{}.inc", i), fmt::format("include \"f{0}.inc\"\ninclude \"f{0}.inc\"\n", i + 1));
  }
  write("f30.inc", "# the last\n");
  EXPECT_NE(error(a).find("includes"), std::string::npos);
}

TEST_F(Files, ErrorInAnIncludeNamesTheInclude) {
  const std::string a = write("a.world", "include \"b.inc\"\nthing()");
  write("b.inc", "define thing model(\n size [1 )\n");
  EXPECT_NE(error(a).find("b.inc:2: "), std::string::npos);
}

TEST_F(Files, BrokenPictureIsNamed) {
  write("x.png", "\x89PNG\r\n\x1a\n and then nothing");
  EXPECT_NE(error(write("a.world", "model( bitmap \"x.png\" )")).find("corrupt PNG"), std::string::npos);
  write("y.pgm", "P5 3 3 255\nabc");
  EXPECT_NE(error(write("b.world", "model( bitmap \"y.pgm\" )")).find("fewer pixels"), std::string::npos);
  write("z.pgm", "P2 20000 1 255\n0");
  EXPECT_NE(error(write("c.world", "model( bitmap \"z.pgm\" )")).find("20000 x 1"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
