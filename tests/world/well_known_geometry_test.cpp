// Well-known text and binary in all their variants.

#include "world/well_known_geometry.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <random>

#include "tests/refusal.h"
#include "world/arc.h"

namespace sf::world {

namespace {

using Kind = WellKnownGeometry::Kind;

/// Returns "outer 0 0, 1 0; inner ..."
std::string geometry_words(const WellKnownGeometry& geometry) {
  std::string text;
  std::size_t at = 0;
  for (const auto& part : geometry.parts) {
    text += part.kind == Kind::line ? "line" : part.kind == Kind::outer ? "outer" : "inner";
    for (; at < part.end; ++at) text += fmt::format(" {} {},", geometry.points[at].x, geometry.points[at].y);
    text.back() = ';';
  }
  return text;
}

std::string geometry_of(const std::string& text) {
  WellKnownGeometry geometry;
  read_geometry(text, 0.01, geometry);
  return geometry_words(geometry) +
         (geometry.points_left_out > 0 ? fmt::format(" {} points", geometry.points_left_out) : "") +
         (geometry.srid > 0 ? fmt::format(" srid {}", geometry.srid) : "");
}

TEST(WellKnownText, EveryTypeIsReadInEverySpelling) {
  const std::string triangle = "outer 0 0, 1 0, 1 1;";
  for (const char* text : {"POLYGON ((0 0, 1 0, 1 1))",
                           "polygon((0 0,1 0,1 1))",
                           "POLYGON Z ((0 0 5, 1 0 5, 1 1 5))",
                           "POLYGONZ((0 0 5,1 0 5,1 1 5))",
                           "POLYGON ZM ((0 0 5 6,1 0 5 6,1 1 5 6))",
                           "POLYGONZM((0 0 5 6,1 0 5 6,1 1 5 6))",
                           "POLYGON M ((0 0 1,1 0 1,1 1 1))",
                           "POLYGON Z ((0 0 nan, 1 0 NaN, 1 1 nan))",
                           "TRIANGLE ((0 0, 1 0, 1 1))",
                           "MULTIPOLYGON (((0 0, 1 0, 1 1)))",
                           "MULTIPOLYGON (EMPTY, ((0 0, 1 0, 1 1)), EMPTY)",
                           "GEOMETRYCOLLECTION (GEOMETRYCOLLECTION (POLYGON ((0 0, 1 0, 1 1))), LINESTRING EMPTY)",
                           "GEOMETRYCOLLECTION Z (POLYGON Z ((0 0 1, 1 0 1, 1 1 1)))",
                           "CURVEPOLYGON ((0 0, 1 0, 1 1))",
                           "CURVEPOLYGON (COMPOUNDCURVE ((0 0, 1 0, 1 1)))",
                           "MULTISURFACE (((0 0, 1 0, 1 1)))",
                           "MULTISURFACE (CURVEPOLYGON ((0 0, 1 0, 1 1)))",
                           "POLYGON ((+0 -0.0, +1e0 1e-999, 1. +1))",
                           " \t\r\nPOLYGON\n(\r\n(0\t0\n,1 0,1 1)\n)\n",
                           "POLYGON ((0 0, 1 0, 1 1), EMPTY)"}) {
    std::string found = geometry_of(text);
    if (const auto minus = found.find("0 -0,"); minus != std::string::npos) found.erase(minus + 2, 1);
    EXPECT_EQ(found, triangle) << text;
  }
  EXPECT_EQ(geometry_of("MULTILINESTRING ((0 0, 1 0), (2 0, 3 0))"), "line 0 0, 1 0;line 2 0, 3 0;");
  EXPECT_EQ(geometry_of("MULTICURVE ((0 0, 1 0), COMPOUNDCURVE ((2 0, 3 0), (3 0, 4 0)))"),
            "line 0 0, 1 0;line 2 0, 3 0, 3 0, 4 0;");
  EXPECT_EQ(geometry_of("POLYGON ((0 0, 9 0, 9 9), (5 1, 6 1, 6 2))"), "outer 0 0, 9 0, 9 9;inner 5 1, 6 1, 6 2;");
  EXPECT_EQ(geometry_of("SRID=25832; LINESTRING (0 0, 1 0)"), "line 0 0, 1 0; srid 25832");
  EXPECT_EQ(
      geometry_of("GEOMETRYCOLLECTION (POINT (1 2), MULTIPOINT (1 2, 3 4), MULTIPOINT ((1 2), (3 4), EMPTY), POINT "
                  "EMPTY, LINESTRING (0 0, 1 0))"),
      "line 0 0, 1 0; 4 points");
}

TEST(WellKnownText, DecimalsAreTheNearestDoubles) {
  WellKnownGeometry geometry;
  std::mt19937_64 random(4);
  for (int i = 0; i < 2000; ++i) {
    const double x = std::uniform_real_distribution(-1e7, 1e7)(random),
                 y = std::ldexp(x, -static_cast<int>(random() % 60));
    read_geometry(fmt::format("LINESTRING ({} {:+.17g}, 0 0)", x, y), 1.0, geometry);
    ASSERT_EQ(geometry.points[0], glm::dvec2(x, y));
  }
}

/// Writes well-known binary by hand.
struct BinaryWriter {
  bool little = true;
  std::uint32_t flags = 0;  ///< added to types: flags of EWKB, or thousands of ISO
  int more = 0;             ///< coordinates beyond x and y
  std::string bytes = {};

