#include "viz/canvas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "tests/refusal.h"
#include "tests/units.h"
#include "tests/viz/png.h"
#include "viz/legend.h"
#include "viz/picture_file.h"

namespace sf::viz {
namespace {

using scenes::picture_of;

int darkness(const Canvas& canvas) {
  const scenes::Picture picture = picture_of(canvas);
  int sum = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) sum += 255 - static_cast<int>(picture.at(x, y) & 0xFFu);
  return sum;
}

/// Black area of the picture, in pixels.
double area_of(const Canvas& canvas) { return darkness(canvas) / 255.0; }

TEST(Canvas, StartsAsBackground) {
  const Canvas canvas(3, 2, 0xFF123456u);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) EXPECT_EQ(picture_of(canvas).at(x, y), 0xFF123456u);
}

TEST(Canvas, PolygonFillsWholePixels) {  // whole pixels: no grey anywhere
  Canvas canvas(8, 8, kWhite);
  const glm::dvec2 box[] = {{2, 3}, {5, 3}, {5, 7}, {2, 7}};
  canvas.polygon(box, kBlack);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      EXPECT_EQ(picture_of(canvas).at(x, y), x >= 2 && x < 5 && y >= 3 && y < 7 ? kBlack : kWhite) << x << ", " << y;
}

TEST(Canvas, PolygonCoversItsArea) {  // any slope: coverage sums to the area, here of a triangle of 20 x 11 / 2
  Canvas canvas(32, 32, kWhite);
  const glm::dvec2 triangle[] = {{3.3, 4.2}, {23.3, 4.2}, {9.1, 15.2}};
  canvas.polygon(triangle, kBlack);
  EXPECT_NEAR(area_of(canvas), 110.0, 0.3);
}

TEST(Canvas, PolygonDirectionDoesNotMatter) {
  Canvas one(16, 16, kWhite);
  Canvas other(16, 16, kWhite);
  const glm::dvec2 there[] = {{2, 2}, {13, 4}, {7, 12}};
  const glm::dvec2 back[] = {{7, 12}, {13, 4}, {2, 2}};
  one.polygon(there, kBlack);
  other.polygon(back, kBlack);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) EXPECT_EQ(picture_of(one).at(x, y), picture_of(other).at(x, y));
}

TEST(Canvas, OverlapOfOneShapeIsPaintedOnce) {  // the middle of two overlapping squares is no darker than the rest
  Canvas canvas(12, 12, kWhite);
  std::vector<Line> edges;
  for (const double d : {0.0, 3.0}) {
    const glm::dvec2 p[] = {{1 + d, 1 + d}, {7 + d, 1 + d}, {7 + d, 7 + d}, {1 + d, 7 + d}};
    for (int i = 0; i < 4; ++i) edges.push_back({p[i], p[(i + 1) % 4]});
  }
  canvas.area(edges, 0x80000000u);
  EXPECT_EQ(picture_of(canvas).at(2, 2), picture_of(canvas).at(5, 5));
  EXPECT_EQ(picture_of(canvas).at(8, 8), picture_of(canvas).at(5, 5));
  EXPECT_NE(picture_of(canvas).at(5, 5), kWhite);
}

TEST(Canvas, HoleStaysEmpty) {  // an outline of the opposite orientation is subtracted
  Canvas canvas(12, 12, kWhite);
  const glm::dvec2 outer[] = {{1, 1}, {11, 1}, {11, 11}, {1, 11}};
  const glm::dvec2 inner[] = {{4, 4}, {4, 8}, {8, 8}, {8, 4}};
  std::vector<Line> edges;
  for (int i = 0; i < 4; ++i) edges.push_back({outer[i], outer[(i + 1) % 4]});
  for (int i = 0; i < 4; ++i) edges.push_back({inner[i], inner[(i + 1) % 4]});
  canvas.area(edges, kBlack);
  EXPECT_EQ(picture_of(canvas).at(5, 5), kWhite);
  EXPECT_EQ(picture_of(canvas).at(2, 5), kBlack);
}

TEST(Canvas, AreaMayReachFarOutside) {  // clipped on all sides: the whole inside is covered
  Canvas canvas(10, 6, kWhite);
  const glm::dvec2 huge[] = {{-1e7, -1e7}, {1e7, -1e7}, {1e7, 1e7}, {-1e7, 1e7}};
  canvas.polygon(huge, kBlack);
  EXPECT_NEAR(area_of(canvas), 60.0, 1e-9);
}

