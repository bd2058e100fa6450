// Dialects of outline tables: separators, empty fields, titles above the names, quotes, several geometries.

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/refusal.h"
#include "tests/world/read_table.h"

namespace sf::world {

namespace {

const std::string kLine = "LINESTRING (0 0,1 0)";
/// kLine in well-known binary.
const std::string kHex = "01020000000200000000000000000000000000000000000000000000000000F03F0000000000000000";

/// Quotes a field if it needs quotes, as GDAL does.
std::string written(const std::string& field, char separator, bool bare) {
  const std::string special = separator == ' ' ? "\",;\t\n\r| " : "\",;\t\n\r|";
  if (bare || field.find_first_of(special) == std::string::npos) return field;
  std::string text = "\"";
  for (const char c : field) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + "\"";
}

TEST(OutlineTableForms, RandomTablesAreReadWithEverySeparator) {
  constexpr std::array kAttributes{
      "",     "",      "hall",   "a,b", "two\nlines",     "say \"hi\"",      "\"",      "x;y", "bar|x",
      "a\tb", "(open", "close)", "01",  "Point of sale",  "Tin roof",        "Polygon", "5",   "))",
      "L",    " lead", "trail ", "a\\", "Triangle (east", "MULTIPOLYGON ((", "12\n"};
  constexpr std::array<std::pair<const char*, double>, 5> kHeights{
      {{"", 3.0}, {"5", 5.0}, {"0.25", 0.25}, {"+7", 7.0}, {"1e1", 10.0}}};
  const std::array geometries{
      kLine,        kHex, "SRID=32632;" + kLine, "GEOMETRYCOLLECTION (" + kLine + ")", std::string("POLYGON EMPTY"),
      std::string()};
  std::mt19937 random(1);
  const auto any = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (int table = 0; table < 800; ++table) {
    const char separator = ",;\t| "[any(5)];
    const char* const end = std::array{"\n", "\r\n", "\r\r\n"}[any(3)];
    const std::size_t columns = 2 + any(4), at_height = any(columns);
    const std::size_t at_geometry = (at_height + 1 + any(columns - 1)) % columns;
    const bool bare = any(2) == 0;
    std::string text = any(3) == 0 ? "\xEF\xBB\xBF" : "", title = any(4) == 0 ? "Houses of a town\n# 2020\n" : "";
    text += title;
    std::vector<double> heights;
    for (int row = 0; row < 6; ++row) {
      const auto& [height, value] = kHeights[any(kHeights.size())];
      const std::size_t geometry = any(geometries.size());
      for (std::size_t i = 0; i < columns; ++i) {
        std::string field = row == 0 ? "a\n\"b\"" : kAttributes[any(kAttributes.size())];
        if (i == at_height) field = row == 0 ? "Height" : height;
        if (i == at_geometry) field = row == 0 ? "geom" : geometries[geometry];
        text += (i > 0 ? std::string(1, separator) : "") + written(field, separator, bare && i == at_geometry);
      }
      text += end;
      if (row > 0 && geometry < 4) heights.push_back(value);
    }
    if (heights.empty()) continue;
    const TableRead read = read_table(text);
    std::vector<double> found;
    for (const Segment& wall : read.walls) found.push_back(wall.z_max);
    ASSERT_EQ(found, heights) << "separator '" << separator << "'\n" << text << read.warnings;
    for (const char* fault : {"quote", "not read", "the height is", "both have", "expected"})
      ASSERT_TRUE(!title.empty() || read.warnings.find(fault) == std::string::npos) << text << read.warnings;
  }
}

TEST(OutlineTableForms, EmptyFieldsBeforeAGeometryInTabs) {
  EXPECT_EQ(read_table("id\theight\tgeom\n1\t5\t" + kLine + "\n2\t\t" + kLine).heights(), "5 3 ");
  EXPECT_EQ(read_table("name\tgeom\theight\n\t" + kLine + "\t5\n").heights(), "5 ");
  EXPECT_EQ(read_table("name\theight\tgeom\nx\t\t" + kHex).walls.size(), 1u);
  expect_in("2: expected an even number of hexadecimal digits, found 83",
            read_table("geom\n" + kHex + "0\n" + kHex).warnings);
}

TEST(OutlineTableForms, BlanksSeparateIfNothingElseDoes) {
  EXPECT_EQ(read_table("WKT WKT name height\n\"" + kLine + "\" \"" + kLine + "\" \"a, \"\"b\"\"\" 6.5\n").heights(),
            "6.5 ");
  EXPECT_EQ(read_table("WKT name height\n\"" + kLine + "\"  7\n").heights(), "7 ") << "an empty name";
  expect_in("line 2 has 4 fields for 3 names, since two blanks enclose an empty field",
            read_table("WKT name height\n\"" + kLine + "\" hall  7\n").warnings);
  EXPECT_EQ(read_table("WKT \"a, b\" height\n\"" + kLine + "\" hall 7\n").heights(), "7 ");
  EXPECT_EQ(read_table("roof height,the wkt,height\n2,\"" + kLine + "\",7\n").heights(), "7 ") << "names with blanks";
  EXPECT_EQ(read_table("the wkt\n" + kLine + "\n").walls.size(), 1u) << "one column";
}

TEST(OutlineTableForms, TextAfterAClosingQuoteIsReported) {
  const auto faults = [](const std::string& row) { return read_table("WKT,height\n" + row).warnings; };
  EXPECT_EQ(faults("\"" + kLine + "\" ,\"7\" \n"), "") << "blanks are none";
  EXPECT_EQ(faults("\"" + kLine + "\"x,7\n"),
            "2: text after a closing quote: 'x'; expected a separator or the end of the line: ignored\n");
  expect_in("2: text after a closing quote: 'm'", faults("\"" + kLine + "\",\"7\"m\n"));
  expect_in("2: text after a closing quote: 'hi'", faults("\"" + kLine + "\",\"say \\\"hi, you\\\"\"\n"));
  expect_in("line 1: the text after a closing quote is ignored", read_table("WKT,\"a\"b\n" + kLine + ",7").warnings);
}

TEST(OutlineTableForms, NamesMayFollowTitlesAndComments) {
  const std::string table = "WKT;name;height\n\"" + kLine + "\";hall;5\n";
  for (const std::string before :
       {"Buildings of X, 2020\n", "# made by\n", ";;;\n", "a b c\n\nd\n", "\"Buildings\nof X\"\n"})
    EXPECT_EQ(read_table(before + table).heights(), "5 ") << before;
  EXPECT_EQ(read_table("Buildings\n" + table).warnings, "0: line 2 names the columns; earlier lines are not read\n");
  EXPECT_EQ(read_table(";;;\n" + table).warnings, "");
  for (const std::string line : {"SEP=;", "sep=;", "\"sep=;\"", "\xEF\xBB\xBFSep=;"})
    EXPECT_EQ(read_table(line + "\r\n" + table).heights(), "5 ") << line;
  EXPECT_EQ(read_table("sep=\t\nWKT\theight\n" + kLine + "\t5").heights(), "5 ");
  expect_in(
      "no line before the first geometry has a known column name such as 'WKT' or 'height' (its columns are "
      "'Buildings'), so heights are not read",
      read_table("Buildings\nid;outline;h\n1;\"" + kLine + "\";5\n").warnings);
  expect_in("no column is named 'height', so heights such as those of 'Height (m)' are not read",
            read_table("WKT,Height (m)\n\"" + kLine + "\",5\n").warnings);
  const TableRead rows = read_table("id,kind,outline\n1,way,\n2,way,\"" + kLine + "\"\n");
  EXPECT_EQ(rows.walls.size(), 1u);
  expect_in("2: has no geometry: left out", rows.warnings);  // a value is not a name
}

TEST(OutlineTableForms, LineEndsInNames) {
  for (const char separator : {',', ';', '\t', '|', ' '}) {
    const std::string s(1, separator);
    EXPECT_EQ(read_table("\"id\nno\"" + s + "height" + s + "geom\n1" + s + "5" + s + kLine).heights(), "5 ") << s;
  }
  expect_in("its columns are 'id no', 'geom'", sf::refusal_of([] { read_table("\"id\nno\",geom\n1,x"); }));
}

TEST(OutlineTableForms, EmptyGeometryDoesNotDecideTheColumn) {
  const std::string square = "\"" + kSquare + "\"", other = "\"POLYGON ((20 0,25 0,25 5,20 5,20 0))\"";
  EXPECT_EQ(read_table("id,roof,footprint\n1,POLYGON EMPTY," + square + "\n2," + square + "," + other + "\n3,," + other)
                .area(),
            96.0 + 25.0 + 25.0);
  const TableRead empty = read_table("geom,envelope\nPOLYGON EMPTY," + square + "\n" + other + "," + square + "\n");
  EXPECT_EQ(empty.area(), 25.0) << "that with a name is empty in its first row";
  const TableRead late = read_table("geom,envelope\n," + square + "\n" + other + "," + square + "\n");
  EXPECT_EQ(late.area(), 192.0);
  expect_in("columns 'envelope' and 'geom' both have walls: column 'envelope', the first, is read", late.warnings);
  expect_in("columns 'roof' and 'foot' both have walls", read_table("roof,foot\n" + square + "," + other).warnings);
  EXPECT_EQ(read_table("centre,outline,geom\nPOINT (1 1)," + square + ",POINT (1 1)\n").warnings, "")
      << "one has walls";
}

TEST(OutlineTableForms, GeometryLikeTextsEndAtTheirSeparator) {
  for (const char separator : {',', ';', '\t', '|'})
    for (const std::string text :
         {"Triangle (east", "MULTIPOLYGON ((", "Point (A", "Point (5", "Polygon (WKT)", "TIN ("}) {
      const std::string s(1, separator);
      const TableRead read =
          read_table("name" + s + "height" + s + "geom\n" + text + s + "5" + s + "\"" + kLine + "\"\n");
      EXPECT_EQ(read.heights(), "5 ") << text << separator;
      EXPECT_EQ(read.warnings, "") << text << separator;
    }
  EXPECT_EQ(read_table("id,Polygon (WKT),height\n1,\"" + kLine + "\",5\n").heights(), "5 ") << "a name";
}

TEST(OutlineTableForms, ManyOpenGeometriesTakeLinearTime) {  // searching each field to the end would take minutes
  std::string row = "WKT\n" + kLine + "\n";
  for (int i = 0; i < 200'000; ++i) row += "POINT (1 1,";
  EXPECT_EQ(read_table(row).walls.size(), 1u);
}

TEST(OutlineTableForms, RingsOfShapelyAreLines) {
  EXPECT_EQ(read_table("WKT\nLINEARRING (0 0, 12 0, 12 8, 0 0)\n").walls.size(), 3u);
  EXPECT_EQ(read_table("WKT\nLinearRing Z (0 0 1, 12 0 1, 0 0 1)\n").walls.size(), 2u);
}

TEST(OutlineTableForms, FacesInACollectionAffectNoOtherMember) {
  const std::string tin = "TIN (((0 0 0,1 0 0,0 1 1,0 0 0)),((0 0 0,1 0 0,0 1 1,0 0 0)))";
  const TableRead read =
      read_table("WKT\nGEOMETRYCOLLECTION (" + tin + "," + kSquare + ",POLYHEDRALSURFACE Z (((0 0 0,1 0 0,0 1 1))))");
  EXPECT_EQ(read.area(), 96.0);
  EXPECT_EQ(read.warnings,
            "2: faces in three dimensions have no outline; expected the polygons that they cover: left out\n");
}

}  // namespace

}  // namespace sf::world
