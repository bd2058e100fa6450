#include "world/ros_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/files.h"
#include "tests/folder.h"
#include "tests/robots/scenes.h"
#include "tests/world/read_world.h"
#include "world/free_space.h"
#include "world/stage/build_world.h"
#include "world/wall_tree.h"

namespace sf::world {
namespace {

class RosMap : public FolderTest {
 protected:
  RosMap() { write("m.pgm", "P2 3 2 255\n0 128 255\n255 255 255\n"); }  // wall, unknown, free; a free row below
  World load(const std::string& yaml, const LoadOptions& options = {}) const {
    return load_world(write("m.yaml", yaml), options);
  }
  std::string error(const std::string& yaml) const {
    const std::string error = sf::refusal_of([&] { load(yaml); });
    return error.substr(std::min(error.size(), error.find("m.yaml")));
  }
  static double area(const World& world) {
    double sum = 0.0;
    for (const Segment& wall : world.walls) sum += base::cross(wall.a, wall.b) / 2;
    return sum;
  }
};

// Six pixels in RGBA: transparent black, black, transparent white, grey 89, white, and grey 10 of alpha 127.
const std::string kAlpha = base::read_text(SF_SOURCE_DIR "/tests/fuzz/picture/alpha.png");

const std::string kGood =
    "image: m.pgm\nresolution: 0.5\norigin: [10, 20, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

std::string with(const std::string& key, const std::string& instead) {
  std::string yaml = kGood;
  const auto at = yaml.find(key);
  yaml.replace(at, yaml.find('\n', at) - at, instead);
  return yaml;
}

TEST_F(RosMap, OriginIsTheLowerLeftCornerAndTheFirstRowIsTheTop) {
  const World world = load(kGood);
  ASSERT_EQ(world.walls.size(), 4u);
  EXPECT_DOUBLE_EQ(world.extent.x_min, 10.0);
  EXPECT_DOUBLE_EQ(world.extent.x_max, 10.5);
  EXPECT_DOUBLE_EQ(world.extent.y_min, 20.5);
  EXPECT_DOUBLE_EQ(world.extent.y_max, 21.0);
  EXPECT_NEAR(area(world), 0.25, 1e-12);
  EXPECT_EQ(world.walls[0].z_min, 0.0);
  EXPECT_EQ(world.walls[0].z_max, kMapWallHeight);
  EXPECT_TRUE(world.models.at(0).is_bitmap);
}

TEST_F(RosMap, UsesTheRequestedAccuracy) {
  LoadOptions options;
  options.accuracy = "skip2";
  EXPECT_EQ(load(kGood, options).accuracy.word, "skip2");
  EXPECT_EQ(load(kGood).accuracy.word, "");
}

TEST_F(RosMap, UnknownIsAWallOnlyOnRequest) {
  LoadOptions options;
  options.unknown_is_wall = true;
  EXPECT_NEAR(area(load(kGood, options)), 0.5, 1e-12);
}

/// Grey 205 is (255 - 205) / 255 = 0.19608 occupied: just above map_server's threshold of 0.196; 206 is below.
TEST_F(RosMap, Grey205IsUnknownAnd206IsFree) {
  const std::string yaml = "image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n";
  const auto known = [&](const std::string& greys, const std::string& more = "") {
    write("m.pgm", "P2 2 1 255\n" + greys + "\n");
    double sum = 0.0;
    for (const Segment& edge : known_free(load(yaml + more))) sum += base::cross(edge.a, edge.b) / 2;
    return sum;
  };
  EXPECT_NEAR(known("205 206"), 0.25, 1e-12);
  EXPECT_NEAR(known("254 206"), 0.5, 1e-12);
  EXPECT_NEAR(known("205 0"), 0.0, 1e-12) << "neither unknown nor a wall is known to be free";
  EXPECT_NEAR(known("205 254", "free_thresh: 0.25\n"), 0.5, 1e-12) << "as the file says";
}

/// The layout of Nav2's sandbox: an arena of 5 m with a pillar at the map's origin, in an unexplored area of 20 m.
void write_sandbox(const std::filesystem::path& folder) {
  std::string pixels(400 * 400, static_cast<char>(205));
  for (int row = 0; row < 400; ++row)
    for (int column = 0; column < 400; ++column) {
      const int x = column - 200, y = row - 200;  // of 5 cm
      if (std::max(std::abs(x), std::abs(y)) > 50) continue;
      const bool wall = std::max(std::abs(x), std::abs(y)) >= 49 || x * x + y * y < 16;
      pixels[static_cast<std::size_t>(row * 400 + column)] = static_cast<char>(wall ? 0 : 254);
    }
  std::ofstream(folder / "m.pgm", std::ios::binary) << "P5 400 400 255\n" << pixels;
}
constexpr const char* kSandbox =
    "image: m.pgm\nresolution: 0.05\norigin: [-10, -10, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: ";

TEST_F(RosMap, CopiesStartInsideTheKnownArena) {
  write_sandbox(folder_);
  for (const char* threshold : {"0.196", "0.25"})  // with the latter the unexplored area counts as free
    for (const Pose& start : {Pose{}, Pose{-7.0, 3.0, 0.0, 0.0}, Pose{1.0, 1.0, 0.0, 0.0}}) {
      if (threshold[3] == '5' && start.x < -5.0) continue;  // in an area that the file declares free
      World world = load(std::string(kSandbox) + threshold + "\n");
      scenes::add_create(world, start);
      update_extent_and_hash(world);
      clone_robots(world, 8, 1);
      ASSERT_EQ(world.movers.size(), 8u);
      for (const Mover& mover : world.movers) {
        EXPECT_LT(std::max(std::abs(mover.X_WM.x), std::abs(mover.X_WM.y)), 2.5) << start.x;
        EXPECT_EQ(PlaceCheck(world).problem(mover, mover.X_WM), "");
      }
    }
}

TEST_F(RosMap, ImpossiblePosesAreNamed) {
  write_sandbox(folder_);
  World world = load(std::string(kSandbox) + "0.196\n");
  scenes::add_create(world, {});
  update_extent_and_hash(world);
  const auto where = [&](double x, double y) { return PlaceCheck(world).problem(world.movers[0], {x, y, 0.0, 0.3}); };
  EXPECT_EQ(where(1, 1), "");
  EXPECT_EQ(where(0, 0), "within a wall");
  EXPECT_EQ(where(2.35, 1), "partly in a wall of 'map'");
  EXPECT_EQ(where(-6, 1), "in the unknown area of the map");
  EXPECT_EQ(where(-10.1, 1), "outside 'map'");
}

TEST_F(RosMap, KnownAreaTurnsWithTheMap) {
  const std::vector<Segment> known = known_free(load(with("origin", "origin: [10, 20, 1.5707963267948966]")));
  EXPECT_NE(winding_number(known, {9.25, 21.25}), 0) << "the pixel next to the unknown one";
  EXPECT_EQ(winding_number(known, {9.25, 20.75}), 0) << "the unknown one";
}

/// Degrees in a yaw in radians; centimetres, millimetres or pixels per metre in a resolution in metres.
TEST_F(RosMap, ProbableUnitMistakesAreWarnings) {
  const auto said = [&](const std::string& yaml) {
    const World world = load(yaml);
    return world.warnings.empty() ? "" : world.warnings[0].message;
  };
  EXPECT_EQ(said(with("origin", "origin: [10, 20, 90]")),
            "yaw of 'origin' is in radians, and 90 looks like degrees: write 1.5708 if it is");
  EXPECT_NE(said(with("origin", "origin: [10, 20, -45]")), "");
  EXPECT_EQ(said(with("origin", "origin: [10, 20, 6.2832]")), "") << "a whole turn";
  EXPECT_EQ(said(with("origin", "origin: [10, 20, -3.14]")), "");
  EXPECT_EQ(said(with("resolution", "resolution: 50")),
            "'resolution' is in metres per pixel, and 50 looks like another unit: write 0.05 if it is in millimetres, "
            "0.5 if in centimetres, or 0.02 if in pixels per metre");
  EXPECT_EQ(said(with("resolution", "resolution: 1")), "");
  EXPECT_NE(said(with("resolution", "resolution: 1.01")), "");
  EXPECT_EQ(load(with("resolution", "resolution: 5")).warnings[0].line, 2);
}

TEST_F(RosMap, PicturesAreNotIncludes) {
  write("house.yaml", kGood);
  write("house.pgm", "P2 1 1 255\n0\n");
  write("alone.PNG", "\x89PNG");
  const auto refusal = [&](const std::string& text) {
    const std::string error = sf::refusal_of([&] { build_world(path("w.world"), text); });
    return error.substr(std::min(error.size(), error.rfind("w.world")));
  };
  EXPECT_EQ(refusal("\ninclude \"house.pgm\"\n"),
            "w.world:2: \"house.pgm\" is a picture; expected the file of the ROS map: include \"house.yaml\"; or use "
            "it as a floor plan: model( bitmap \"house.pgm\" size [x y z] )");
  EXPECT_NE(refusal("include \"alone.PNG\"").find("expected the .yaml file of the ROS map, which names the picture"),
            std::string::npos);
  EXPECT_NE(refusal("include \"none.pgm\"").find("is a picture"), std::string::npos) << "whether it is there or not";
  EXPECT_EQ(refusal("include \"house.yaml\""), "");
}

/// Integers as in map_server, and every word of YAML.
TEST_F(RosMap, NegatedMapsAreBrightWhereTheyAreOccupied) {
  for (const char* yes :
       {"1", "2", "-1", "true", "True", "TRUE", "yes", "Yes", "YES", "on", "On", "y", "0x1", "+1", "010"}) {
    const World world = load(with("negate", std::string("negate: ") + yes));
    EXPECT_NEAR(area(world), 0.25 * 4, 1e-12) << yes;
    EXPECT_TRUE(world.warnings.empty()) << yes;
  }
  for (const char* no : {"0", "false", "False", "FALSE", "no", "No", "NO", "off", "n", "+0", "0x0", "00"})
    EXPECT_NEAR(area(load(with("negate", std::string("negate: ") + no))), 0.25, 1e-12) << no;
}

/// map_server rejects fractions, so they cause a warning.
TEST_F(RosMap, NegateMayBeAFraction) {
  for (const auto& [written, size] : std::map<std::string, double>{{"0.0", 0.25}, {"1.0", 1.0}, {"1e0", 1.0}}) {
    const World world = load(with("negate", "negate: " + written));
    EXPECT_NEAR(area(world), size, 1e-12) << written;
    ASSERT_EQ(world.warnings.size(), 1u) << written;
    EXPECT_EQ(world.warnings[0].line, 4) << written;
  }
  for (const char* bad : {".nan", ".inf", "[1]", "''", "~"})
    EXPECT_EQ(error(with("negate", std::string("negate: ") + bad)).substr(0, 9), "m.yaml:4:") << bad;
}

TEST_F(RosMap, ModesIgnoreCase) {
  for (const char* mode : {"trinary", "Trinary", "TRINARY"}) {
    const World world = load(kGood + "mode: " + mode + "\n");
    EXPECT_NEAR(area(world), 0.25, 1e-12) << mode;
    EXPECT_TRUE(world.warnings.empty()) << mode;
  }
  EXPECT_EQ(load(kGood + "mode: Scale\n").warnings.size(), 1u);
  EXPECT_EQ(load(kGood + "mode: RAW\n").warnings.size(), 1u);
}

/// Percentages: 66 and 100 are above 0.65, 20 is between the thresholds, 101 and 255 are unknown, 19 is free.
TEST_F(RosMap, RawPixelsArePercentages) {
  write("m.pgm", "P2 6 1 255\n66 100 20 101 255 19\n");
  const std::string yaml = with("negate", "negate: 1") + "mode: raw\n";
  const World world = load(yaml);
  EXPECT_NEAR(area(world), 0.5, 1e-12) << "'negate' has no meaning";
  EXPECT_NEAR(world.extent.x_max, 11.0, 1e-12);
  double sum = 0.0;
  for (const Segment& edge : known_free(world)) sum += base::cross(edge.a, edge.b) / 2;
  EXPECT_NEAR(sum, 0.25, 1e-12);
}

/// map_server averages alpha with the colours in mode trinary, of every picture that stores one: transparent black is
/// 0, opaque black 64, transparent white 191 (unknown), opaque grey 89 is 130 (unknown; without alpha it is a wall).
TEST_F(RosMap, AlphaIsAveragedInTrinaryMode) {
  write("a.png", kAlpha);
  const std::string yaml = with("image", "image: a.png");
  const World world = load(yaml);
  EXPECT_NEAR(area(world), 3 * 0.25, 1e-12) << "transparent black, black, and grey 10";
  ASSERT_EQ(world.warnings.size(), 1u);
  EXPECT_EQ(world.warnings[0].line, 1);
  EXPECT_NE(world.warnings[0].message.find("alpha affects 3 cells"), std::string::npos) << world.warnings[0].message;

  const World old = load(yaml + "transparent: unknown\n");
  EXPECT_NEAR(area(old), 2 * 0.25, 1e-12) << "black and grey 89";
  EXPECT_TRUE(old.warnings.empty());
  EXPECT_EQ(load(yaml + "transparent: averaged\n").hash, world.hash);
  EXPECT_EQ(error(yaml + "transparent: no\n").substr(0, 9), "m.yaml:7:");
}

/// In mode scale all pixels that are not opaque are unknown, as in Nav2.
TEST_F(RosMap, TransparentPixelsAreUnknownInModeScale) {
  write("a.png", kAlpha);
  EXPECT_NEAR(area(load(with("image", "image: a.png") + "mode: scale\n")), 2 * 0.25, 1e-12) << "black and grey 89";
}

/// The mean of the colours is not rounded: (89 + 89 + 90) / 3 is 0.6497 occupied, while 89 would be 0.651.
TEST_F(RosMap, MeanOfTheColoursIsExact) {
  write("m.ppm", "P3 2 1 255\n89 89 90 89 89 89\n");
  EXPECT_NEAR(area(load(with("image", "image: m.ppm"))), 0.25, 1e-12);
}

/// A wall pixel among white ones, 3 x 2, in every format that a test can write by hand.
TEST_F(RosMap, PicturesOfEveryFormatAreTheSameMap) {
  const std::uint64_t hash = load(with("image", "image: m.pgm")).hash;
  const std::string white(3, '\xff'), black(3, '\0'), pad(3, '\0');  // rows of a BMP are padded to 4 bytes
  const std::string rows = white + white + white + pad + black + white + white + pad;  // the bottom row first
  const std::string bmp = std::string("BM") + std::string("\x4e\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0", 16) +
                          std::string("\3\0\0\0\2\0\0\0\1\0\x18\0", 12) + std::string(24, '\0') + rows;
  write("p1", "P1 3 2\n100 000");
  write("p2", "P2 3 2 1\n0 1 1\n1 1 1");
  write("p3", "P3 3 2 9\n0 0 0 9 9 9 9 9 9\n9 9 9 9 9 9 9 9 9");
  write("p4", std::string("P4 3 2\n\x80\0", 9));
  write("p5", std::string("P5 3 2 1\n\0\1\1\1\1\1", 15));
  write("p6", "P6 3 2 255\n" + black + white + white + white + white + white);
  write("bmp", bmp);
  for (const char* name : {"p1", "p2", "p3", "p4", "p5", "p6", "bmp"})
    EXPECT_EQ(load(with("image", std::string("image: ") + name)).hash, hash) << name;
}

TEST_F(RosMap, UnknownKeysAndRepeatedOnesAreWarnings) {
  const World world = load(kGood + "occupied_tresh: 0.9\nnegate: 1\n");
  EXPECT_NEAR(area(world), 0.25, 1e-12);
  ASSERT_EQ(world.warnings.size(), 2u);
  EXPECT_EQ(world.warnings[0].line, 7);
  EXPECT_EQ(world.warnings[0].message, "unknown key 'occupied_tresh' is ignored; did you mean 'occupied_thresh'?");
  EXPECT_EQ(world.warnings[1].message, "'negate' is given twice; the first one is used");
}

TEST_F(RosMap, WorldsOfOtherSimulatorsAreNamed) {
  const auto says = [&](const std::string& yaml, const std::string& text) {
    EXPECT_NE(error(yaml).find(text), std::string::npos) << error(yaml);
  };
  says("properties: {}\nlayers:\n  - {name: a, map: one.yaml}\n  - {name: b, map: two.yaml}\n",
       "m.yaml:3: is a file of flatland");
  says("layers: [{map: one.yaml}, {map: two.yaml}]\n", "one of its layers: 'one.yaml', 'two.yaml';");
  says("layers: []\n", "flatland");
  says("models:\n  - name: turtlebot\n    model: turtlebot.yaml\n", "flatland; expected");
  says("bodies:\n  - name: base\n", "flatland (a model)");
  says("world:\n  height: 10\nrobot:\n  - kinematics: {name: diff}\n", "m.yaml:2: is a file of ir-sim");
  says("obstacle: [{shape: {name: circle}}]\n", "ir-sim");
  says("robots: 3\n", "'image' is missing");
}

TEST_F(RosMap, YawTurnsAboutTheOrigin) {
  const World world = load(with("origin", "origin: [10, 20, 1.5707963267948966]"));
  EXPECT_NEAR(world.extent.x_min, 9.0, 1e-12);
  EXPECT_NEAR(world.extent.x_max, 9.5, 1e-12);
  EXPECT_NEAR(world.extent.y_min, 20.0, 1e-12);
}

TEST_F(RosMap, ThresholdsAreStrict) {
  write("m.pgm", "P2 2 1 255\n51 50\n");  // 0.8 occupied, which is not above 0.8, and slightly more
  EXPECT_NEAR(area(load(with("occupied", "occupied_thresh: 0.8"))), 0.25, 1e-12);
}

TEST_F(RosMap, ScaleIsReadAsTrinaryWithAWarning) {
  const World world = load(kGood + "mode: scale\n");
  ASSERT_EQ(world.warnings.size(), 1u);
  EXPECT_EQ(world.warnings[0].line, 7);
  EXPECT_EQ(load(kGood + "mode: trinary\n").warnings.size(), 0u);
}

TEST_F(RosMap, DefaultsAreThoseOfMapServer) {
  EXPECT_EQ(load("image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n").walls.size(), 4u);
}

// A world file with the user's robot in a map: `include "m.yaml"`.
TEST_F(RosMap, WorldMayIncludeAMap) {
  const World map = load(kGood);
  const World world = load_world(write("mine.world",
                                       "model( name \"box\" size [0.1 0.1 1] pose [11 20.2 0 0] )\ninclude \"m.yaml\"\n"
                                       "position( name \"mine\" size [0.1 0.1 0.1] pose [10.7 20.3 0 0] )\n"));
  EXPECT_EQ(world.walls.size(), map.walls.size() + 4) << "the map's and the box'";
  for (const Segment& wall : map.walls)
    EXPECT_EQ(std::count_if(world.walls.begin(), world.walls.end(),
                            [&](const Segment& w) {
                              return w.a == wall.a && w.b == wall.b && world.models.at(w.model).type == "map";
                            }),
              1);
  ASSERT_EQ(world.movers.size(), 1u);
  EXPECT_EQ(world.movers[0].name, "mine");
  EXPECT_EQ(known_free(world).size(), known_free(map).size()) << "free places are those of the map";
  EXPECT_EQ(warnings_of(world), "") << "it starts in known free space";
}

TEST_F(RosMap, WorldIncludesAtMostOneMap) {
  write("m.yaml", kGood);
  const auto error_of_text = [&](const std::string& text) {
    return sf::refusal_of([&] { load_world(write("two.world", text)); }).substr(path("").size());
  };
  EXPECT_EQ(error_of_text("include \"m.yaml\"\ninclude \"m.yaml\"\n"),
            "two.world:2: a second ROS map; expected one per world");
  write("m.yaml", "image: none.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n");
  EXPECT_EQ(error_of_text("include \"m.yaml\"\n").substr(0, 17), "m.yaml:1: 'image'") << "the map's own file and line";
}

// Cells of half a metre: wall, unknown, free; three free ones below. Origin (10, 20).
TEST_F(RosMap, KnownSpaceIsAllButUnknownCells) {
  const KnownSpace known(load(kGood));
  EXPECT_TRUE(known.contains({10.25, 20.75})) << "a wall is known";
  EXPECT_FALSE(known.contains({10.75, 20.75})) << "unknown";
  EXPECT_TRUE(known.contains({11.25, 20.75}));
  EXPECT_TRUE(known.contains({10.75, 20.25}));
  EXPECT_TRUE(known.contains({10.0, 20.0})) << "its lower left corner";
  for (const glm::dvec2& outside : {glm::dvec2{9.99, 20.25}, {11.5, 20.25}, {10.25, 19.99}, {10.25, 21.0}})
    EXPECT_FALSE(known.contains(outside)) << outside.x << " " << outside.y;
  EXPECT_FALSE(known.contains({std::nan(""), 20.25}));
}

TEST_F(RosMap, KnownSpaceTurnsWithItsOrigin) {
  const KnownSpace known(load(with("origin", "origin: [10, 20, 1.5707963267948966]")));
  EXPECT_FALSE(known.contains({9.25, 20.75})) << "the unknown cell, a quarter turn on";
  EXPECT_TRUE(known.contains({9.75, 20.75}));
}

TEST_F(RosMap, WithoutAMapEverythingIsKnown) { EXPECT_TRUE(KnownSpace(World{}).contains({1e9, 0.0})); }

TEST_F(RosMap, BadMapsAreRejectedWithTheirLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"image: none.pgm", "m.yaml:1:"},       {"resolution: 0", "m.yaml:2:"},
      {"resolution: fine", "m.yaml:2:"},      {"resolution: .nan", "m.yaml:2:"},
      {"origin: [1, 2]", "m.yaml:3:"},        {"origin: [1, 2, x]", "m.yaml:3:"},
      {"origin: [1e300, 2, 0]", "m.yaml:3:"}, {"origin: [.nan, 2, 0]", "m.yaml:3:"},
      {"origin: [1, .nan, 0]", "m.yaml:3:"},  {"origin: [1, 2, .nan]", "m.yaml:3:"},
      {"origin: [-.inf, 2, 0]", "m.yaml:3:"}, {"origin: [1, 2, .inf]", "m.yaml:3:"},
      {"negate: maybe", "m.yaml:4:"},         {"occupied_thresh: 2", "m.yaml:5:"},
      {"occupied_thresh: .nan", "m.yaml:5:"}, {"free_thresh: 0.9", "m.yaml:6:"},
      {"free_thresh: -0.1", "m.yaml:6:"}};
  for (const auto& [line, place] : cases) {
    const std::string text(line);
    EXPECT_EQ(error(with(text.substr(0, text.find(':')), text)).substr(0, 9), place) << text;
  }
  EXPECT_NE(error(with("image", "picture: m.pgm")).find("'image' is missing"), std::string::npos);
  EXPECT_EQ(error(kGood + "mode: grey\n").substr(0, 9), "m.yaml:7:");
  EXPECT_NE(error("a: [1").find("not YAML"), std::string::npos);
  EXPECT_NE(error("- 1\n- 2\n").find("expected the YAML of a ROS map"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