TEST(Canvas, AreaAcrossOneSideIsClipped) {  // half of the square remains on each side
  for (const glm::dvec2& shift : {glm::dvec2{-5, 0}, glm::dvec2{5, 0}, glm::dvec2{0, -5}, glm::dvec2{0, 5}}) {
    Canvas canvas(10, 10, kWhite);
    std::vector<glm::dvec2> box{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    for (glm::dvec2& p : box) p = p + shift;
    canvas.polygon(box, kBlack);
    EXPECT_NEAR(area_of(canvas), 50.0, 1e-9) << shift.x << ", " << shift.y;
  }
}

TEST(Canvas, LineCoversLengthTimesWidth) {
  for (const double width : {0.4, 1.0, 1.5, 4.0}) {
    Canvas canvas(80, 80, kWhite);
    canvas.line({10, 12}, {66, 54}, width, kBlack);
    const double ends = width >= 1.0 ? M_PI * width * width / 4.0 : 0.8 * width;
    EXPECT_NEAR(area_of(canvas), 70.0 * width + ends, 0.03 * 70.0 * width + 0.6) << width;
  }
}

TEST(Canvas, JointsOfAPolylineAreNotDarker) {
  Canvas one(40, 10, kWhite);
  Canvas many(40, 10, kWhite);
  one.line({5, 5}, {35, 5}, 2.0, 0x80000000u);
  std::vector<glm::dvec2> points;
  for (int i = 0; i <= 300; ++i) points.push_back({5.0 + i / 10.0, 5.0});
  many.polyline(points, 2.0, 0x80000000u);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 40; ++x) EXPECT_EQ(picture_of(one).at(x, y), picture_of(many).at(x, y)) << x << ", " << y;
}

TEST(Canvas, OnePointIsADot) {
  Canvas canvas(9, 9, kWhite);
  const glm::dvec2 point{4.5, 4.5};
  canvas.polyline({&point, 1}, 3.0, kBlack);
  EXPECT_EQ(picture_of(canvas).at(4, 4), kBlack);
  EXPECT_EQ(picture_of(canvas).at(0, 4), kWhite);
}

TEST(Canvas, ClipProtectsTheRest) {
  Canvas canvas(10, 10, kWhite);
  canvas.clip({2, 3, 6, 7});
  const glm::dvec2 all[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  canvas.polygon(all, kBlack);
  canvas.line({0, 0}, {10, 10}, 3.0, kBlack);
  TextStyle style;
  style.color = kBlack;
  canvas.text({0, 5}, "MMMM", style);
  EXPECT_NEAR(area_of(canvas), 16.0, 1e-9);
}

/// A line 4 px wide whose centre runs 1 px outside of one side: one row or column of it remains, for a clip box, too.
TEST(Canvas, WideLinesOutsideASideAreClipped) {
  for (const PixelBox& box : {PixelBox{0, 0, 20, 12}, PixelBox{3, 2, 15, 9}}) {
    const double x0 = box.x_min, y0 = box.y_min, x1 = box.x_max, y1 = box.y_max, far = 40.0;
    const double width = x1 - x0, height = y1 - y0;
    for (const auto& [line, area, side] : {std::tuple{Line{{x0 - 1, -far}, {x0 - 1, far}}, height, "left"},
                                           {Line{{x1 + 1, -far}, {x1 + 1, far}}, height, "right"},
                                           {Line{{-far, y0 - 1}, {far, y0 - 1}}, width, "top"},
                                           {Line{{-far, y1 + 1}, {far, y1 + 1}}, width, "bottom"}}) {
      Canvas canvas(20, 12, kWhite);
      canvas.clip(box);
      canvas.line(line.a, line.b, 4.0, kBlack);
      EXPECT_NEAR(area_of(canvas), area, 1e-9) << side << " of " << width << " x " << height;
    }
  }
}

TEST(Canvas, ClipOutsideThePictureDrawsNothing) {
  Canvas canvas(10, 10, kWhite);
  canvas.clip({20, 20, 30, 30});
  canvas.disc({5, 5}, 4, kBlack);
  canvas.line({0, 0}, {10, 10}, 3.0, kBlack);
  EXPECT_EQ(darkness(canvas), 0);
}

TEST(Canvas, PointsThatAreNotFiniteAreSkipped) {
  Canvas canvas(10, 10, kWhite);
  canvas.line({kNaN, 1}, {5, 5}, 2.0, kBlack);
  canvas.line({1, 1}, {5, kInf}, 2.0, kBlack);
  canvas.disc({kNaN, kNaN}, 3, kBlack);
  EXPECT_EQ(darkness(canvas), 0);
}

TEST(Canvas, EmptyShapesDrawNothing) {
  Canvas canvas(4, 4, kWhite);
  canvas.polyline({}, 1.0, kBlack);
  canvas.polygon({}, kBlack);
  canvas.area({}, kBlack);
  canvas.text({1, 1}, "", {});
  EXPECT_EQ(darkness(canvas), 0);
}

TEST(Canvas, DiscHasItsArea) {
  Canvas canvas(40, 40, kWhite);
  canvas.disc({20, 20}, 12, kBlack);
  EXPECT_NEAR(area_of(canvas), M_PI * 144.0, 1.5);  // its corners lie on the circle, its sides 0.03 px within
}

TEST(Canvas, OpacityMixes) {
  Canvas canvas(3, 3, kWhite);
  const glm::dvec2 all[] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
  canvas.polygon(all, 0x80FF0000u);
  EXPECT_NEAR(static_cast<double>(picture_of(canvas).at(1, 1) & 0xFFu), 127.0, 1.0);
  EXPECT_EQ(picture_of(canvas).at(1, 1) >> 16 & 0xFFu, 255u);
}

TEST(Canvas, ImageRepeatsLargeCells) {  // a cell of 4 x 4 pixels has one colour up to its border
  Canvas canvas(8, 4, kWhite);
  const std::uint32_t cells[] = {0xFF112233u, 0xFF445566u};
  canvas.image({0, 0}, {8, 4}, {2, 1, cells});
  EXPECT_EQ(picture_of(canvas).at(3, 3), cells[0]);
  EXPECT_EQ(picture_of(canvas).at(4, 0), cells[1]);
}

TEST(Canvas, ImageAveragesSmallCells) {  // a checker board of half pixels is grey
  Canvas canvas(2, 2, kWhite);
  std::vector<std::uint32_t> cells;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) cells.push_back((i + j) % 2 ? kWhite : kBlack);
  canvas.image({0, 0}, {2, 2}, {4, 4, cells});
  EXPECT_NEAR(static_cast<double>(picture_of(canvas).at(1, 1) & 0xFFu), 127.5, 1.0);
}

