#include "base/tuple_text.h"

#include <gtest/gtest.h>

namespace sf::base {
namespace {

TEST(TupleText, CountsTheNumbersOfTheLongestTuple) {
  EXPECT_EQ(numbers_in("[x]"), 1u);
  EXPECT_EQ(numbers_in("[x y yaw]"), 3u);
  EXPECT_EQ(numbers_in("[k1 k2 p1 p2], [k1 k2 p1 p2 k3] or more"), 5u);
  EXPECT_EQ(numbers_in("[min max] in volts"), 2u) << "units do not count";
  EXPECT_GT(numbers_in("[x y x y ...], at least two"), 1'000'000u) << "any number";
  EXPECT_GT(numbers_in("one elevation per channel"), 1'000'000u) << "no tuple";
  EXPECT_EQ(numbers_in("[x y"), 2u) << "not closed";
}

}  // namespace
}  // namespace sf::base
