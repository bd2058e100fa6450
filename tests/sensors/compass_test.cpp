// Compasses: the field of the Earth in the sensor's frame, headings, iron, and settings that are refused.

#include "sensors/compass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

/// Returns the field [µT] and the heading [degrees] of a robot with a heading [degrees] and a tilt.
std::vector<double> sensed(const std::string& settings, double yaw, const base::Tilt& tilt = {},
                           const std::string& earth = "") {
  const world::World world = world_of(earth + " position( compass( " + settings + " ) )");
  farm::Farm farm(world, host_device(), {});
  const auto values = farm.sense(0, sensors::kCompass, 0, {5, 6, 0, yaw * M_PI / 180.0}, tilt).values;
  std::vector<double> scaled;
  for (std::size_t i = 0; i < 4; ++i) scaled.push_back(1e6 * values[i]);
  scaled.push_back(values[4] * 180.0 / M_PI);
  return scaled;
}

void expect_near(const std::vector<double>& reading, const std::vector<double>& expected) {
  for (std::size_t i = 0; i < std::min<std::size_t>(4, expected.size()); ++i)
    EXPECT_NEAR(reading[i], expected[i], 1e-9) << i;
  if (expected.size() == 5) {
    EXPECT_NEAR(std::remainder(reading[4] - expected[4], 360.0), 0.0, 1e-9);
  }
}

TEST(Compass, ReadsTheFieldOfTheEarth) {
  const double level = 25.0, down = -25.0 * std::sqrt(3.0);  // 50 µT, 60 degrees downwards
  expect_near(sensed("", 90.0), {50.0, level, 0.0, down, 0.0});
  expect_near(sensed("", 0.0), {50.0, 0.0, level, down, 90.0});  // to the east: north is to the left
  expect_near(sensed("", -90.0), {50.0, -level, 0.0, down, 180.0});
  expect_near(sensed("", 180.0), {50.0, 0.0, -level, down, 270.0});
  EXPECT_NEAR(sensed("declination 10", 90.0)[4], 350.0, 1e-9) << "magnetic north is to the east";
  expect_near(sensed("strength 2e-5 inclination -90", 0.0), {20.0, 0.0, 0.0, 20.0});  // south magnetic pole
  expect_near(sensed("pose6 [0 0 0 0 0 90]", 0.0), {50.0, level, 0.0, down, 0.0});
}

TEST(Compass, ReadsTheFieldOfTheWorld) {
  const std::string earth = "earth_field [0.03 0.04 -0.12]";  // [G]: 5 µT level, 12 downwards
  const double north_to_east = std::atan2(3.0, 4.0) * 180.0 / M_PI;
  expect_near(sensed("", 0.0, {}, earth), {13.0, 3.0, 4.0, -12.0, 90.0 - north_to_east});
  // Each key of its own replaces that part alone.
  expect_near(sensed("strength 26e-6", 0.0, {}, earth), {26.0, 6.0, 8.0, -24.0, 90.0 - north_to_east});
  expect_near(sensed("declination 0", 0.0, {}, earth), {13.0, 0.0, 5.0, -12.0, 90.0});
  expect_near(sensed("inclination 0", 0.0, {}, earth), {13.0, 7.8, 10.4, 0.0, 90.0 - north_to_east});
}

TEST(Compass, TiltsWithTheRobot) {
  const auto reading = sensed("", 90.0, {0.0, 0.5});
  const double c = std::cos(0.5), s = std::sin(0.5), down = -25.0 * std::sqrt(3.0);
  expect_near(reading, {50.0, 25.0 * c - down * s, 0.0, 25.0 * s + down * c, 0.0});
  EXPECT_GT(std::abs(sensed("", 45.0, {0.0, 0.5})[4] - 45.0), 10.0) << "the heading is that of a level compass";
}

TEST(Compass, IronAddsAndMultiplies) {
  const double down = -25.0 * std::sqrt(3.0);
  expect_near(sensed("hard_iron [1e-6 2e-6 -3e-6]", 90.0), {std::hypot(26.0, 2.0, down - 3.0), 26.0, 2.0, down - 3.0});
  const double x = 25.0 * 1.1 + 0.04 * down, y = 0.2 * 25.0, z = down + 0.04 * 25.0;
  expect_near(sensed("soft_iron [0.1 0 0 0.2 0.04 0]", 90.0), {std::hypot(x, y, z), x, y, z});
}

TEST(Compass, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& text) {
    return refusal_of([&] { sensors::SensorSet(world_of("position(\ncompass( " + text + " ) )")); });
  };
  expect_in("trial.world:2: 'inclination'", refused("inclination 91"));
  expect_in("'hard_iron' has 2; expected [x y z] in tesla, from -1 to 1", refused("hard_iron [0 2 0]"));
  expect_in("'soft_iron'", refused("soft_iron [1 2]"));
  expect_in("'strength' has 3 numbers; expected one", refused("strength [1e-5 2e-5 3e-5]"));
  expect_in("'strength'", refused("strength -1"));
}

}  // namespace
}  // namespace sf::trial
