#include "viz/scales.h"

#include <gtest/gtest.h>

#include <cmath>

#include "viz/legend.h"

namespace sf::viz {
namespace {

/// For widths from that of a small multiple on, and ranges of very different numbers.
TEST(Scales, LabelsAlongXNeverTouch) {
  for (const double pixels : {40.0, 90.0, 150.0, 400.0, 1500.0})
    for (const auto& [from, to] :
         {std::pair{0.0, 1.0}, {-1e6, 1e6}, {1e5, 1e5 + 3.0}, {-0.003, 0.001}, {0.0, 86400.0}}) {
      const Ticks ticks = ticks_across(from, to, pixels);
      for (std::size_t i = 0; i + 1 < ticks.at.size(); ++i) {
        const double apart = (ticks.at[i + 1] - ticks.at[i]) / (to - from) * pixels;
        const double half = 0.5 * (text_size(tick_text(ticks.at[i], ticks), small_text()).x +
                                   text_size(tick_text(ticks.at[i + 1], ticks), small_text()).x);
        EXPECT_GT(apart, half + 8.0) << from << " to " << to << " on " << pixels;
      }
    }
}

/// From the shortest axes of figures on, in both directions, for numbers of all sizes and at all positions in their
/// decade.
TEST(Scales, EveryAxisHasTwoLabelsThatDoNotTouch) {
  for (const double pixels : {60.0, 72.0, 100.0, 134.0, 250.0, 700.0})
    for (const double size : {1e-12, 1e-6, 1e-3, 0.3, 0.7, 1.0, 1.9, 4.7, 20.0, 97.0, 1e4, 3e5, 1e9})
      for (const double begin : {0.0, -0.5, 0.03, 0.11, -0.97, 3.3, -41.7, 1000.3}) {
        const double from = begin * size, to = from + size;
        const Ticks across = ticks_across(from, to, pixels), up = ticks_up(from, to, pixels);
        const auto what = [&] { return testing::Message() << from << " to " << to << " on " << pixels; };
        ASSERT_GE(across.at.size(), 2u) << what();
        ASSERT_GE(up.at.size(), 2u) << what();
        for (const Ticks& ticks : {across, up}) {
          EXPECT_GE(ticks.at.front(), from - 1e-9 * size) << what();
          EXPECT_LE(ticks.at.back(), to + 1e-9 * size) << what();
          EXPECT_NE(tick_text(ticks.at[0], ticks), tick_text(ticks.at[1], ticks)) << what();
        }
        EXPECT_GE((across.at[1] - across.at[0]) / size * pixels, widest_label(across) + 9.0) << what();
        EXPECT_GE((up.at[1] - up.at[0]) / size * pixels, 19.99) << what();
      }
}

TEST(Scales, LongLabelsOfShortAxesHaveAnOffset) {
  const Ticks ticks = ticks_across(1.7e9 + 0.25, 1.7e9 + 0.75, 100.0);
  ASSERT_GE(ticks.at.size(), 2u);
  EXPECT_EQ(ticks.offset, 1.7e9);
  EXPECT_EQ(axis_name("time [s]", ticks), "time \u2212 1700000000 [s]");
  EXPECT_EQ(tick_text(ticks.at[0], ticks).substr(0, 2), "0.");
  EXPECT_EQ(ticks_across(0.0, 20.0, 61.0).offset, 0.0) << "only where there is need";
}

TEST(Scales, NumbersInSentencesHavePowersOfTen) {
  EXPECT_EQ(number_text(0.5), "0.5");
  EXPECT_EQ(number_text(1e-6), "10⁻⁶");
  EXPECT_EQ(number_text(-2e-6), "\u22122×10⁻⁶");
  EXPECT_EQ(number_text(1.5e7), "1.5×10⁷");
}

TEST(Scales, IntegersHaveIntegerTicks) {
  const auto expect_integers = [](double from, double to, const Ticks& ticks) {
    EXPECT_GE(ticks.at.size(), std::floor(to) - std::ceil(from) >= 1.0 ? 2u : 0u) << from << " to " << to;
    for (const double at : ticks.at) EXPECT_EQ(at, std::round(at)) << from << " to " << to;
  };
  for (const auto& [from, to] : {std::pair{-0.1, 1.1},
                                 {0.0, 3.0},
                                 {2.5, 3.5},
                                 {0.0, 1023.0},
                                 {254.9, 256.1},
                                 {3.4, 17.6},
                                 {-1.0, 1.0},
                                 {0.0, 1.0}})
    for (const auto& [up, across] : {std::pair{60.0, 110.0}, {600.0, 600.0}}) {
      expect_integers(from, to, ticks_up(from, to, up, true));
      expect_integers(from, to, ticks_across(from, to, across, true));
    }
  EXPECT_EQ(ticks_up(-0.1, 1.1, 600.0, true).at.size(), 2u) << "pressed: 0 and 1";
}

TEST(Scales, LargeAndSmallNumbersHaveAnExponentInTheUnit) {
  EXPECT_EQ(ticks_up(0.0, 5.0, 300.0).exponent, 0);
  EXPECT_EQ(ticks_up(0.0, 99999.0, 300.0).exponent, 0) << "the last without one";
  const Ticks large = ticks_up(0.0, 2.5e6, 300.0);
  EXPECT_EQ(large.exponent, 6);
  EXPECT_EQ(tick_text(2.5e6, large), "2.5");
  const Ticks small = ticks_up(-3e-6, 3e-6, 300.0);
  EXPECT_EQ(small.exponent, -6);
  EXPECT_EQ(tick_text(-2e-6, small), "\u22122");
  EXPECT_EQ(axis_name("distance [m]", -6), "distance [10⁻⁶ m]");
  EXPECT_EQ(axis_name("contacts", 3), "contacts [10³]") << "a number without a unit";
  EXPECT_EQ(axis_name("distance [m]", 0), "distance [m]");
}

TEST(Scales, NumbersHaveTrueMinusSigns) {
  EXPECT_EQ(with_minus("-1.5e-07"), "\u22121.5e\u221207");
  EXPECT_EQ(power_of_ten(-12), "10⁻¹²");
  EXPECT_EQ(power_of_ten(0), "1");
}

}  // namespace
}  // namespace sf::viz
