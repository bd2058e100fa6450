#include "viz/color.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace sf::viz {
namespace {

double distance(std::uint32_t a, std::uint32_t b) {
  const OklabColor p = to_oklab(a);
  const OklabColor q = to_oklab(b);
  return std::hypot(p.lightness - q.lightness, p.a - q.a, p.b - q.b);
}

TEST(Color, LabOfKnownColours) {  // values from the table in the definition: white, and red
  EXPECT_NEAR(to_oklab(0xFFFFFFFFu).lightness, 1.0, 1e-4);
  EXPECT_NEAR(to_oklab(0xFF000000u).lightness, 0.0, 1e-9);
  const OklabColor red = to_oklab(0xFFFF0000u);
  EXPECT_NEAR(red.lightness, 0.628, 1e-3);
  EXPECT_NEAR(red.a, 0.225, 1e-3);
  EXPECT_NEAR(red.b, 0.126, 1e-3);
}

TEST(Color, NeighboursLookUnlike) {  // robots in adjacent rows: 0.02 is just visible
  for (std::size_t i = 0; i < 300; ++i)
    for (std::size_t k = 1; k <= 8; ++k)
      EXPECT_GT(distance(distinct(i), distinct(i + k)), 0.06) << i << " and " << i + k;
}

TEST(Color, DistinctColoursStandOutFromWhite) {
  for (std::size_t i = 0; i < 300; ++i) EXPECT_LT(to_oklab(distinct(i)).lightness, 0.72) << i;
}

TEST(Color, RowsDiffer) {
  for (const std::size_t count : {1u, 2u, 7u, 8u, 20u, 100u}) {
    std::set<std::uint32_t> seen;
    for (std::size_t i = 0; i < count; ++i) seen.insert(row_color(i, count));
    EXPECT_EQ(seen.size(), count);
  }
}

/// Up to seven rows have named colours; more rows do not shift them.
TEST(Color, SevenRowsHaveAPalette) {
  for (const std::size_t count : {1u, 6u, 7u})
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(row_color(i, count), row_color(i, 1 + i)) << i << " of " << count;
  EXPECT_EQ(row_color(0, 7), 0xFF0072B2u);
  EXPECT_EQ(row_color(6, 7), 0xFF000000u);
  EXPECT_EQ(row_color(7, 8), distinct(7));
  EXPECT_EQ(row_color(7, 100), distinct(7));
}

TEST(Color, MixEnds) {
  EXPECT_EQ(mix(0xFF102030u, 0xFF405060u, 0.0), 0xFF102030u);
  EXPECT_EQ(mix(0xFF102030u, 0xFF405060u, 1.0), 0xFF405060u);
  EXPECT_EQ(with_opacity(0xFF102030u, 0.0), 0x00102030u);
  EXPECT_EQ(with_opacity(0x00102030u, 1.0), 0xFF102030u);
}

}  // namespace
}  // namespace sf::viz
