// Outline tables as written by other programs: RFC 4180 and deviations from it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/world/read_table.h"

namespace sf::world {

namespace {

const std::string kSharedTables = SF_SOURCE_DIR "/../shared/data/reports/wkt/";

TEST(OutlineTable, FilesOfOtherProgramsGiveTheirWalls) {
  if (!std::filesystem::exists(kSharedTables)) GTEST_SKIP() << "no shared data next to the sources";
  struct Case {
    const char* file;
    std::size_t walls;
    double area;
    const char* heights;
    const char* warnings;
  };
  const std::string height = "; expected a number alone, such as 3.5, from 0 to 1e+07: using the height of the model\n";
  const std::string h12 = "2: the height is '12 m'" + height, h35 = "2: the height is '3,5'" + height,
                    h70 = "2: the height is '5e+70'" + height;
  const Case cases[] = {{"coll.txt", 4, 96, "3 ", ""},
                        {"curve.csv", 8, 88, "6.5 ", ""},
                        {"ewkt.txt", 4, 96, "3 ", ""},
                        {"geomcol.csv", 4, 96, "5 ", ""},
                        {"h12m.csv", 4, 96, "3 ", h12.c_str()},
                        {"h3c5.csv", 4, 96, "3 ", h35.c_str()},
                        {"h5e70.csv", 4, 96, "3 ", h70.c_str()},
                        {"innerempty.txt", 4, 96, "3 ", ""},
                        {"newline.csv", 17, 138, "6.5 3 ", ""},
                        {"nullgeom.csv", 16, 138, "6.5 3 ", "4: has no geometry: left out\n"},
                        {"point.csv", 4, 96, "3 ", "2: points have no walls: left out\n"},
                        {"second.csv", 4, 96, "5 ", ""},
                        {"semi.csv", 8, 88, "6.5 ", ""},
                        {"wkb.txt", 4, 96, "3 ", ""}};
  for (const Case& c : cases) {
    const TableRead read = read_table_file(kSharedTables + c.file);
    EXPECT_EQ(read.walls.size(), c.walls) << c.file;
    EXPECT_EQ(read.heights(), c.heights) << c.file;
    EXPECT_EQ(read.warnings, c.warnings) << c.file;
    if (c.walls % 2 == 0) {
      EXPECT_EQ(read.area(), c.area) << c.file;
    }  // a line does not enclose any points
  }
}

TEST(OutlineTable, AnySeparatorAnyColumnAnyName) {
  for (const char separator : {',', ';', '\t', '|'})
    for (const char* name : {"WKT", "geom", "the_geom", "Shape", "way", "anything", "\"wkt\"", " WKT "})
      for (const std::string& geometry :
           {"\"" + kSquare + "\"", kSquare, "SRID=32632;" + kSquare, "\"SRID=32632;" + kSquare + "\""})
        for (const char* end : {"\n", "\r\n"}) {
          const auto line = [&](auto a, auto b, auto c, auto d) {
            return fmt::format("{1}{0}{2}{0}{3}{0}{4}{5}", separator, a, b, c, d, end);
          };
          const std::string text =
              line("id", "height", "name", name) + line(1, "6.5", "\"a, b; c\"", geometry) + line(2, "", "(", geometry);
          const TableRead read = read_table(text);
          EXPECT_EQ(read.walls.size(), 8u) << text;
          EXPECT_EQ(read.heights(), "6.5 3 ") << text;
          EXPECT_EQ(read.warnings, "") << text;
        }
}

TEST(OutlineTable, GeometryIsFoundWithoutAHeader) {
  for (const std::string& text : {kSquare, "\"" + kSquare + "\"", "\xEF\xBB\xBF" + kSquare, "SRID=32632;" + kSquare}) {
    EXPECT_EQ(read_table(text).area(), 96.0) << text;
    EXPECT_EQ(read_table(text).warnings, "") << text;
  }
  for (const std::string& text : {"7;" + kSquare + ";hall, old;6", "7|hall|" + kSquare, "sep=;\n1;" + kSquare,
                                  "SRID=32632;" + kSquare + ";hall"}) {
    EXPECT_EQ(read_table(text).area(), 96.0) << text;
    EXPECT_EQ(
        read_table(text).warnings,
        "0: the first line does not name the columns, so columns without geometries, such as heights, are ignored\n")
        << text;
  }
  EXPECT_EQ(read_table("sep=;\nid;WKT;height\n1;" + kSquare + ";4").heights(), "4 ");
}

TEST(OutlineTable, PrefersTheGeometryWithWalls) {  // over a centre or an envelope
  const std::string point = "\"POINT (6 4)\"", hexpoint = "0101000000000000000000184000000000000010400";
  EXPECT_EQ(read_table("center,geom\n" + point + ",\"" + kSquare + "\"").area(), 96.0);
  EXPECT_EQ(read_table("center,outline\n" + hexpoint.substr(0, 42) + ",\"" + kSquare + "\"").area(), 96.0);
  EXPECT_EQ(read_table("envelope,geom\n\"POLYGON ((0 0,99 0,99 99,0 99))\",\"" + kSquare + "\"").area(), 96.0);
  EXPECT_EQ(read_table("geom,outline\n,\"" + kSquare + "\"").area(), 96.0) << "an empty column with a name";
  EXPECT_EQ(read_table("Point count (n),Polygon,outline\n1,2,\"" + kSquare + "\"").area(), 96.0) << "names like types";
}

TEST(OutlineTable, LineEndsInQuotes) {
  const TableRead read = read_table(
      "name,WKT,height\r\n\"a\r\nb \"\"c\"\",\nd\",\"POLYGON ((0 0,12 0,\r\n12 8,0 8))\",7\r\nx,\"POINT (0 0)\",\n");
  EXPECT_EQ(read.area(), 96.0);
  EXPECT_EQ(read.heights(), "7 ");
  EXPECT_EQ(read.warnings, "6: points have no walls: left out\n") << "lines count, not records";
}

TEST(OutlineTable, UnquotedGeometryMaySpanLines) {
  const std::string pretty = "POLYGON (\n  (0 0,\n\n   12 0,\r\n   12 8, 0 8)\n)\n", line = "LINESTRING (0 0, 1 0)\n";
  TableRead read = read_table(pretty + line + pretty + "POINT (0 0)\n");
  EXPECT_EQ(read.area(), 192.0);
  EXPECT_EQ(read.warnings, "14: points have no walls: left out\n");
  read = read_table(line + "POLYGON ((0 0, 12 0,\n" + line + "POLYGON ((0 0, 12 0,\n 12 8");
  EXPECT_EQ(read.walls.size(), 2u) << "one that does not end costs its lines alone";
  EXPECT_EQ(read.warnings.substr(0, 2), "2:");
  EXPECT_EQ(read_table("id,WKT\n1,POLYGON ((0 0, 12 0,\n2," + line).walls.size(), 1u) << "a number that begins a row";
}

TEST(OutlineTable, UnclosedQuoteAffectsOnlyItsRow) {
  const std::string good = "\"LINESTRING (0 0,1 0)\",a\n";
  TableRead read = read_table("WKT,name\n" + good + "\"LINESTRING (0 0,1 0),b\n" + good + good);
  EXPECT_EQ(read.walls.size(), 3u);
  EXPECT_EQ(read.warnings, "3: expected the end of the geometry, found ',b': left out\n");
  read = read_table("name\tWKT\n\"open\tLINESTRING (0 0,1 0)\nb\tLINESTRING (0 0,1 0)\nc\tLINESTRING (0 0,1 0)\n");
  EXPECT_EQ(read.walls.size(), 2u) << "no quote follows";
  EXPECT_EQ(read.warnings, "2: has no geometry: left out\n");
  EXPECT_EQ(read_table("WKT,name\n" + good + "LINESTRING (0 0,1 0),12\" pipe\n" + good).walls.size(), 3u)
      << "a stray one";
  EXPECT_EQ(read_table("\"WKT,name\nLINESTRING (0 0,1 0),a\n").walls.size(), 1u) << "in the header";
}

TEST(OutlineTable,
     OpenQuotesAreJoinedOnce) {  // each line leaves a quote open; joining again from each line would take a minute
  std::string text = "LINESTRING (0 0,1 0)\n";
  for (int i = 0; i < 100'000; ++i) text += "a\",\"\n";
  EXPECT_EQ(read_table(text).walls.size(), 1u);
}

TEST(OutlineTable, RowsMayBeShort) {
  const TableRead read =
      read_table("id,WKT,height\n1\n2,\"LINESTRING (0 0,1 0)\"\n\n,,,,,\n3,\"LINESTRING (0 0,1 0)\",4,more\n");
  EXPECT_EQ(read.walls.size(), 2u);
  EXPECT_EQ(read.heights(), "3 4 ");
  EXPECT_EQ(read.warnings, "2: has no geometry: left out\n5: has no geometry: left out\n");
}

TEST(OutlineTable, DatabaseNullsAreNotGeometries) {
  const TableRead read = read_table("id,geom\n1,\"LINESTRING (0 0,1 0)\"\n2,NULL\n3,\\N\n4,010000000000000042\n");
  EXPECT_EQ(read.walls.size(), 1u);
  EXPECT_NE(
      read.warnings.find("3: expected POLYGON, MULTIPOLYGON, LINESTRING or MULTILINESTRING, found 'NULL': left out"),
      std::string::npos)
      << read.warnings;
}

}  // namespace

}  // namespace sf::world
