#include "viz/heading.h"

#include <gtest/gtest.h>

#include <cmath>

#include "viz/legend.h"

namespace sf::viz {
namespace {

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : " ") + line;
  return text;
}

const std::string kSubtitle =
    "8 robots, 6 lasers, 220 wall segments, 106 stripes, 413 magnets, 7 lights, 12.04 m x 8.04 m";

TEST(Heading, LongTextsTakeMoreLinesAndLoseNoWord) {
  for (const double width : {300.0, 500.0, 5000.0}) {
    const Heading heading = make_heading("Trajectories of all", kSubtitle, width, {});
    EXPECT_EQ(joined(heading.subtitle), kSubtitle) << width;
    EXPECT_EQ(joined(heading.title), "Trajectories of all") << width;
    TextStyle style = small_text();
    style.size = 19;
    for (const std::string& line : heading.subtitle) EXPECT_LE(text_size(line, style).x, width) << line;
  }
  EXPECT_EQ(make_heading("", kSubtitle, 5000.0, {}).subtitle.size(), 1u);
}

TEST(Heading, AWordWiderThanTheFigureIsShortened) {
  const Heading heading = make_heading(std::string(400, 'M'), "", 300.0, {});
  ASSERT_EQ(heading.title.size(), 1u);
  EXPECT_TRUE(heading.title[0].ends_with("MMM..."));
  EXPECT_LT(heading.title[0].size(), 20u);
}

/// Numbered names differ in their ends.
TEST(Heading, ShortenedNamesKeepTheirNumbers) {
  const TextStyle style = small_text();
  for (const auto& [name, end] : {std::pair{"one_robot_with_a_long_name 15", "... 15"},
                                  {"one_robot_with_a_long_name sensor 1", "... sensor 1"},
                                  {"one_robot_with_a_long_name 3 x", "... x"},
                                  {"one_robot_with a_long_name", "..."}}) {
    const std::string fitted = fitted_name(name, style, 160.0);
    EXPECT_TRUE(fitted.starts_with("one") && fitted.ends_with(end)) << fitted;
    EXPECT_LE(text_size(fitted, style).x, 160.0) << fitted;
    EXPECT_EQ(fitted_name(name, style, 1000.0), name);
  }
}

TEST(Heading, TextsAsWideAsTheFigureAreNotShortened) {
  TextStyle style;
  style.size = 28;
  style.bold = true;
  const auto title = [](const std::string& text, double width) { return make_heading(text, "", width, {}).title; };
  const double word = text_size("Magnets", style).x, both = text_size("Magnets below", style).x;
  EXPECT_EQ(title("Magnets", word), std::vector<std::string>{"Magnets"});
  EXPECT_TRUE(title("Magnets", std::nextafter(word, 0.0))[0].ends_with("..."));
  EXPECT_EQ(title("Magnets below", both), std::vector<std::string>{"Magnets below"});
  EXPECT_EQ(title("Magnets below", std::nextafter(both, 0.0)), (std::vector<std::string>{"Magnets", "below"}));
}

TEST(Heading, WithoutTitleOnlyAMarginRemains) {
  const Heading none = make_heading("Title", kSubtitle, 500.0, {.title = false});
  EXPECT_TRUE(none.title.empty());
  EXPECT_TRUE(none.subtitle.empty());
  EXPECT_LT(none.height, 30.0);
  EXPECT_GT(make_heading("Title", kSubtitle, 500.0, {}).height, none.height + 60.0);
}

}  // namespace
}  // namespace sf::viz
