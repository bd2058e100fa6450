#include "control/contact_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sf::control {
namespace {

constexpr double kRadius = 0.165;

/// Follows the way in steps of 2 cm. @return its length [m]; infinite if it does not arrive
double drive(const ContactMap& map, glm::dvec2 p, const glm::dvec2& goal) {
  for (int k = 0; k < 1000; ++k) {
    if (glm::distance(p, goal) < 0.05) return 0.02 * k;
    EXPECT_FALSE(map.is_near(p, kRadius - 0.01)) << p.x << ", " << p.y;
    const glm::dvec2 to = map.next(p) - p;
    p += std::min(0.02 / std::max(glm::length(to), 1e-9), 1.0) * to;
  }
  return HUGE_VAL;
}

TEST(ContactMap, LeadsStraightToTheGoalWithoutPoints) {
  ContactMap map(kRadius);
  const glm::dvec2 goal{0.0, 0.0}, start{2.0, 1.0};
  map.plan(start, {&goal, 1});
  EXPECT_NEAR(drive(map, start, goal), std::sqrt(5.0), 0.2);
}

TEST(ContactMap, LeadsAroundAWallOfPoints) {
  ContactMap map(kRadius);
  for (double y = -0.5; y <= 0.5; y += 0.1) map.add({1.0, y});
  const glm::dvec2 goal{0.0, 0.0}, start{2.0, 0.0};
  map.plan(start, {&goal, 1});
  const double length = drive(map, start, goal);
  EXPECT_GT(length, 2.3);
  EXPECT_LT(length, 2.9);
}

TEST(ContactMap, PrefersTheNearestGoal) {
  ContactMap map(kRadius);
  const glm::dvec2 goals[] = {{0.0, 0.0}, {3.0, 0.0}};
  map.plan({2.0, 0.0}, goals);
  EXPECT_GT(map.next({2.0, 0.0}).x, 2.0);
}

// A grid around a robot a thousand kilometres away would not fit any memory.
TEST(ContactMap, IsBounded) {
  ContactMap map(kRadius);
  const glm::dvec2 goal{0.0, 0.0};
  map.add({1e6, -1e6});
  map.plan({1e6, -1e6}, {&goal, 1});
  EXPECT_LE(std::abs(map.next({1e6, -1e6}).x), ContactMap::kMostExtent + 0.1);
}

// A robot that is nearer to a point than its radius still gets a way, out of the blocked cells.
TEST(ContactMap, LeadsOutOfBlockedCells) {
  ContactMap map(kRadius);
  map.add({1.0, 0.0});
  const glm::dvec2 goal{0.0, 0.0}, start{1.1, 0.0};
  map.plan(start, {&goal, 1});
  EXPECT_NE(map.next(start), start);
}

}  // namespace
}  // namespace sf::control
