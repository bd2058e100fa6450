#include "viz/lights_figure.h"

#include <gtest/gtest.h>

#include "tests/viz/png.h"
#include "viz/color.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

using world::LightState;

scenes::Picture lights_drawn(const std::vector<LightRow>& rows, const Page& page = {}) {
  draw_light_states(rows, "two lights", scenes::own_file("lights.png"), page);
  return scenes::read_png(scenes::own_file("lights.png"));
}

/// Returns the number of pixels in a bar's colour on white.
int bar(const scenes::Picture& p, std::uint32_t color) {
  constexpr double kOpacity = 191.0 / 255.0;
  int n = 0;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      bool like = true;
      for (const int shift : {16, 8, 0}) {
        const double expected = kOpacity * ((color >> shift) & 0xFF) + (1.0 - kOpacity) * 255.0;
        like = like && std::abs(((p.at(x, y) >> shift) & 0xFF) - expected) < 3.0;
      }
      n += like;
    }
  return n;
}

/// For readers who cannot see colours: red bars are the highest, green ones the lowest, flashing ones have gaps.
TEST(LightsFigure, StatesDifferInHeight) {
  const auto area = [](LightState state, std::uint32_t color) {
    return bar(lights_drawn({{"a", {{0.0, 5.0, state}, {5.0, 10.0, LightState::dark}}}}), color);
  };
  const int red = area(LightState::red, theme::kLightRed), yellow = area(LightState::yellow, theme::kLightYellow),
            green = area(LightState::green, theme::kLightGreen),
            flashing = area(LightState::flashing_red, theme::kLightRed);
  EXPECT_GT(red, 1.3 * yellow);
  EXPECT_GT(yellow, 1.3 * green);
  EXPECT_GT(green, 2000);
  EXPECT_NEAR(flashing, 0.5 * red, 0.15 * red);
}

TEST(LightsFigure, BarsAreAsLongAsTheirStates) {
  const auto red_of = [](double to) {
    return bar(lights_drawn({{"a", {{0.0, to, LightState::red}, {to, 10.0, LightState::green}}}}), theme::kLightRed);
  };
  EXPECT_NEAR(red_of(8.0), 2.0 * red_of(4.0), 0.05 * red_of(8.0));
}

TEST(LightsFigure, UnusualRowsAreDrawn) {
  EXPECT_GT(lights_drawn({{"without a state", {}}}).width, 0);
  EXPECT_GT(lights_drawn({{"of no time", {{3.0, 3.0, LightState::red}}}}).width, 0);
  EXPECT_GT(lights_drawn({{std::string(300, 'x'), {{0.0, 1.0, LightState::red}}}}, {.width = 85.0}).width, 0)
      << "a name wider than the page";
}

}  // namespace
}  // namespace sf::viz
