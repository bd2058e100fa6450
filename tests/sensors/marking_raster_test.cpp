// Markings in pixels, tested by the definition: a cell is painted when its centre is in a marking.

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/lane_markings/marking_raster.h"
#include "tests/refusal.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/laneedge_trial.h"

namespace sf::trial {
namespace {

using sensors::MarkingRaster;

/// Returns true when `p` is within half the width of a piece, between its ends: exact for straight markings. @param
/// doubt within 1e-9 m of the outline
bool in_straight(const world::LaneMarking& s, glm::dvec2 p, bool& doubt) {
  const glm::dvec2 e = s.line[1] - s.line[0];
  const double size = length(e);
  const double along = dot(e, p - s.line[0]) / size;
  const double aside = std::fabs(base::cross(e, p - s.line[0])) / size - 0.5 * s.width;
  doubt = doubt || std::fabs(aside) < 1e-9 || std::fabs(along) < 1e-9 || std::fabs(along - size) < 1e-9;
  return along >= 0.0 && along <= size && aside <= 0.0;
}

glm::dvec2 centre_of(const MarkingRaster& raster, std::int64_t x, std::int64_t y) {
  return {(static_cast<double>(raster.first_column() + x) + 0.5) * raster.cell(),
          (static_cast<double>(raster.first_row() + y) + 0.5) * raster.cell()};
}

TEST(MarkingRaster, CellIsPaintedWhenItsCentreIs) {
  Chance chance(2);
  for (int round = 0; round < 20; ++round) {
    std::vector<world::LaneMarking> lane_markings;
    for (int i = 0; i < 6; ++i)
      lane_markings.push_back(marking(chance.in_square(0.5), chance.in_square(0.5), chance.between(0.004, 0.08)));
    const MarkingRaster raster(lane_markings, chance.between(0.005, 0.02), 0.1, "hand.world");
    std::size_t painted = 0;
    for (std::int64_t y = 0; y < 8 * raster.rows(); ++y)
      for (std::int64_t x = 0; x < 8 * raster.columns(); ++x) {
        bool doubt = false;
        bool expected = false;
        for (const world::LaneMarking& s : lane_markings)
          expected = in_straight(s, centre_of(raster, x, y), doubt) || expected;
        EXPECT_TRUE(doubt || raster.painted(x, y) == expected) << x << " " << y;
        painted += raster.painted(x, y) ? 1 : 0;
        EXPECT_TRUE(raster.painted(x, y) || !raster.at_end(x, y));
      }
    EXPECT_GT(painted, 100u);
  }
}

/// Dashes keep their lengths: 0.3 m painted, 0.2 m unpainted, along the pixels.
TEST(MarkingRaster, DashesHaveTrueLengths) {
  world::World world;
  add_dashes(world, {0.0, 0.005}, {5.0, 0.005}, 0.05, 0.3, 0.2);
  const MarkingRaster raster(world.lane_markings, 0.01, 0.1, "hand.world");
  for (int k = 0; k < 500; ++k) {
    const bool paint = k % 50 < 30;
    EXPECT_EQ(raster.painted(k - raster.first_column(), -raster.first_row()), paint) << k;
    EXPECT_EQ(raster.at_end(k - raster.first_column(), -raster.first_row()), paint && (k % 50 == 0 || k % 50 == 29))
        << k;
  }
}

TEST(MarkingRaster, DirectoryHoldsTheDistanceToPaint) {
  Chance chance(6);
  std::vector<world::LaneMarking> lane_markings;
  for (int i = 0; i < 4; ++i) lane_markings.push_back(marking(chance.in_square(1.5), chance.in_square(1.5), 0.02));
  const MarkingRaster raster(lane_markings, 0.01, 0.5, "hand.world");
  const auto columns = static_cast<int>(raster.columns());
  const auto rows = static_cast<int>(raster.rows());
  const auto word = [&](int x, int y) { return raster.directory()[static_cast<std::size_t>(y * columns + x)]; };
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      if ((word(x, y) & MarkingRaster::kFull) != 0) continue;
      const int d = static_cast<int>(word(x, y));
      bool at_d = false;
      for (int v = 0; v < rows; ++v)
        for (int u = 0; u < columns; ++u) {
          const int far = std::max(std::abs(u - x), std::abs(v - y));
          if ((word(u, v) & MarkingRaster::kFull) == 0) continue;
          ASSERT_GE(far, d);
          at_d = at_d || far == d;
        }
      EXPECT_TRUE(at_d);
    }
}

TEST(MarkingRaster, KeepsItsMargin) {
  const MarkingRaster raster({marking({3, 4}, {5, 4}, 0.1)}, 0.01, 0.7, "hand.world");
  EXPECT_LE(static_cast<double>(raster.first_column()) * 0.01, 3.0 - 0.7);
  EXPECT_LE(static_cast<double>(raster.first_row()) * 0.01, 3.95 - 0.7);
  EXPECT_GE(static_cast<double>(raster.first_column() + 8 * raster.columns()) * 0.01, 5.0 + 0.7);
  EXPECT_GE(static_cast<double>(raster.first_row() + 8 * raster.rows()) * 0.01, 4.05 + 0.7);
}

TEST(MarkingRaster, RejectsTooManyPixels) {
  expect_in("hand.world: road_resolution 0.001 m requires", refusal_of([] {
              const MarkingRaster raster({marking({0, 0}, {5000, 5000}, 0.1)}, 0.001, 1.0, "hand.world");
            }));
}

TEST(MarkingRaster, IsOneEmptyBlockWithoutPaint) {
  const MarkingRaster raster({}, 0.01, 1.0, "hand.world");
  EXPECT_EQ(raster.directory().size(), 1u);
  EXPECT_FALSE(raster.painted(0, 0));
}

/// The same pixels 10 000 km away, with the road translated by whole pixels.
TEST(MarkingRaster, FarFromTheOrigin) {
  constexpr double kCell = 1.0 / 128.0;
  const world::LaneMarking s = arc({0.3, 0.2}, 1.0, 0.1, 2.0, 0.1, 1e-5);
  world::LaneMarking far = s;
  for (glm::dvec2& p : far.line) p = p + glm::dvec2{1e7, -1e7};
  const MarkingRaster near_raster({s}, kCell, 0.2, "");
  const MarkingRaster far_raster({far}, kCell, 0.2, "");
  ASSERT_EQ(near_raster.columns(), far_raster.columns());
  std::size_t differ = 0;
  for (std::int64_t y = 0; y < 8 * near_raster.rows(); ++y)
    for (std::int64_t x = 0; x < 8 * near_raster.columns(); ++x)
      differ += near_raster.painted(x, y) != far_raster.painted(x, y) ? 1 : 0;
  EXPECT_LE(differ, 2u);
}

}  // namespace
}  // namespace sf::trial
