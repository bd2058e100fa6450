// Order and names of a sensor's elements in figures.

#include "apps/options/reading_elements.h"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/options/robot_names.h"

namespace sf::apps {
namespace {

SensorElements elements_at(const std::vector<double>& degrees) {
  SensorElements elements;
  for (const double angle : degrees) elements.bearings.push_back(angle * M_PI / 180.0);
  return elements;
}

using Rows = std::vector<std::size_t>;

TEST(ReadingElements, RowsFollowBearingsFromTheLeft) {
  const auto rows = [](const std::vector<double>& degrees, std::size_t every = 1) {
    return element_rows(elements_at(degrees), degrees.size(), every);
  };
  EXPECT_EQ(rows({-90, 0, 90}), (Rows{2, 1, 0})) << "a scan: counterclockwise";
  EXPECT_EQ(rows({90, 0, -90}), (Rows{0, 1, 2}));
  EXPECT_EQ(rows({0, 90, 180, 270}), (Rows{2, 1, 0, 3})) << "a ring: 270° is \u221290°";
  EXPECT_EQ(rows({90, 0, -90, -180, -270}), (Rows{3, 0, 4, 1, 2})) << "\u2212180° is 180°; equal ones by number";
  EXPECT_EQ(rows({30, -30, 10, -10}), (Rows{0, 2, 3, 1})) << "in any order of elements";
  EXPECT_EQ(rows({-90, -45, 0, 45, 90}, 2), (Rows{4, 2, 0})) << "every second element";
  EXPECT_EQ(element_rows({}, 3, 1), (Rows{0, 1, 2})) << "without bearings by number";
}

TEST(ReadingElements, BearingsAreWithinHalfATurn) {
  const SensorElements elements = elements_at({0.0, -45.0, 270.0, -180.0, 7.55, -0.001});
  const char* const names[] = {"0°", "\u221245°", "\u221290°", "180°", "7.6°", "0°", "6"};
  for (std::size_t e = 0; e < std::size(names); ++e) EXPECT_EQ(bearing_name(elements, e), names[e]);
}

TEST(RobotNames, TheLongestKnownNameIsTaken) {
  constexpr std::string_view known[] = {"a", "a,b", "b", "c, d", ",", "a,b,c"};
  using Names = std::vector<std::string>;
  EXPECT_EQ(robot_names({}, known), Names{});
  EXPECT_EQ(robot_names({"a"}, known), Names{"a"});
  EXPECT_EQ(robot_names({"a,b"}, known), Names{"a,b"});
  EXPECT_EQ(robot_names({"b,a"}, known), (Names{"b", "a"}));
  EXPECT_EQ(robot_names({"a,b,b"}, known), (Names{"a,b", "b"}));
  EXPECT_EQ(robot_names({"a", "b"}, known), (Names{"a", "b"})) << "repeated options";
  EXPECT_EQ(robot_names({"a,c, d"}, known), (Names{"a", "c, d"}));
  EXPECT_EQ(robot_names({"ab,a"}, known), (Names{"ab", "a"})) << "unknown: up to its comma";
  EXPECT_EQ(robot_names({"a,bc"}, known), (Names{"a", "bc"})) << "no part of a name";
  EXPECT_EQ(robot_names({"a,"}, known), (Names{"a", ""}));
  EXPECT_EQ(robot_names({"x,y"}, {}), (Names{"x", "y"}));
}

}  // namespace
}  // namespace sf::apps
