#include "viz/paths.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/units.h"

namespace sf::viz {
namespace {

constexpr PathBox kBox{{0.0, 0.0}, {10.0, 10.0}};

double area_within(const Paths& outlines) {
  double sum = 0.0;
  for (const auto& outline : outlines)
    for (std::size_t i = 0; i < outline.size(); ++i)
      sum += 0.5 * base::cross(outline[i], outline[(i + 1) % outline.size()]);
  return sum;
}

TEST(Paths, LinesThatMeetFormOnePath) {
  const Line lines[] = {{{1, 1}, {2, 2}}, {{2, 2}, {3, 1}}, {{5, 5}, {6, 6}}};
  const Paths paths = cut_lines(lines, kBox);
  ASSERT_EQ(paths.size(), 2u);
  EXPECT_EQ(paths[0].size(), 3u);
  EXPECT_EQ(paths[1].size(), 2u);
}

TEST(Paths, LinesAreClippedToTheBox) {
  const Line lines[] = {{{-5, 5}, {15, 5}},       // through both sides
                        {{-5, -1}, {15, -1}},     // outside of it
                        {{-1, 2}, {2, -1}},       // across a corner
                        {{-1, 0.5}, {0.5, -1}}};  // past the corner
  const Paths paths = cut_lines(lines, kBox);
  ASSERT_EQ(paths.size(), 2u);
  EXPECT_EQ(paths[0].front(), glm::dvec2(0, 5));
  EXPECT_EQ(paths[0].back(), glm::dvec2(10, 5));
  EXPECT_EQ(paths[1].front(), glm::dvec2(0, 1));
  EXPECT_EQ(paths[1].back(), glm::dvec2(1, 0));
}

TEST(Paths, TheBordersBelongToTheBox) {
  const Line lines[] = {{{2, 10}, {8, 10}}, {{0, 8}, {0, 2}}, {{2, 0}, {8, 0}}, {{10, 2}, {10, 8}}};
  for (const Line& line : lines) EXPECT_EQ(cut_lines({&line, 1}, kBox), (Paths{{line.a, line.b}}));
  const Line corner{{-1, 1}, {1, -1}};
  EXPECT_EQ(cut_lines({&corner, 1}, kBox), (Paths{{{0, 0}}})) << "touches it";
}

TEST(Paths, ADotIsAPathOfOnePoint) {
  const Line inside{{5, 5}, {5, 5}}, outside{{50, 5}, {50, 5}};
  EXPECT_EQ(cut_lines({&inside, 1}, kBox), (Paths{{{5, 5}}}));
  EXPECT_TRUE(cut_lines({&outside, 1}, kBox).empty());
}

TEST(Paths, NumbersThatAreNotFiniteAreSkipped) {
  const Line lines[] = {{{kNaN, 1}, {2, 2}}, {{1, 1}, {2, -kInf}}};
  EXPECT_TRUE(cut_lines(lines, kBox).empty());
  EXPECT_TRUE(join_edges(lines).empty());
}

TEST(Paths, EdgesInAnyOrderFormTheirOutlines) {
  std::vector<Line> edges;
  for (const double d : {0.0, 3.0}) {
    const glm::dvec2 p[] = {{1 + d, 1}, {2 + d, 1}, {2 + d, 2}, {1 + d, 2}};
    for (int i = 0; i < 4; ++i) edges.push_back({p[i], p[(i + 1) % 4]});
  }
  std::sort(edges.begin(), edges.end(),
            [](const Line& a, const Line& b) { return a.a.x + 3 * a.b.y < b.a.x + 3 * b.b.y; });
  const Paths outlines = join_edges(edges);
  ASSERT_EQ(outlines.size(), 2u);
  for (const auto& outline : outlines) EXPECT_EQ(outline.size(), 4u);
  EXPECT_DOUBLE_EQ(area_within(outlines), 2.0);
}

TEST(Paths, OutlinesTouchingInAPointKeepTheirArea) {  // two edges begin at (2, 2): either may follow
  const glm::dvec2 p[] = {{1, 1}, {2, 1}, {2, 2}, {1, 2}}, q[] = {{2, 2}, {3, 2}, {3, 3}, {2, 3}};
  std::vector<Line> edges;
  for (int i = 0; i < 4; ++i) edges.insert(edges.end(), {{p[i], p[(i + 1) % 4]}, {q[i], q[(i + 1) % 4]}});
  EXPECT_DOUBLE_EQ(area_within(join_edges(edges)), 2.0);
}

/// A clipped outline is kept if it has at least two points. An outline inside the box, borders included, is unchanged.
TEST(Paths, CutOutlinesKeepTwoPoints) {
  const std::vector<glm::dvec2> bar{{2, 5}, {8, 5}}, across{{5, 5}, {15, 5}}, dot{{5, 5}}, outside{{11, 1}, {12, 1}};
  EXPECT_EQ(cut_outlines({bar}, kBox), (Paths{bar}));
  EXPECT_TRUE(cut_outlines({dot, outside, {}}, kBox).empty());
  const Paths cut = cut_outlines({across}, kBox);
  ASSERT_EQ(cut.size(), 1u);
  for (const glm::dvec2& p : cut[0]) EXPECT_TRUE(p.x >= 5 && p.x <= 10 && p.y == 5);
  const std::vector<glm::dvec2> whole{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  EXPECT_EQ(cut_outlines({whole}, kBox), (Paths{whole}));
}

/// The part of a rectangle in the box is the intersection of both, for any rectangle.
RC_GTEST_PROP(Paths, CutOutlinesKeepTheAreaInside, ()) {
  const auto side = [] { return *rc::gen::inRange(-200, 200) / 10.0; };
  const double x0 = side(), y0 = side(), wide = std::abs(side()), high = std::abs(side());
  const Paths cut = cut_outlines({{{x0, y0}, {x0 + wide, y0}, {x0 + wide, y0 + high}, {x0, y0 + high}}}, kBox);
  const auto common = [](double from, double to) { return std::max(0.0, std::min(to, 10.0) - std::max(from, 0.0)); };
  RC_ASSERT(std::abs(area_within(cut) - common(x0, x0 + wide) * common(y0, y0 + high)) < 1e-9);
  for (const auto& outline : cut)
    for (const glm::dvec2& p : outline) RC_ASSERT(p.x >= -1e-9 && p.x <= 10 + 1e-9 && p.y >= -1e-9 && p.y <= 10 + 1e-9);
}

}  // namespace
}  // namespace sf::viz
