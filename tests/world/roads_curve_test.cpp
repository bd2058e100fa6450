// Smooth lines: the properties stated in curve.h, for chosen and for random way-points.

#include "world/roads/curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/random.h"

namespace sf::world {
namespace {

using Points = std::vector<glm::dvec2>;

constexpr Sampling kFine{1e-3, 1.8, 1u << 20};

/// Returns random way-points. About one in five repeats its predecessor, and turns may be arbitrarily sharp.
Points wild(std::uint32_t k) {
  Points p{{0, 0}};
  const auto n = 1 + base::random_words({7, base::RandomStream::placement, k, 0, 0}, 999)[0] % 12;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto u = base::random_uniform({7, base::RandomStream::placement, k, 0, 0}, i);
    const auto v = base::random_uniform({7, base::RandomStream::placement, k, 1, 0}, i);
    const double d = v[1] < 0.2 ? 0.0 : std::pow(10.0, -1.0 + 3.0 * u[0]);
    p.push_back(p.back() + base::rotate(2.0 * M_PI * u[1], {d, 0.0}));
  }
  return p;
}

double distance(glm::dvec2 p, const Points& line) {
  double best = INFINITY;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const glm::dvec2 d = line[i + 1] - line[i];
    const double t = std::clamp(dot(p - line[i], d) / dot(d, d), 0.0, 1.0);
    best = std::min(best, length(p - (line[i] + t * d)));
  }
  return best;
}

double angle(glm::dvec2 a, glm::dvec2 b) { return std::atan2(base::cross(a, b), dot(a, b)); }

TEST(Curve, PassesThroughEveryWayPointExactly) {
  for (std::uint32_t k = 0; k < 300; ++k) {
    const Points p = wild(k);
    const Curve curve = smooth_curve(p, kFine);
    ASSERT_EQ(curve.knots.size(), p.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
      EXPECT_EQ(curve.points[curve.knots[i]].x, p[i].x);
      EXPECT_EQ(curve.points[curve.knots[i]].y, p[i].y);
      EXPECT_GE(curve.knots[i], curve.knots[i > 0 ? i - 1 : 0]);
    }
  }
}

// The direction is continuous: finer sampling makes each turn of the polyline smaller, even at sharp corners.
TEST(Curve, DirectionIsContinuous) {
  for (std::uint32_t k = 0; k < 100; ++k) {
    const Curve curve = smooth_curve(wild(k), {1e-3, 100.0, 1u << 20});  // offset 100 m: turns of 9 mrad
    for (std::size_t i = 1; i + 1 < curve.points.size(); ++i)
      ASSERT_LT(std::abs(angle(curve.points[i] - curve.points[i - 1], curve.points[i + 1] - curve.points[i])), 0.06)
          << k;
  }
}

TEST(Curve, NeitherRunsBackwardsNorLeavesItsChord) {
  for (std::uint32_t k = 0; k < 300; ++k) {
    const Points p = wild(k);
    const Curve curve = smooth_curve(p, kFine);
    for (std::size_t i = 0; i + 1 < p.size(); ++i) {
      const double d = length(p[i + 1] - p[i]);
      if (d == 0.0) continue;
      const glm::dvec2 along = (1.0 / d) * (p[i + 1] - p[i]);
      double last = -1e-9;
      for (std::size_t j = curve.knots[i]; j <= curve.knots[i + 1]; ++j) {
        const double x = dot(curve.points[j] - p[i], along);
        EXPECT_GE(x, last - 1e-9);
        EXPECT_LE(x, d + 1e-9);
        EXPECT_LE(std::abs(base::cross(along, curve.points[j] - p[i])), 0.5 * d + 1e-9);
        last = x;
      }
    }
  }
}

TEST(Curve, NeighboursAreDistinctAndLengthsAddUp) {
  for (std::uint32_t k = 0; k < 300; ++k) {
    const Curve curve = smooth_curve(wild(k), kFine);
    for (std::size_t i = 1; i < curve.points.size(); ++i) {
      EXPECT_GT(curve.s[i], curve.s[i - 1]);
      EXPECT_NEAR(curve.s[i] - curve.s[i - 1], length(curve.points[i] - curve.points[i - 1]), 1e-9);
      EXPECT_NEAR(length(curve.tangents[i]), 1.0, 1e-12);
    }
  }
}

