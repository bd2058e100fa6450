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

/// Writes a file in the folder of this program.
std::string outlines_file(const std::string& text) {
  const std::string file = (std::filesystem::temp_directory_path() / "outlines.csv").string();
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

/// Loads a world of that file, 3 m high unless the file has a height.
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

TEST(Outlines, PolygonIsASolidOfItsHeight) {
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

TEST(Outlines, HoleInARingWithoutSidesHasNoSidesEither) {
  const World world = town_of("POLYGON ((0 0, 9 9, 9 0, 0 9, 0 0), (1 4, 2 4, 2 5, 1 5, 1 4))");
  ASSERT_EQ(world.walls.size(), 8u);
  for (const Segment& wall : world.walls) EXPECT_FALSE(wall.solid_left);
}

TEST(Outlines, HoleThatLeavesItsRingHasNoSides) {  // it would swap inside and outside
  const std::string square = "POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), ", hole = ", (1 1, 2 1, 2 2, 1 1))";
  for (const char* stray :
       {"(11 3, 12 3, 12 4, 11 3)", "(8 3, 12 3, 12 4, 8 3)", "(-1 -1, 10 -1, 10 10, -1 10, -1 -1)"}) {
    const World world = town_of(square + stray + hole);
    for (std::size_t i = 0; i < world.walls.size(); ++i)
      EXPECT_EQ(world.walls[i].solid_left, i < 4 || i + 3 >= world.walls.size()) << stray << " wall " << i;
    expect_in("1: an inner ring leaves its outer ring: its walls are thin", warnings_of(world));
  }
  for (const char* touching : {"(0 3, 1 3, 1 4, 0 3)", "(0 0, 3 1, 1 3, 0 0)", "(-1e-9 3, 1 3, 1 4, -1e-9 3)"}) {
    const World world = town_of(square + touching + hole);
    EXPECT_TRUE(world.walls[5].solid_left) << touching;
    EXPECT_EQ(warnings_of(world), "") << touching;
  }
}

TEST(Outlines, EveryPartOfAGeometryIsRead) {
  EXPECT_EQ(town_of("MULTIPOLYGON (((0 0, 1 0, 0 1)), ((5 5, 6 5, 5 6), (5.1 5.1, 5.2 5.1, 5.1 5.2)))").walls.size(),
            9u);
  EXPECT_EQ(town_of("LINESTRING (0 0, 1 0, 1 1)").walls.size(), 2u);
  EXPECT_EQ(town_of("multilinestring((0 0,1 0),(2 0,3 0,4 0))").walls.size(), 3u);
  EXPECT_EQ(town_of("LINESTRING (0 0, 0 0, 1 0)").walls.size(), 1u);  // a step of length zero is not a wall
  EXPECT_EQ(town_of("LINESTRING (0 0)\nLINESTRING (0 0, 1 0)").walls.size(), 1u);
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

TEST(Outlines, TableHasHeights) {  // as written by GDAL
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

TEST(Outlines, ArePlacedWithTheirModel) {
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

/// Returns the warnings of a file with a valid wall before the given rows: "2: ...".
std::string faults_of(const std::string& rows, const std::string& first = "\"LINESTRING (0 0,1 0)\"") {
  const World world = town_of(first + "\n" + rows);
  EXPECT_EQ(world.walls.front().b, glm::dvec2(1, 0));
  return warnings_of(world);
}

TEST(Outlines, UnreadableRowIsSkippedWithItsLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"POINT (1 2)", "2: points have no walls: left out\n"},
      {"(0 0, 1 0)", "2: expected POLYGON, MULTIPOLYGON, LINESTRING or MULTILINESTRING, found '(0 0': left out\n"},
      {"LINESTRING (0 0, 1)", "2: expected a finite number, found ')': left out\n"},
      {"LINESTRING (0 0, 1 nan)", "expected a finite number, found 'nan)'"},
      {"LINESTRING (0 0, 1 -inf)", "expected a finite number, found '-inf)'"},
      {"LINESTRING (0 0, 1 1e999)", "expected a finite number, found '1e999)'"},
      {"LINESTRING (0 0, 1 2-3)", "expected a finite number, found '2-3)'"},
      {"LINESTRING (0 0 1 1 2 2)", "expected ')', found '2 2)'"},  // missing commas
      {"LINESTRING (0 0, 1 1", "expected ')', found the end of the text"},
      {"LINESTRING (0 0, 1 1) x", "expected the end of the geometry, found 'x'"},
      {"LINESTRING SOME (0 0, 1 1)", "expected '(' or EMPTY after LINESTRING, found 'SOME (0 0'"},
      {"POLYGON (0 0, 1 1)", "expected '(', found '0 0, 1 1)'"},
      {"POLYGON (EMPTY, (0 0, 1 0, 1 1))", "expected an outer ring with points before inner ones"},
      {"POLYGON EMPTY", "2: the geometry is EMPTY: left out\n"},
      {"POLYGON ((5 5, 5 5, 5 5))", "2: the geometry has no extent: left out\n"},
      {"LINESTRING (0 0, 1e8 0)", "2: a corner is 1e+08 m from the origin"},
      {"TIN (((0 0 0, 1 0 0, 1 1 1, 0 0 0)))", "2: faces in three dimensions have no outline"},
      {"CIRCULARSTRING (0 0, 1 1)", "expected an odd number of points in a CIRCULARSTRING"},
      {"COMPOUNDCURVE (COMPOUNDCURVE ((0 0, 1 1)))", "expected a line or arcs in a COMPOUNDCURVE"},
      {"CURVEPOLYGON (POLYGON ((0 0, 1 1, 1 0)))", "expected a line, arcs or a COMPOUNDCURVE"},
  };
  for (const auto& [text, message] : cases) expect_in(message, faults_of(text));
  const auto nested = [](int collections) {
    std::string text;
    for (int i = 0; i < collections; ++i) text += "GEOMETRYCOLLECTION (";
    return text + "LINESTRING (0 0, 1 0)" + std::string(static_cast<std::size_t>(collections), ')');
  };
  EXPECT_EQ(faults_of(nested(32)), "") << "the limit";
  expect_in("2: collections within 32 collections", faults_of(nested(33)));
  EXPECT_EQ(faults_of("LINESTRING (0 0, 1e7 0)"), "") << "the limit";
  expect_in("a corner is 1.00001e+07 m from", faults_of("LINESTRING (0 0, 0 -10000100)"));
}

TEST(Outlines, UnreadableHeightBecomesThatOfTheModel) {
  for (const char* height :
       {"12 m", "\"3,5\"", "5e70", "1e999", "-1", "nan", "inf", "10000001", "-1e-300", "high", "0x10", "12'6\""}) {
    const World world =
        town_of("WKT,height\n\"LINESTRING (0 0,1 0)\",9\n\"LINESTRING (0 0,2 0)\"," + std::string(height));
    ASSERT_EQ(world.walls.size(), 2u) << height;
    EXPECT_EQ(world.walls[0].z_max, 9.0) << height;
    EXPECT_EQ(world.walls[1].z_max, 3.0) << height;
    expect_in("3: the height is '", warnings_of(world));
  }
  EXPECT_EQ(town_of("WKT,height\n\"LINESTRING (0 0,1 0)\",1e7").walls[0].z_max, 1e7) << "the limit";
  for (const char* height : {"+7", " 7 ", "7.", "\"7\"", "7e0"}) {
    const World world = town_of("WKT,height\n\"LINESTRING (0 0,1 0)\"," + std::string(height));
    EXPECT_EQ(world.walls[0].z_max, 7.0) << height;
    EXPECT_TRUE(world.warnings.empty()) << height;
  }
}

TEST(Outlines, WarningsAreFew) {  // the others are counted, so none is lost
  std::string rows;
  for (int i = 0; i < 1000; ++i) rows += "LINESTRING (0 0\nPOINT (0 0)\nPOLYGON EMPTY\n";
  const std::string warnings = faults_of(rows);
  EXPECT_EQ(std::count(warnings.begin(), warnings.end(), '\n'), 3 * 4) << warnings;
  expect_in("8: expected ')'", warnings);
  expect_in("0: 997 more rows cannot be read and are left out\n", warnings);
  expect_in("0: 997 more rows have points, which are left out\n", warnings);
  expect_in("0: 997 more rows have no geometry and are left out\n", warnings);
}

TEST(Outlines, WarningsAreReportedOnceForSeveralReads) {  // a file is read for the extent, the hash and its walls
  const std::string text = "LINESTRING (0 0, 1 0)\nPOINT (0 0)\n";
  World left = town_of(text, "0 0 0 0", true);
  EXPECT_EQ(warnings_of(left), warnings_of(town_of(text)));
  EXPECT_EQ(left.warnings.size(), 1u);
  translate(left, 1.0, 0.0);
  read_unread(left);
  EXPECT_EQ(left.warnings.size(), 1u);
}

TEST(Outlines, FirstFaultIsAnErrorInStrictMode) {  // as in versions that did not skip rows
  LoadOptions strict = kWithLasers;
  strict.strict = true;
  const std::pair<const char*, const char*> cases[] = {
      {"POINT (1 2),", "points have no walls"},
      {"LINESTRING (0 0, 2 0),x", "the height is 'x'; expected a number alone, such as 3.5, from 0 to 1e+07"},
      {"POLYGON EMPTY,x", "the geometry is EMPTY"},
      {"\"POLYGON ((0 0, 3 0, 3 3), (4 4, 5 4, 5 5))\",", "an inner ring leaves its outer ring"}};
  for (const auto& [row, reason] : cases) {
    const std::string file = outlines_file("WKT,height\n\"LINESTRING (0 0, 1 0)\",\n" + std::string(row));
    EXPECT_EQ(sf::refusal_of([&] { read_world("model( outlines \"" + file + "\" size [0 0 3] )", strict); }),
              file + ":3: " + reason);
  }
  const std::string file = outlines_file("SRID=4326;LINESTRING (0 0, 1 0)");
  EXPECT_EQ(read_world("model( outlines \"" + file + "\" size [0 0 3] )", strict).warnings.size(), 1u)
      << "no row's fault";
}

TEST(Outlines, FileWithoutWallsIsAnErrorWithItsColumns) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "outlines.csv: the file has no outlines with walls; its first line does not name the columns; expected"},
      {"\n  \n", "outlines.csv: the file has no outlines"},
      {"id;name\n1;hall\n",
       "outlines.csv:2: has no geometry; the file has no outlines with walls; its columns are 'id', 'name'; "
       "expected"},
      {"WKT,height\n", "outlines.csv: the file has no outlines with walls; its columns are 'WKT', 'height'"},
      {"WKT,name\nPOINT (1 2),tree\n", "outlines.csv:2: points have no walls; the file has no outlines with walls"},
      {"POLYGON EMPTY", "outlines.csv:1: the geometry is EMPTY; the file"},
      {"LINESTRING (0 0, 0 0)", "outlines.csv:1: the geometry has no extent; the file has no outlines with walls"},
      {"W\0K\0T", "outlines.csv: the file has no outlines with walls; its columns are 'W'"},
      {"\xFF\xFEW", "outlines.csv: is UTF-16 text: save it as UTF-8"},
      {"\xFE\xFF", "outlines.csv: is UTF-16 text: save it as UTF-8"},
      {"PK\x03\x04", "outlines.csv: is a ZIP archive"},
      {"\x1F\x8B", "outlines.csv: is compressed"},
      {"<?xml ?>", "outlines.csv: is XML or HTML"},
      {"WKT\rPOINT (0 0)\r", "outlines.csv:1: a line ends in CR alone; convert"},
  };
  for (const auto& [text, message] : cases) expect_in(message, outline_refusal(text));
  expect_in("outlines.csv: is not text; expected a table", outline_refusal(std::string("WKT\0\0", 5)));
}

