// The grid of magnets that implements the cut-off.

#include "sensors/magnetic_field/magnet_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/magnet_scenes.h"

namespace sf::trial {
namespace {

/// Expects every magnet within reach to be in some span, and spans to be ordered and disjoint.
void expect_found(std::span<const glm::dvec2> magnets, const sensors::MagnetGrid& grid, glm::dvec2 centre,
                  double reach) {
  std::vector<sensors::MagnetSpan> spans(grid.most_spans(reach));
  spans.resize(grid.find(centre, reach, spans));
  std::vector<bool> found(magnets.size(), false);
  std::uint32_t before = 0;
  for (const sensors::MagnetSpan& span : spans) {
    ASSERT_LT(span.first, span.end);
    ASSERT_GE(span.first, before);
    before = span.end;
    for (std::uint32_t i = span.first; i < span.end; ++i) found[grid.order()[i]] = true;
  }
  for (std::size_t i = 0; i < magnets.size(); ++i) {
    if (glm::length(magnets[i] - centre) <= reach) {
      EXPECT_TRUE(found[i]) << "magnet " << i;
    }
  }
}

TEST(MagnetGrid, FindsAllNearMagnets) {
  Chance chance(1);
  for (int round = 0; round < 60; ++round) {
    const double offset = round % 3 == 0 ? 1e5 : 0.0;
    const double cutoff = std::pow(10.0, chance.between(-3, 2));
    std::vector<glm::dvec2> magnets;
    const auto count = chance.below(300);
    for (std::uint32_t i = 0; i < count; ++i)
      magnets.push_back(glm::dvec2{offset, offset} + chance.in_square(round % 2 == 0 ? 10.0 : 0.01));
    sensors::MagnetGrid grid;
    grid.build(magnets, cutoff, 1 << (round % 12));
    for (int i = 0; i < 30; ++i) {
      const glm::dvec2 centre = glm::dvec2{offset, offset} + chance.in_square(12.0);
      expect_found(magnets, grid, centre, cutoff);
      if (count > 0) expect_found(magnets, grid, magnets[chance.below(count)], cutoff);
    }
  }
}

/// A magnet at exactly the reach, in each direction. Points also lie on cell borders.
TEST(MagnetGrid, FindsMagnetsAtTheRim) {
  for (const double offset : {0.0, 1e5}) {
    std::vector<glm::dvec2> magnets;
    for (int i = -8; i <= 8; ++i)
      for (int j = -8; j <= 8; ++j) magnets.push_back({offset + 0.25 * i, offset + 0.25 * j});
    sensors::MagnetGrid grid;
    grid.build(magnets, 1.0, 1 << 20);
    for (const glm::dvec2& centre : magnets) expect_found(magnets, grid, centre, 1.0);
  }
}

TEST(MagnetGrid, FindsFewOtherMagnets) {
  const world::World world = scenes::sheet(40'000, 200.0, 3);
  std::vector<glm::dvec2> magnets;
  for (const world::Magnet& m : world.magnets) magnets.push_back(m.p);
  sensors::MagnetGrid grid;
  grid.build(magnets, 10.0, 1 << 20);
  std::vector<sensors::MagnetSpan> spans(grid.most_spans(10.0));
  Chance chance(4);
  double found = 0;
  for (int i = 0; i < 100; ++i) {
    const auto count = grid.find(chance.in_square(80.0), 10.0, spans);
    for (std::uint32_t s = 0; s < count; ++s) found += spans[s].end - spans[s].first;
  }
  EXPECT_LT(found / 100, 1.25 * M_PI * 100.0) << "314 are within 10 m";
}

/// Room for the spans of a search: the rows that it crosses, plus one at each end, and never more than there are.
TEST(MagnetGrid, NeedsRoomForTheRowsItCrosses) {
  std::vector<glm::dvec2> magnets;
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) magnets.push_back({1.0 * i, 1.0 * j});
  sensors::MagnetGrid grid;
  for (const std::size_t most : {1u, 4u, 1u << 20}) {
    grid.build(magnets, 1.0, most);
    const std::uint32_t rows = grid.most_spans(1e6), few = grid.most_spans(1.0);
    EXPECT_LE(rows, std::max<std::size_t>(most, 1)) << "as many rows as cells at most";
    EXPECT_LE(few, rows);
    for (const glm::dvec2& centre : {glm::dvec2{31.5, 31.5}, {0, 0}, {63, 63}})
      expect_found(magnets, grid, centre, 40.0);
  }
  EXPECT_GT(grid.most_spans(20.0), grid.most_spans(1.0));
  grid.build(magnets, 0.0, 100);
  EXPECT_EQ(grid.most_spans(1e6), 1u) << "without a cut-off all are one span";
}

TEST(MagnetGrid, HandlesNoMagnets) {
  sensors::MagnetGrid grid;
  EXPECT_EQ(grid.most_spans(1.0), 0u) << "before it is built";
  for (const double cutoff : {0.0, 1.0}) {
    grid.build({}, cutoff, 100);
    EXPECT_EQ(grid.find({0, 0}, 1.0, {}), 0u);
  }
}

}  // namespace
}  // namespace sf::trial