// The same curve sampled a hundred times finer is within the tolerance, and so is its parallel.
TEST(Curve, PolylineIsWithinTolerance) {
  for (std::uint32_t k = 0; k < 60; ++k) {
    const Points p = wild(k);
    const Curve coarse = smooth_curve(p, {1e-2, 0.5, 1u << 20});
    const Curve fine = smooth_curve(p, {1e-4, 0.5, 1u << 20});
    if (coarse.points.size() < 2) continue;
    for (std::size_t i = 0; i < fine.points.size(); i += 7) EXPECT_LE(distance(fine.points[i], coarse.points), 1e-2);
  }
}

TEST(Curve, StraightLinesStayStraight) {
  const Curve line = smooth_curve(Points{{0, 0}, {5, 0}, {6, 0}, {20, 0}}, kFine);
  for (const glm::dvec2& p : line.points) EXPECT_EQ(p.y, 0.0);
  EXPECT_EQ(line.points.size(), 4u);
  EXPECT_DOUBLE_EQ(line.s.back(), 20.0);
}

// A corner between straight lines of three points each bends only the two adjacent spans.
TEST(Curve, CornerBendsOnlyItsOwnSpans) {
  const Curve curve = smooth_curve(Points{{0, 0}, {5, 0}, {10, 0}, {10, 5}, {10, 10}}, kFine);
  for (std::size_t j = 0; j <= curve.knots[1]; ++j) EXPECT_EQ(curve.points[j].y, 0.0);
  for (std::size_t j = curve.knots[3]; j < curve.points.size(); ++j) EXPECT_EQ(curve.points[j].x, 10.0);
  const glm::dvec2 corner = curve.tangents[curve.knots[2]];
  EXPECT_NEAR(std::atan2(corner.y, corner.x), M_PI / 4, 1e-12);
}

// A long chord next to a short one that continues straight takes the whole kink of 45 degrees. Its lateral distance is
// at most a quarter of the short chord times its sine, times 1 / cos^2(90 / 4), also for the first and the last chord.
TEST(Curve, ShortChordsLimitLongOnes) {
  for (Points p : {Points{{0, 0}, {100, 0}, {100.7, 0.7}, {101.4, 1.4}},
                   Points{{-0.7, 0.7}, {0, 0}, {100, 0}, {100.7, 0.7}, {101.4, 1.4}}})
    for (int way = 0; way < 2; ++way, std::reverse(p.begin(), p.end())) {
      double worst = 0.0;
      for (const glm::dvec2& at : smooth_curve(p, kFine).points)
        if (at.x > 0.0 && at.x < 100.0) worst = std::max(worst, std::abs(at.y));
      EXPECT_LT(worst, 0.25 * 0.7 * 1.1716);
    }
}

// Equally spaced points of a circle give that circle, with the precision stated in curve.h.
TEST(Curve, CirclePointsGiveACircle) {
  const double radius = 0.93;
  Points p;
  for (int i = 0; i <= 12; ++i) p.push_back(base::rotate(i * M_PI / 6, {radius, 0.0}));
  double worst = 0.0;
  for (const glm::dvec2& at : smooth_curve(p, {1e-9, 0.0, 1u << 20}).points)
    worst = std::max(worst, std::abs(length(at) - radius) / radius);
  EXPECT_LT(worst, 1e-6);
}

// Straight line, quarter circle, straight line from few points: the thesis' test path, reproduced within millimetres.
TEST(Curve, StraightAndBend) {
  Points p{{0, 0}, {2.72, 0}};
  for (int i = 1; i <= 6; ++i)
    p.push_back(glm::dvec2{2.72, 0.93} + base::rotate(-M_PI / 2 + i * M_PI / 12, {0.93, 0.0}));
  p.push_back({3.65, 0.93 + 1.349});
  double worst = 0.0;
  for (const glm::dvec2& at : smooth_curve(p, {1e-6, 0.25, 1u << 20}).points) {
    const double off = at.x <= 2.72   ? std::abs(at.y)
                       : at.y >= 0.93 ? std::abs(at.x - 3.65)
                                      : std::abs(length(at - glm::dvec2{2.72, 0.93}) - 0.93);
    worst = std::max(worst, off);
  }
  EXPECT_LT(worst, 1e-3);
}

TEST(Curve, UnusualWayPoints) {
  EXPECT_EQ(smooth_curve(Points{{3, 4}}, kFine).points.size(), 1u);                  // one
  EXPECT_EQ(smooth_curve(Points{{3, 4}, {3, 4}, {3, 4}}, kFine).points.size(), 1u);  // one, three times
  EXPECT_EQ(smooth_curve(Points{{0, 0}, {1, 0}}, kFine).points.size(), 2u);          // two
  EXPECT_EQ(smooth_curve(Points{{0, 0}, {1, 0}, {1, 0}}, kFine).knots[2], 1u);       // last point repeated
  const Curve back = smooth_curve(Points{{0, 0}, {10, 0}, {0, 0}}, kFine);           // there and back
  EXPECT_EQ(back.points[back.knots[1]].x, 10.0);
  EXPECT_LE(smooth_curve(wild(3), {1e-12, 1e6, 500}).points.size(), 600u);  // bounded
}

