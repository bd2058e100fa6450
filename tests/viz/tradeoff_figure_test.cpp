#include "viz/tradeoff_figure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/pose.h"
#include "tests/viz/png.h"

namespace sf::viz {
namespace {

constexpr std::uint32_t kFront = 0xFF0072B2u, kBeaten = 0xFF909090u, kCovered = 0xFFD55E00u;

TradeoffPoint point(const char* name, double rate, double error, bool front) {
  return {name, rate, error / 10.0, error, 10.0 * error, front, {}};
}

scenes::Picture drawn(const std::vector<TradeoffPoint>& points) {
  const TradeoffPanel panel{"laser", "rays per second", "error [m]", points};
  draw_tradeoff("Title", "subtitle", {&panel, 1}, scenes::own_file("tradeoff.png"));
  return scenes::read_png(scenes::own_file("tradeoff.png"));
}

/// Returns the centre of all pixels of one colour.
glm::dvec2 middle_of(const scenes::Picture& p, std::uint32_t color) {
  double x = 0.0, y = 0.0, count = 0.0;
  for (int column = 0; column < p.width; ++column)
    for (int row = 0; row < p.height; ++row)
      if (p.count(color, column, row, column + 1, row + 1) > 0) x += column, y += row, ++count;
  return {x / count, y / count};
}

TEST(TradeoffFigure, FasterIsHigherAndWorseIsFartherRight) {
  const scenes::Picture p = drawn({point("slow", 1e6, 1e-6, false), point("fast", 3e6, 1e-3, true)});
  const glm::dvec2 slow = middle_of(p, kBeaten), fast = middle_of(p, kFront);
  EXPECT_GT(fast.x, slow.x + 200.0) << "three decades";
  EXPECT_LT(fast.y, slow.y - 150.0) << "three times as fast";
}

TEST(TradeoffFigure, ZeroErrorHasASeparateColumn) {
  const scenes::Picture p = drawn({{"exact", 1e6, 0.0, 0.0, 0.0, true, {}}, point("other", 2e6, 1e-3, false)});
  EXPECT_LT(middle_of(p, kFront).x, 300.0);
  EXPECT_GT(middle_of(p, kBeaten).x, 300.0);
}

TEST(TradeoffFigure, InfiniteErrorsStayOnThePicture) {
  const scenes::Picture p = drawn({{"blind", 1e6, 0.0, 1e-3, HUGE_VAL, true, {}}});
  EXPECT_GT(p.count(kFront, 0, 0, p.width, p.height), 50);
}

/// A bound has a separate mark at its value, and no mark if no element is covered, so it is never shown for errors to
/// which it does not apply.
TEST(TradeoffFigure, ABoundHasASeparateMark) {
  TradeoffPoint skip = point("skip", 2e6, 0.1, true);
  skip.covered = {0.25, 1e-9, 1e-8};
  const scenes::Picture p = drawn({skip});
  const glm::dvec2 bound = middle_of(p, kCovered), errors = middle_of(p, kFront);
  EXPECT_LT(bound.x, errors.x - 400.0) << "seven decades";
  EXPECT_NEAR(bound.y, errors.y, 3.0) << "of the same mode";
  EXPECT_EQ(drawn({point("skip", 2e6, 0.1, true)}).count(kCovered), 0);
}

/// The bound of `exact` is a decade to the right of its error, at the default position of its name.
TEST(TradeoffFigure, NamesLeaveTheMarksFree) {
  TradeoffPoint exact = point("exact", 2e6, 1e-9, true), far = exact;
  exact.covered = {0.5, 1e-10, 1e-8};
  far.covered = {0.5, 1e-10, 1e-2};
  const TradeoffPoint other = point("other", 1e6, 1e-2, false);  // the axis is the same for both
  const auto marks = [&](const TradeoffPoint& p) { return drawn({p, other}).count(kCovered); };
  EXPECT_NEAR(marks(exact), marks(far), 4) << "neither is hidden";
}

}  // namespace
}  // namespace sf::viz