  template <class T>
  BinaryWriter& put(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (little != (std::endian::native == std::endian::little)) std::reverse(std::begin(raw), std::end(raw));
    bytes.append(raw, sizeof(T));
    return *this;
  }
  BinaryWriter& type(std::uint32_t code, bool srid = false) {
    bytes += little ? '\1' : '\0';
    put(code + flags + (srid ? 0x20000000u : 0u));
    if (srid) put(std::uint32_t{31467});
    return *this;
  }
  BinaryWriter& point(double x, double y) {
    put(x).put(y);
    for (int i = 0; i < more; ++i) put(7.0);
    return *this;
  }
  BinaryWriter& ring() { return put(std::uint32_t{3}).point(0, 0).point(1, 0).point(1, 1); }
};

std::string hex_of(const std::string& bytes, bool upper) {
  std::string hex;
  for (const unsigned char c : bytes) hex += upper ? fmt::format("{:02X}", c) : fmt::format("{:02x}", c);
  return hex;
}

TEST(WellKnownBinary, EveryByteOrderAndDimensionIsRead) {
  const std::pair<std::uint32_t, int> dimensions[] = {{0, 0},           {1000, 1},        {2000, 1},       {3000, 2},
                                                      {0x80000000u, 1}, {0x40000000u, 1}, {0xC0000000u, 2}};
  for (const bool little : {true, false})
    for (const auto& [flags, more] : dimensions)
      for (const bool srid : {false, true}) {
        BinaryWriter polygon{little, flags, more};
        polygon.type(3, srid).put(std::uint32_t{1}).ring();
        BinaryWriter several{little, flags, more};
        several.type(7, srid)
            .put(std::uint32_t{3})
            .type(1)
            .point(NAN, NAN)
            .type(6)
            .put(std::uint32_t{1})
            .type(3)
            .put(std::uint32_t{1})
            .ring();
        several.type(4).put(std::uint32_t{1}).type(1).point(1, 2);
        for (const bool upper : {true, false})
          for (const char* mark : {"", "\\x", "0x"}) {
            const std::string end = srid ? " srid 31467" : "";
            EXPECT_EQ(geometry_of(mark + hex_of(polygon.bytes, upper)), "outer 0 0, 1 0, 1 1;" + end);
            EXPECT_EQ(geometry_of(mark + hex_of(several.bytes, upper) + " "), "outer 0 0, 1 0, 1 1; 2 points" + end);
          }
      }
}

TEST(WellKnownBinary, FaultsAreRejectedWithTheirByte) {
  BinaryWriter good;
  good.type(3).put(std::uint32_t{1}).ring();
  WellKnownGeometry geometry;
  const auto refusal = [&](const std::string& bytes) {
    return sf::refusal_of([&] { read_binary_geometry(bytes, 1.0, geometry); });
  };
  EXPECT_EQ(refusal(good.bytes), "");
  EXPECT_EQ(refusal(good.bytes + std::string(2, '\0')), "") << "padded";
  for (std::size_t size = 0; size < good.bytes.size(); ++size)
    EXPECT_NE(refusal(good.bytes.substr(0, size)), "") << size;
  expect_in("expected the end of the geometry at byte 61 of 62", refusal(good.bytes + "x"));
  expect_in("expected a byte order of 0 or 1", refusal("\2" + good.bytes.substr(1)));
  expect_in("expected a type of geometry instead of 99", refusal(BinaryWriter{}.type(99).bytes));
  expect_in("8 bytes more", refusal(BinaryWriter{}.type(2).put(0xFFFFFFFFu).bytes));
  expect_in("expected finite coordinates",
            refusal(BinaryWriter{}.type(2).put(std::uint32_t{2}).point(0, 0).point(INFINITY, 0).bytes));
  EXPECT_EQ(refusal(BinaryWriter{}.type(7).put(std::uint32_t{2}).bytes +
                    BinaryWriter{}.type(15).put(std::uint32_t{1}).bytes + good.bytes + good.bytes),
            "");
  EXPECT_EQ(geometry.faces_left_out, 1u);
  EXPECT_EQ(geometry.parts.size(), 1u) << "the faces are left out, the other member is not";
}

TEST(WellKnownBinary, DigitsAreGeometriesFromTheShortestOn) {
  const auto content = [](const char* text) { return guess_geometry(text).content; };
  EXPECT_EQ(content("010200000000000000"), GeometryGuess::Content::walls) << "LINESTRING EMPTY";
  EXPECT_EQ(content("0102000000000000"), GeometryGuess::Content::none) << "a byte less";
  EXPECT_EQ(content("01020000000000000"), GeometryGuess::Content::none) << "half a byte less";
  EXPECT_EQ(content("000000000400000000"), GeometryGuess::Content::points);
  EXPECT_EQ(content("010000000000000042"), GeometryGuess::Content::none) << "a key of digits";
  EXPECT_EQ(content("020200000000000000"), GeometryGuess::Content::none) << "no byte order";
}

/// Returns the largest distance of corners and midpoints of chords from a circle.
double off_circle(const std::vector<glm::dvec2>& line, glm::dvec2 centre, double radius) {
  double most = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i)
    for (const glm::dvec2& p : {line[i], 0.5 * (line[i] + line[i - 1])})
      most = std::max(most, std::abs(length(p - centre) - radius));
  return most;
}

TEST(Arcs, ChordsAreWithinTheirError) {
  for (const double radius : {0.5, 10.0, 1000.0})
    for (const double error : {1e-3, 1e-6})
      for (const double turn : {0.01, 1.0, -3.0, 6.2}) {
        const glm::dvec2 centre{3e5, -7e5};
        const auto at = [&](double angle) { return centre + base::rotate(angle, {radius, 0.0}); };
        std::vector<glm::dvec2> line{at(0.3)};
        ASSERT_TRUE(append_arc(line, at(0.3 + 0.4 * turn), at(0.3 + turn), error, 1e6));
        EXPECT_LE(off_circle(line, centre, radius), error * 1.001 + 1e-8 / std::abs(turn * turn))
            << radius << ' ' << error << ' ' << turn;
        EXPECT_EQ(line.back(), at(0.3 + turn));
        EXPECT_LE(static_cast<double>(line.size()), std::abs(turn) / std::sqrt(8.0 * error / radius) + 4.0)
            << "no more than needed";
        EXPECT_EQ(base::cross(line[1] - line[0], line.back() - line[0]) > 0,
                  std::abs(turn) > M_PI ? turn > 0 : turn > 0);
      }
}

TEST(Arcs, FullCirclesStraightArcsAndTooManyChords) {
  std::vector<glm::dvec2> line{{1, 0}};
  EXPECT_TRUE(append_arc(line, {-1, 0}, {1, 0}, 1e-3, 1e6));  // its end is its start: half a turn to the middle
  EXPECT_LE(off_circle(line, {0, 0}, 1.0), 1e-3);
  EXPECT_NEAR(static_cast<double>(line.size()), 2.0 * M_PI / std::sqrt(8e-3), 3.0);
  line = {{0, 0}};
  EXPECT_TRUE(append_arc(line, {1, 1}, {2, 2}, 1e-3, 1e6));
  EXPECT_EQ(line.size(), 2u) << "in line";
  EXPECT_TRUE(append_arc(line, {2, 2}, {2, 2}, 1e-3, 1e6)) << "no extent";
  line = {{0, 0}};
  EXPECT_FALSE(append_arc(line, {1, 1}, {2, 0}, 1e-9, 1000));
  EXPECT_EQ(line.size(), 1u);
}

TEST(Arcs, AreReadInGeometries) {
  WellKnownGeometry geometry;
  const auto read_as = [&](const char* text) {
    read_geometry(text, 1e-3, geometry);
    return geometry.parts.size() == 1 ? geometry.parts[0].kind : Kind::inner;
  };
  EXPECT_EQ(read_as("CIRCULARSTRING (1 0, 0 1, -1 0, 0 -1, 1 0)"), Kind::line);
  EXPECT_LE(off_circle(geometry.points, {0, 0}, 1.0), 1e-3);
  EXPECT_EQ(read_as("CURVEPOLYGON (CIRCULARSTRING (1 0, -1 0, 1 0))"), Kind::outer);
  EXPECT_LE(off_circle(geometry.points, {0, 0}, 1.0), 1e-3);
  EXPECT_EQ(read_as("CURVEPOLYGON Z (COMPOUNDCURVE Z (CIRCULARSTRING Z (1 0 9, 0 1 9, -1 0 9), (-1 0 9, 1 0 9)))"),
            Kind::outer);
  EXPECT_EQ(geometry.points.back(), glm::dvec2(1, 0));
  EXPECT_EQ(read_as("MULTICURVE (CIRCULARSTRING (1 0, 0 1, -1 0))"), Kind::line);
  EXPECT_EQ(read_as("CIRCULARSTRING EMPTY"), Kind::inner) << "no part";
  BinaryWriter binary;
  binary.type(10)
      .put(std::uint32_t{1})
      .type(9)
      .put(std::uint32_t{2})
      .type(8)
      .put(std::uint32_t{3})
      .point(1, 0)
      .point(0, 1)
      .point(-1, 0);
  binary.type(2).put(std::uint32_t{2}).point(-1, 0).point(1, 0);
  read_binary_geometry(binary.bytes, 1e-3, geometry);
  const std::string found = geometry_words(geometry);
  read_as("CURVEPOLYGON (COMPOUNDCURVE (CIRCULARSTRING (1 0, 0 1, -1 0), (-1 0, 1 0)))");
  EXPECT_EQ(found, geometry_words(geometry));
  geometry.chords_left = 100.0;  // per file
  read_as("CIRCULARSTRING (1 0, 0 1, -1 0)");
  EXPECT_EQ(geometry.chords_left, 100.0 - static_cast<double>(geometry.points.size() - 1));
  expect_in("or too many in the file", sf::refusal_of([&] { read_as("CIRCULARSTRING (100 0, 0 100, -100 0)"); }));
  geometry.chords_left = 1e9;
  expect_in("arcs of more than 1e+06 chords",
            sf::refusal_of([&] { read_geometry("CIRCULARSTRING (0 0, 1e6 1e6, 2e6 0)", 1e-9, geometry); }));
}

}  // namespace

}  // namespace sf::world
