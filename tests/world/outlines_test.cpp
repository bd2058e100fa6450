#include "world/outlines.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "tests/refusal.h"
#include "tests/world/read_world.h"
#include "world/near_part.h"
#include "world/wall_tree.h"

namespace sf::world {

namespace {

/// A file in the folder of this program.
std::string outlines_file(const std::string& text) {
  const std::string file = (std::filesystem::temp_directory_path() / "outlines.csv").string();
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

/// A world of that file, 3 m high unless the file says otherwise.
World town_of(const std::string& text, const std::string& pose = "0 0 0 0", bool leave = false) {
  LoadOptions options = kWithLasers;
  options.leave_outlines = leave;
  return read_world("model( outlines \"" + outlines_file(text) + "\" size [0 0 3] pose [" + pose + "] )", options);
}

std::string outline_refusal(const std::string& text) {
  const std::string all = sf::refusal_of([&] { town_of(text); });
  return all.substr(std::min(all.size(), all.find("outlines.csv")));
}

double solid_area_of(const World& world) {
  double area = 0.0;
  for (const Segment& wall : world.walls) area += 0.5 * base::cross(wall.a, wall.b);
  return area;
}

TEST(Outlines, APolygonIsASolidOfItsHeight) {
  for (const char* ring :
       {"0 0, 4 0, 4 2, 0 2, 0 0", "0 0, 0 2, 4 2, 4 0, 0 0", "0 0, 4 0, 4 2, 0 2"}) {  // any winding
    const World world = town_of("POLYGON ((" + std::string(ring) + "))");
    ASSERT_EQ(world.walls.size(), 4u) << ring;
    EXPECT_EQ(solid_area_of(world), 8.0) << ring;
    for (const Segment& wall : world.walls) {
      EXPECT_TRUE(wall.solid_left && wall.seen_by_laser && wall.stops_robots);
      EXPECT_EQ(wall.z_min, 0.0);
      EXPECT_EQ(wall.z_max, 3.0);
    }
  }
}

TEST(Outlines, InnerRingsAreHoles) {  // courtyards: inside is free
  const World world = town_of("POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (3 3, 6 3, 6 6, 3 6, 3 3))");
  ASSERT_EQ(world.walls.size(), 8u);
  EXPECT_EQ(solid_area_of(world), 72.0);
  EXPECT_EQ(winding_number(world.walls, {1, 1}), 1);
  EXPECT_EQ(winding_number(world.walls, {4, 4}), 0);
  for (std::size_t i = 5; i < 8; ++i) EXPECT_EQ(world.walls[i].a, world.walls[i - 1].b) << "a hole is one line";
}

TEST(Outlines, AHoleInARingWithoutSidesHasNoneEither) {
  const World world = town_of("POLYGON ((0 0, 9 9, 9 0, 0 9, 0 0), (1 4, 2 4, 2 5, 1 5, 1 4))");
  ASSERT_EQ(world.walls.size(), 8u);
  for (const Segment& wall : world.walls) EXPECT_FALSE(wall.solid_left);
}

TEST(Outlines, EveryPartOfAGeometry) {
  EXPECT_EQ(town_of("MULTIPOLYGON (((0 0, 1 0, 0 1)), ((5 5, 6 5, 5 6), (5.1 5.1, 5.2 5.1, 5.1 5.2)))").walls.size(),
            9u);
  EXPECT_EQ(town_of("LINESTRING (0 0, 1 0, 1 1)").walls.size(), 2u);
  EXPECT_EQ(town_of("multilinestring((0 0,1 0),(2 0,3 0,4 0))").walls.size(), 3u);
  EXPECT_EQ(town_of("POLYGON EMPTY\nLINESTRING Z EMPTY").walls.size(), 0u);
  EXPECT_EQ(town_of("LINESTRING (0 0, 0 0, 1 0)").walls.size(), 1u);  // a step of no length is no wall
  EXPECT_EQ(town_of("LINESTRING (0 0)").walls.size(), 0u);
  EXPECT_FALSE(town_of("LINESTRING (0 0, 1 0)").walls[0].solid_left);
}

TEST(Outlines, CoordinatesBeyondThePlaneAreIgnored) {
  for (const char* text :
       {"LINESTRING Z (0 0 7, 1 0 8)", "LINESTRING ZM(0 0 7 1,1 0 8 2)", "LINESTRING (0 0 7, 1 0)"}) {
    const World world = town_of(text);
    ASSERT_EQ(world.walls.size(), 1u) << text;
    EXPECT_EQ(world.walls[0].b, glm::dvec2(1, 0)) << text;
    EXPECT_EQ(world.walls[0].z_max, 3.0) << text;
  }
}

TEST(Outlines, ATableHasHeights) {  // as GDAL writes it
  const World world = town_of(
      "WKT,name,height\r\n"
      "\"POLYGON ((0 0,1 0,1 1,0 0))\",town hall,12.5\r\n"
      "\"LINESTRING (0 0,1 0)\",\"a \"\"fence\"\", green\",\r\n"
      "\"LINESTRING (0 0,2 0)\",fence,0\r\n");
  ASSERT_EQ(world.walls.size(), 5u);
  EXPECT_EQ(world.walls[0].z_max, 12.5);
  EXPECT_EQ(world.walls[3].z_max, 3.0) << "an empty field: the model's height";
  EXPECT_EQ(world.walls[4].z_max, 0.0);
  EXPECT_EQ(town_of("\xEF\xBB\xBFwkt\n\"LINESTRING (0 0, 1 0)\"").walls.size(), 1u) << "with a byte order mark";
}

TEST(Outlines, StandWhereTheirModelStands) {
  LoadOptions options = kWithLasers;
  const World world =
      read_world("unit_length \"cm\"\nmodel( outlines \"" + outlines_file("WKT,height\n\"LINESTRING (0 0,200 0)\",50") +
                     "\" size [0 0 100] pose [1000 0 20 90] laser_return 0 obstacle_return 0 )",
                 options);
  ASSERT_EQ(world.walls.size(), 1u);
  EXPECT_NEAR(world.walls[0].b.x, 10.0, 1e-12);
  EXPECT_NEAR(world.walls[0].b.y, 2.0, 1e-12);
  EXPECT_NEAR(world.walls[0].z_min, 0.2, 1e-12);
  EXPECT_NEAR(world.walls[0].z_max, 0.7, 1e-12);
  EXPECT_FALSE(world.walls[0].seen_by_laser || world.walls[0].stops_robots);
  EXPECT_EQ(world.models[world.walls[0].model].name, "model:0");
}

TEST(Outlines, FaultsAreRefusedWithTheirLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "outlines.csv: has no outlines"},
      {"\n  \n", "outlines.csv: has no outlines"},
      {"WKT,height\n", "outlines.csv: has no outlines"},
      {"LINESTRING (0 0, 1 0)\nPOINT (1 2)", "outlines.csv:2: 'POINT' has no walls; expected POLYGON"},
      {"(0 0, 1 0)",
       "outlines.csv:1: expected POLYGON, MULTIPOLYGON, LINESTRING or MULTILINESTRING, found '(0 0, 1 0)'"},
      {"LINESTRING (0 0, 1)", "outlines.csv:1: expected a finite number, found ')'"},
      {"LINESTRING (0 0, 1 nan)", "expected a finite number, found 'nan)'"},
      {"LINESTRING (0 0, 1 1e999)", "expected a finite number, found '1e999)'"},
      {"LINESTRING (0 0, 1 1", "expected ')', found the end of the line"},
      {"LINESTRING (0 0, 1 1) x", "expected the end of the geometry, found 'x'"},
      {"LINESTRING SOME (0 0, 1 1)", "expected '(' or EMPTY after LINESTRING, found 'SOME'"},
      {"POLYGON (0 0, 1 1)", "expected '(', found '0 0, 1 1)'"},
      {"LINESTRING (0 0, 1e8 0)", "a corner is 1e+08 m from the origin"},
      {"WKT,height\n\"LINESTRING (0 0,1 0)\",high", "outlines.csv:2: the height is 'high'; expected a number"},
      {"WKT,height\n\"LINESTRING (0 0,1 0)\",-1", "outlines.csv:2: the height is '-1'"},
      {"{\"type\": \"FeatureCollection\"}", "expected POLYGON"},
  };
  for (const auto& [text, message] : cases) expect_in(message, outline_refusal(text));
}

TEST(Outlines, RingsOfTooManyCornersAreRefused) {  // the check for crossings is quadratic
  std::string ring = "POLYGON ((0 0";
  for (int i = 1; i <= 20'000; ++i) ring += "," + std::to_string(i) + " " + std::to_string(i % 2);
  expect_in("a ring of 20001 corners; at most 20000", outline_refusal(ring + "))"));
}

TEST(Outlines, AreForModelsThatStandAndHaveNothingElse) {
  const std::string outlines = "outlines \"" + outlines_file("LINESTRING (0 0, 1 0)") + "\"";
  EXPECT_EQ(error_of("position( " + outlines + " )"),
            "test.world:1: 'outlines' are for models that stand; give robots and tags a 'block'");
  for (const char* other : {"block( points 2 point[0] [0 0] point[1] [1 1] )", "boundary 1", "cliff_return 1"})
    expect_in("'outlines' are the whole body of a model", error_of("model( " + outlines + " " + other + " )"));
  expect_in("test.world:1: cannot find the outlines \"none.csv\"; expected them beside this file",
            error_of("model( outlines \"none.csv\" )"));
  expect_in("1: 'model' has outlines but no 'size': walls without a height of their own are 0.1 m high",
            warnings_of(read_world("model( " + outlines + " )")));
}

/// Houses at random places, some with courtyards, and fences.
std::string houses_at_random(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-100.0, 100.0), size(0.5, 6.0);
  std::string text;
  for (int i = 0; i < 200; ++i) {
    const double x = place(random), y = place(random), a = size(random), b = size(random);
    const auto box = [&](double s) {
      return fmt::format("({} {}, {} {}, {} {}, {} {})", x - s * a, y - s * b, x + s * a, y - s * b, x + s * a,
                         y + s * b, x - s * a, y + s * b);
    };
    text += i % 3 == 0   ? fmt::format("LINESTRING ({} {}, {} {})\n", x, y, x + a, y + b)
            : i % 3 == 1 ? "POLYGON (" + box(1.0) + "," + box(0.5) + ")\n"
                         : "POLYGON (" + box(1.0) + ")\n";
  }
  return text;
}

bool same_walls(const World& one, const World& other) {
  World a = one, b = other;
  update_extent_and_hash(a);
  update_extent_and_hash(b);
  return a.hash == b.hash && a.walls.size() == b.walls.size();
}

TEST(Outlines, LeftInTheirFileTheyCount) {  // in hash and extent, and they can be read later
  const World whole = town_of(houses_at_random(1), "3 4 0 30");
  World left = town_of(houses_at_random(1), "3 4 0 30", true);
  EXPECT_TRUE(left.walls.empty());
  EXPECT_EQ(left.hash, whole.hash);
  EXPECT_EQ(left.extent.x_min, whole.extent.x_min);
  EXPECT_EQ(left.extent.y_max, whole.extent.y_max);
  translate(left, 1e5, 0.0);
  EXPECT_NE(left.hash, whole.hash);
  read_unread(left);
  World moved = whole;
  translate(moved, 1e5, 0.0);
  EXPECT_EQ(left.walls.size(), moved.walls.size());
  EXPECT_NEAR(left.walls.back().b.x, moved.walls.back().b.x, 1e-9);
}

TEST(Outlines, ThePartReadIsThePartKept) {  // for any tile, by whichever way its walls come
  const std::string town =
      houses_at_random(2) + "LINESTRING (-90 -90, -50 -90)\n";  // the longest wall, far from most tiles
  const World whole = town_of(town), left = town_of(town, "0 0 0 0", true);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-120.0, 120.0), reach(0.0, 20.0);
  for (int i = 0; i < 100; ++i) {
    const base::Box tile = base::box_of({place(random), place(random)}, {place(random), place(random)});
    const double far = reach(random);
    World kept = whole, read = left;
    keep_near(kept, tile, far);
    keep_near(read, tile, far);
    EXPECT_TRUE(read.unread.empty());
    EXPECT_TRUE(same_walls(kept, read)) << kept.walls.size() << " and " << read.walls.size() << " walls";
    EXPECT_LT(kept.walls.size(), whole.walls.size());
  }
}

}  // namespace

}  // namespace sf::world
