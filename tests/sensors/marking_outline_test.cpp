// The outline of a marking, tested by its definition: the band within half the width of its line.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sensors/lane_markings/outline.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/laneedge_trial.h"

namespace sf::trial {
namespace {

using sensors::OutlineEdge;

std::vector<OutlineEdge> reflectors_of(const world::LaneMarking& s) {
  std::vector<OutlineEdge> outline;
  sensors::add_outline(s, outline);
  return outline;
}

/// Returns the signed area [m^2] of closed outlines, counter-clockwise positive.
double area(const std::vector<OutlineEdge>& outline) {
  double twice = 0.0;
  for (const OutlineEdge& f : outline) twice += base::cross(f.a, f.b);
  return 0.5 * twice;
}

/// Expects every edge's end to be another edge's start, in equal doubles.
void expect_closed(const std::vector<OutlineEdge>& outline) {
  for (const OutlineEdge& f : outline) {
    const auto follows = [&](const OutlineEdge& g) { return g.a.x == f.b.x && g.a.y == f.b.y; };
    EXPECT_EQ(std::count_if(outline.begin(), outline.end(), follows), 1);
  }
}

double distance_to_line(const std::vector<glm::dvec2>& line, glm::dvec2 p) {
  double least = 1e300;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const glm::dvec2 e = line[i + 1] - line[i];
    const double u = std::clamp(dot(e, p - line[i]) / dot(e, e), 0.0, 1.0);
    least = std::min(least, length(p - (line[i] + u * e)));
  }
  return least;
}

TEST(PaintFaces, StraightStripeIsARectangle) {
  const auto outline = reflectors_of(marking({1, 2}, {4, 2}, 0.5));
  ASSERT_EQ(outline.size(), 4u);
  expect_closed(outline);
  EXPECT_DOUBLE_EQ(area(outline), 1.5);
  EXPECT_EQ(std::count_if(outline.begin(), outline.end(), [](const OutlineEdge& f) { return f.is_end; }), 2);
  for (const OutlineEdge& f : outline) {
    EXPECT_EQ(f.is_end, f.a.x == f.b.x);
    EXPECT_TRUE(f.is_solid);
  }
}

/// At the limit of a right angle, a mitre is 1.41 half widths long. The edges next to it stay half a width off the
/// line.
TEST(PaintFaces, BendsAreMitred) {
  Chance chance(4);
  for (int round = 0; round < 200; ++round) {
    world::LaneMarking s;
    s.width = chance.between(0.02, 0.3);
    double heading = chance.between(-M_PI, M_PI);
    glm::dvec2 at = chance.in_square(10.0);
    for (int i = 0; i < 6; ++i) {
      s.line.push_back(at);
      at = at + chance.between(1.0, 2.0) * glm::dvec2{std::cos(heading), std::sin(heading)};
      heading += chance.between(-1.5, 1.5);
    }
    const auto outline = reflectors_of(s);
    ASSERT_EQ(outline.size(), 2 * (s.line.size() - 1) + 2);
    expect_closed(outline);
    for (const OutlineEdge& f : outline) {
      if (f.is_end) {
        EXPECT_NEAR(length(f.b - f.a), s.width, 1e-12);
        continue;
      }
      // Between the mitres of its ends, an edge is half a width off a straight piece: certainly at its middle third.
      bool parallel = false;
      for (std::size_t i = 0; i + 1 < s.line.size(); ++i) {
        const glm::dvec2 e = s.line[i + 1] - s.line[i];
        parallel =
            parallel || (std::fabs(base::cross(e, f.b - f.a)) < 1e-9 &&
                         std::fabs(std::fabs(base::cross(e, f.a - s.line[i])) / length(e) - 0.5 * s.width) < 1e-9);
      }
      EXPECT_TRUE(parallel);
    }
  }
}

TEST(PaintFaces, PaintIsOnTheLeft) {
  Chance chance(9);
  for (int round = 0; round < 100; ++round) {
    const world::LaneMarking s =
        arc({0, 0}, chance.between(0.5, 3.0), chance.between(-3, 0), chance.between(0.5, 3), 0.1, 1e-4);
    for (const OutlineEdge& f : reflectors_of(s)) {
      const glm::dvec2 middle = 0.5 * (f.a + f.b);
      const glm::dvec2 e = (1.0 / length(f.b - f.a)) * (f.b - f.a);
      const glm::dvec2 inside = middle + 1e-4 * glm::dvec2{-e.y, e.x};
      const glm::dvec2 outside = middle - 1e-4 * glm::dvec2{-e.y, e.x};
      const double reach = 0.05;
      EXPECT_LT(distance_to_line(s.line, inside), f.is_end ? 0.06 : reach);
      EXPECT_GT(distance_to_line(s.line, outside), f.is_end ? 0.0 : reach);
    }
  }
}

TEST(PaintFaces, ClosedLineHasNoEnds) {
  world::LaneMarking s = arc({1, 1}, 2.0, 0.0, 2.0 * M_PI, 0.1, 1e-3);
  s.line.back() = s.line.front();
  const auto outline = reflectors_of(s);
  EXPECT_EQ(std::count_if(outline.begin(), outline.end(), [](const OutlineEdge& f) { return f.is_end; }), 0);
  expect_closed(outline);
  EXPECT_NEAR(area(outline), 2.0 * M_PI * 2.0 * 0.1, 0.005);
}

/// A band wider than its bend: the inner side runs backward, and the painted side is undefined.
TEST(PaintFaces, BandWiderThanItsBendIsNotSolid) {
  const auto outline = reflectors_of(arc({0, 0}, 0.1, 0.0, 2.0, 0.3, 1e-3));
  for (const OutlineEdge& f : outline) EXPECT_FALSE(f.is_solid);
}

TEST(PaintFaces, RemovesDuplicateStripes) {
  const world::LaneMarking s = arc({0, 0}, 2.0, 0.0, 1.0, 0.1, 1e-3);
  world::LaneMarking turned = s;
  std::reverse(turned.line.begin(), turned.line.end());
  world::LaneMarking nearly = s;
  for (glm::dvec2& p : nearly.line) p.x += 5e-5;
  world::LaneMarking shifted = s;
  for (glm::dvec2& p : shifted.line) p.x += 0.2;
  world::LaneMarking wider = s;
  wider.width = 0.15;
  EXPECT_EQ(sensors::distinct_markings(std::vector{s, turned, nearly, s}).size(), 1u);
  EXPECT_EQ(sensors::distinct_markings(std::vector{s, shifted, wider}).size(), 3u);
}

}  // namespace
}  // namespace sf::trial