TEST(Outlines, DegreesAreNotMetres) {
  const std::string house = "POLYGON ((11.5755 48.1372, 11.5756 48.1372, 11.5756 48.1373))\n";
  expect_in("0: the coordinates appear to be in degrees", warnings_of(town_of(house)));
  expect_in("0: the SRID states that the coordinates are in degrees",
            warnings_of(town_of("SRID=4326;LINESTRING (0 0, 12 0)")));
  EXPECT_EQ(warnings_of(town_of("SRID=32632;LINESTRING (0 0, 12 0)")), "");
  EXPECT_EQ(warnings_of(town_of("SRID=4087;LINESTRING (0 0, 1200 0)")), "") << "a projection among EPSG's angles";
  expect_in("degrees", warnings_of(town_of(house + "LINESTRING (0 0, 0.0099 0)")));
  EXPECT_EQ(warnings_of(town_of(house + "LINESTRING (0 0, 0 -0.01)")), "") << "the limit";
  const std::pair<int, bool> systems[] = {{4000, false}, {4001, true}, {4999, true}, {5000, false}};  // EPSG's angles
  for (const auto& [srid, angles] : systems)
    EXPECT_EQ(town_of(fmt::format("SRID={};LINESTRING (0 0, 1 0)", srid)).warnings.size(), angles ? 1u : 0u) << srid;
  const std::pair<const char*, bool> places[] = {{"-180 -90, 360 90", true},
                                                 {"0 0, 360.1 0", false},
                                                 {"0 0, -180.1 0", false},
                                                 {"0 0, 0 90.1", false},
                                                 {"0 0, 0 -90.1", false}};
  for (const auto& [place, angles] : places)
    EXPECT_EQ(town_of(fmt::format("SRID=4326;LINESTRING ({})", place)).warnings.size(), angles ? 1u : 0u) << place;
}