TEST(Canvas, ImageStartsWithItsTopRow) {
  Canvas canvas(1, 2, kWhite);
  const std::uint32_t cells[] = {0xFF010203u, 0xFF040506u};
  canvas.image({0, 0}, {1, 2}, {1, 2, cells});
  EXPECT_EQ(picture_of(canvas).at(0, 0), cells[0]);
}

TEST(Canvas, TextLiesInItsBox) {
  TextStyle style;
  style.color = kBlack;
  const glm::dvec2 size = text_size("Robot 7", style);
  ASSERT_GT(size.x, 40.0);
  ASSERT_GT(size.y, 12.0);
  Canvas canvas(200, 60, kWhite);
  canvas.text({20, 30}, "Robot 7", style);
  EXPECT_GT(area_of(canvas), 60.0);
  canvas.clip(
      {20, static_cast<int>(30 - size.y / 2) - 1, 21 + static_cast<int>(size.x), static_cast<int>(31 + size.y / 2)});
  const glm::dvec2 all[] = {{0, 0}, {200, 0}, {200, 60}, {0, 60}};
  canvas.polygon(all, kWhite);
  EXPECT_EQ(darkness(canvas), 0) << "text outside of the box of text_size";
}

TEST(Canvas, TextAnchors) {  // the same text ends, is centred, or starts at the point
  for (const auto& [anchor, from, to] : {std::tuple{Anchor::start, 100, 200}, {Anchor::end, 0, 100}}) {
    Canvas canvas(200, 40, kWhite);
    TextStyle style;
    style.across = anchor;
    canvas.text({100, 20}, "IMI", style);
    canvas.clip({from, 0, to, 40});
    const glm::dvec2 all[] = {{0, 0}, {200, 0}, {200, 40}, {0, 40}};
    EXPECT_GT(darkness(canvas), 0);
    canvas.polygon(all, kWhite);
    EXPECT_EQ(darkness(canvas), 0);
  }
}

TEST(Canvas, TextUpwardsIsTall) {
  TextStyle style;
  const glm::dvec2 flat = text_size("metres", style);
  style.upwards = true;
  const glm::dvec2 tall = text_size("metres", style);
  EXPECT_GT(tall.y, tall.x);
  EXPECT_NEAR(tall.y, flat.x, 4.0);
}

TEST(Canvas, DashesLeaveGaps) {  // 100 px of 6 on, 4 off: 60 % of the line
  Canvas canvas(120, 10, kWhite);
  const Line line{{10, 5}, {110, 5}};
  draw_dashes(canvas, {&line, 1}, 1.0, 5.0, 5.0, kBlack);
  EXPECT_GT(area_of(canvas), 45.0);
  EXPECT_LT(area_of(canvas), 70.0);
}