TEST(Curve, ConnectionsMakeArcs) {
  const Curve quarter = connection({0, 0}, {1, 0}, {5, 5}, {0, 1}, kFine);
  for (const glm::dvec2& p : quarter.points) EXPECT_NEAR(length(p - glm::dvec2{0, 5}), 5.0, 2e-3);
  const Curve turn = connection({0, 0}, {1, 0}, {0, 4}, {-1, 0}, kFine);  // a U-turn
  for (const glm::dvec2& p : turn.points) EXPECT_NEAR(length(p - glm::dvec2{0, 2}), 2.0, 4e-2);
  EXPECT_EQ(connection({1, 2}, {1, 0}, {1, 2}, {0, 1}, kFine).points.size(), 1u);
}

// ------------------------------------------------------------------------------------------ parallels

TEST(Parallel, OfAStraight) {
  const Curve line = smooth_curve(Points{{0, 0}, {10, 0}}, kFine);
  const Points left = offset_curve(line, 2.0);
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[1].x, 10.0);
  EXPECT_EQ(left[1].y, 2.0);
  EXPECT_EQ(offset_curve(line, -2.0)[0].y, -2.0);
  EXPECT_TRUE(offset_curve(smooth_curve(Points{{0, 0}}, kFine), 1.0).empty());
}

TEST(Parallel, OfACircle) {
  Points p;
  for (int i = 0; i <= 9; ++i) p.push_back(base::rotate(i * M_PI / 18, {5.0, 0.0}));
  const Curve arc = smooth_curve(p, kFine);
  for (const glm::dvec2& at : offset_curve(arc, 1.8)) EXPECT_NEAR(length(at), 3.2, 2e-3);
  for (const glm::dvec2& at : offset_curve(arc, -1.8)) EXPECT_NEAR(length(at), 6.8, 2e-3);
}

// A bend of 1 m radius with edges at 2 m: the inner loop is removed, and the rest keeps its distance.
TEST(Parallel, LoopsInsideTightBendsAreRemoved) {
  Points p{{-10, 0}, {-5, 0}, {0, 0}};
  for (int i = 1; i <= 6; ++i) p.push_back(glm::dvec2{0, 1} + base::rotate(-M_PI / 2 + i * M_PI / 12, {1.0, 0.0}));
  p.push_back({1, 6}), p.push_back({1, 11});
  const Curve bend = smooth_curve(p, {1e-3, 2.0, 1u << 20});
  const Points inside = offset_curve(bend, 2.0);
  for (const glm::dvec2& at : inside) EXPECT_GE(distance(at, bend.points), 2.0 - 5e-3) << at.x << " " << at.y;
  for (std::size_t i = 1; i + 1 < inside.size(); ++i)
    EXPECT_GT(dot(inside[i] - inside[i - 1], inside[i + 1] - inside[i]), -1e-9) << "turned round at " << i;
  EXPECT_LT(inside.size(), bend.points.size());
}

// Boundary: a hairpin whose legs are just far enough apart to keep their parallels, measured from either leg.
TEST(Parallel, KeepsPointsAtExactlyTheTolerance) {
  const double apart = 1.0 + (1.0 - 2e-3);
  const Curve hairpin{.points = {{0, 0}, {1.5, 0}, {1.5, apart}, {0, apart}},
                      .tangents = {{1, 0}, {1, 0}, {-1, 0}, {-1, 0}},
                      .s = {0.0, 1.5, 1.5 + apart, 3.0 + apart}};
  EXPECT_EQ(offset_curve(hairpin, 1.0), (Points{{0, 1}, {0, apart - 1.0}}));
}

TEST(Parallel, NeighboursAreDistinct) {
  for (std::uint32_t k = 0; k < 200; ++k) {
    const Curve curve = smooth_curve(wild(k), kFine);
    for (const double d : {1.8, -1.8}) {
      const Points edge = offset_curve(curve, d);
      EXPECT_NE(edge.size(), 1u);
      for (std::size_t i = 1; i < edge.size(); ++i) EXPECT_GT(length(edge[i] - edge[i - 1]), 0.0);
    }
  }
}

}  // namespace
}  // namespace sf::world