TEST(Outlines, WorkForCrossingsIsBounded) {  // it is quadratic if all edges overlap
  std::string zigzag = "LINESTRING (0 0, 1 0)\nPOLYGON ((0 0", comb = zigzag;
  for (int i = 1; i <= 50'000; ++i) {
    zigzag += fmt::format(",{} {}", i, i % 2);
    comb += fmt::format(",{} {}", i % 2, i);
  }
  EXPECT_EQ(town_of(zigzag + ",0 -1))").walls.size(), 50'003u);
  const World world = town_of(comb + ",-1 0))");
  EXPECT_EQ(world.walls.size(), 1u);
  expect_in("2: a ring of 50002 corners: its check for crossings exceeds the file's limit of 1e+09 pairs",
            warnings_of(world));
}

TEST(Outlines, RequireAStaticModelWithoutAnotherBody) {
  const std::string outlines = "outlines \"" + outlines_file("LINESTRING (0 0, 1 0)") + "\"";
  EXPECT_EQ(error_of("position( " + outlines + " )"),
            "test.world:1: 'outlines' are for static models; give robots and tags a 'block'");
  for (const char* other : {"block( points 2 point[0] [0 0] point[1] [1 1] )", "boundary 1", "cliff_return 1"})
    expect_in("'outlines' are the whole body of a model", error_of("model( " + outlines + " " + other + " )"));
  expect_in("test.world:1: cannot find the outlines \"none.csv\"; searched the folders of this file",
            error_of("model( outlines \"none.csv\" )"));
  expect_in("1: 'model' has outlines but no 'size': walls without a height of their own are 0.1 m high",
            warnings_of(read_world("model( " + outlines + " )")));
}

/// Returns houses at random places, some with courtyards, and fences.
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

TEST(Outlines, UnreadFilesCountInHashAndExtent) {  // and can be read later
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

TEST(Outlines, ReadingPartEqualsKeepingPart) {  // for any tile
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