TEST(Canvas, DashesContinueAcrossSegments) {  // a line in pieces shorter than a dash looks like a whole line
  Canvas whole(120, 10, kWhite);
  Canvas pieces(120, 10, kWhite);
  const Line line{{10, 5}, {110, 5}};
  std::vector<Line> parts;
  for (int i = 0; i < 50; ++i) parts.push_back({{10.0 + 2 * i, 5}, {12.0 + 2 * i, 5}});
  draw_dashes(whole, {&line, 1}, 1.0, 8.0, 8.0, kBlack);
  draw_dashes(pieces, parts, 1.0, 8.0, 8.0, kBlack);
  EXPECT_NEAR(area_of(whole), area_of(pieces), 1.0);
}

TEST(Canvas, PngReadsBackTheSame) {
  Canvas canvas(31, 17, 0xFFFAFBFCu);
  canvas.disc({9, 5}, 3, 0xFFD55E00u);
  const std::string path = scenes::own_file("canvas.png");
  save_picture(canvas.drawing(), path);
  const scenes::Picture picture = scenes::read_png(path);
  ASSERT_EQ(picture.width, 31);
  ASSERT_EQ(picture.height, 17);
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 31; ++x) ASSERT_EQ(picture.at(x, y), picture_of(canvas).at(x, y)) << x << ", " << y;
}

TEST(Canvas, UnwritablePathIsReported) {
  const Canvas canvas(4, 4, kWhite);
  for (const std::string& path : {testing::TempDir() + "no/such/folder/a.png", testing::TempDir()})
    expect_in(path, refusal_of([&] { save_picture(canvas.drawing(), path); }));
}

TEST(Canvas, FullDiskIsAnError) {  // the bytes fit into the stream's buffer but not on the device
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this machine";
  EXPECT_THROW(save_picture(Canvas(4, 4, kWhite).drawing(), "/dev/full"), base::InputError);
}

/// Draws the first and last code points of each encoded length, and the neighbours of excluded ranges.
TEST(Canvas, CharactersEndAtTheirLimits) {
  const auto drawn = [](const std::string& text) {
    Canvas canvas(100, 100, kWhite);
    canvas.text({10, 50}, text, {});
    EXPECT_EQ(picture_of(canvas).width, 100) << "Cairo accepts it";
    return std::get<Lettering>(canvas.drawing().shapes.back()).text;
  };
  for (const char* text : {" ", "~", "\u00a0", "\u07ff", "\u0800", "\ud7ff", "\xC3\xA4 \xE2\x82\xAC \xF0\x9F\xA4\x96",
                           "\ue000", "\ufdcf", "\ufdf0", "\ufffd", "\U00010000", "\U0001fffd", "\U0010fffd"})
    EXPECT_EQ(drawn(text), text);
  const std::pair<const char*, std::size_t> others[] = {
      {"\x1f", 1},         {"\x7f", 1},         {"\xc2\x9f", 2},     {"\xc1\xbf", 2},         {"\xe0\x9f\xbf", 3},
      {"\xed\xa0\x80", 3}, {"\xed\xbf\xbf", 3}, {"\xef\xb7\x90", 3}, {"\xef\xb7\xaf", 3},     {"\xef\xbf\xbe", 3},
      {"\xef\xbf\xbf", 3}, {"\xe2\x82", 2},     {"\xc3(", 1},        {"\xf0\x8f\xbf\xbf", 4}, {"\xf4\x90\x80\x80", 4},
      {"\xf8\x80", 2},     {"\x80", 1}};
  for (const auto& [text, marks] : others)
    EXPECT_EQ(drawn(text).substr(0, marks), std::string(marks, '?')) << drawn(text);
}

/// Number of corners of a circle: four per pixel of its radius, from 16 to 360.
TEST(Canvas, LargerCirclesHaveMoreCorners) {
  for (const auto& [radius, corners] :
       {std::pair{0.5, 16u}, {4.0, 16u}, {4.2, 16u}, {4.25, 17u}, {89.9, 359u}, {90.0, 360u}, {120.0, 360u}}) {
    Canvas canvas(400, 400, kWhite);
    canvas.disc({200, 200}, radius, kBlack);
    const auto& paths = std::get<Fill>(canvas.drawing().shapes.back()).paths;
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_EQ(paths[0].size(), corners) << radius;
  }
}

TEST(Canvas, SidesHaveLimits) {
  EXPECT_EQ(Canvas(1, 16384, kWhite).height(), 16384);
  EXPECT_EQ(Canvas(16384, 1, kWhite).width(), 16384);
  for (const auto& [width, height] : {std::pair{0, 5}, {5, 0}, {16385, 5}, {5, 16385}})
    EXPECT_DEATH(Canvas(width, height, kWhite), "a canvas of") << width << " x " << height;
}

}  // namespace
}  // namespace sf::viz
