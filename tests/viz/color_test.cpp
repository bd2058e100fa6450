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

TEST(Color, LabOfKnownColours) {  // from the definition's own table: white, and red
  EXPECT_NEAR(to_oklab(0xFFFFFFFFu).lightness, 1.0, 1e-4);
  EXPECT_NEAR(to_oklab(0xFF000000u).lightness, 0.0, 1e-9);
  const OklabColor red = to_oklab(0xFFFF0000u);
  EXPECT_NEAR(red.lightness, 0.628, 1e-3);
  EXPECT_NEAR(red.a, 0.225, 1e-3);
  EXPECT_NEAR(red.b, 0.126, 1e-3);
}

TEST(Color, RampLightensEvenly) {  // the lightness, as seen in grey or with colour blindness
  for (int i = 0; i < 100; ++i) {
    const double from = to_oklab(ramp(i / 100.0)).lightness;
    const double to = to_oklab(ramp((i + 1) / 100.0)).lightness;
    EXPECT_NEAR(to - from, 0.005, 0.003) << i;
  }
}

TEST(Color, RampStepsAreAlike) {
  double smallest = 1.0;
  double largest = 0.0;
  for (int i = 0; i < 20; ++i) {
    const double step = distance(ramp(i / 20.0), ramp((i + 1) / 20.0));
    smallest = std::min(smallest, step);
    largest = std::max(largest, step);
  }
  EXPECT_LT(largest, 2.0 * smallest);
}

TEST(Color, RampStandsOutFromWhite) {
  for (int i = 0; i <= 100; ++i) EXPECT_LT(to_oklab(ramp(i / 100.0)).lightness, 0.81);
}

TEST(Color, RampStopsAtItsEnds) {
  EXPECT_EQ(ramp(-1.0), ramp(0.0));
  EXPECT_EQ(ramp(2.0), ramp(1.0));
}

TEST(Color, RowsDiffer) {
  for (const std::size_t count : {1u, 2u, 7u, 8u, 20u, 100u}) {
    std::set<std::uint32_t> seen;
    for (std::size_t i = 0; i < count; ++i) seen.insert(row_color(i, count));
    EXPECT_EQ(seen.size(), count);
  }
}

/// Up to seven rows have distinct named colours, more have the ramp from end to end.
TEST(Color, SevenRowsHaveAPaletteAndMoreARamp) {
  for (const std::size_t count : {1u, 6u, 7u})
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(row_color(i, count), row_color(i, 1 + i)) << i << " of " << count;
  EXPECT_EQ(row_color(0, 7), 0xFF0072B2u);
  EXPECT_EQ(row_color(6, 7), 0xFF000000u);
  for (const std::size_t count : {8u, 100u}) {
    EXPECT_EQ(row_color(0, count), ramp(0.0)) << count;
    EXPECT_EQ(row_color(count / 2, count), ramp(static_cast<double>(count / 2) / static_cast<double>(count - 1)));
    EXPECT_EQ(row_color(count - 1, count), ramp(1.0)) << count;
  }
}

TEST(Color, MixEnds) {
  EXPECT_EQ(mix(0xFF102030u, 0xFF405060u, 0.0), 0xFF102030u);
  EXPECT_EQ(mix(0xFF102030u, 0xFF405060u, 1.0), 0xFF405060u);
  EXPECT_EQ(with_opacity(0xFF102030u, 0.0), 0x00102030u);
  EXPECT_EQ(with_opacity(0x00102030u, 1.0), 0xFF102030u);
}

}  // namespace
}  // namespace sf::viz
