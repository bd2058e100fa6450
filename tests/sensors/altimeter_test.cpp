// Altimeters: heights of robots and mounts above a datum, and errors.

#include "sensors/altimeter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

double first(const std::string& text, std::uint64_t seed = 1) {
  return series(world_of(text), sensors::kAltimeter, 1, seed)[0][0];
}

TEST(Altimeter, ReadsTheHeightOfItsMount) {
  EXPECT_DOUBLE_EQ(first("position( pose [1 2 3 0] altimeter( pose [0 0 0.5 0] ) )"),
                   first("position( pose [1 2 3 0] altimeter() )") + 0.5);
  EXPECT_DOUBLE_EQ(first("position( pose [1 2 3 0] altimeter( datum 1 ) )"),
                   first("position( pose [1 2 2 0] altimeter() )"));

  const world::World world = world_of("position( altimeter( pose6 [2 0 0 0 0 0] ) )");
  farm::Farm farm(world, host_device(), {});
  EXPECT_NEAR(farm.sense(0, sensors::kAltimeter, 0, {}, {0.0, -M_PI / 2}).values[0], 2.0, 1e-9)
      << "2 m ahead of a robot that looks up";
}

TEST(Altimeter, RoundsAndWanders) {
  const double fine = first("position( pose [0 0 1.234 0] altimeter( datum 0.1 ) )");
  EXPECT_EQ(first("position( pose [0 0 1.234 0] altimeter( datum 0.1 step 0.5 ) )"), 0.5 * std::round(2.0 * fine));
  EXPECT_NE(first("position( altimeter( bias 1 ) )", 1), first("position( altimeter( bias 1 ) )", 2));
  const auto readings = series(world_of("position( altimeter( walk 0.1 ) )"), sensors::kAltimeter, 1000);
  EXPECT_EQ(readings[0][0], first("position( altimeter() )")) << "from the truth";
  double squares = 0.0;
  for (std::size_t i = 1; i < 1000; ++i) squares += std::pow(readings[i][0] - readings[i - 1][0], 2) / 999.0;
  EXPECT_NEAR(squares, 0.01 * 0.1, 2e-4) << "0.1 m after a second, ten readings a second";
  const auto noisy = series(world_of("position( altimeter( noise 0.2 ) )"), sensors::kAltimeter, 2000);
  squares = 0.0;
  for (const auto& reading : noisy) squares += std::pow(reading[0] - readings[0][0], 2) / 2000.0;
  EXPECT_NEAR(squares, 0.04, 0.005) << "of each reading, whatever the rate";
}

TEST(Altimeter, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& text) {
    return refusal_of([&] { sensors::SensorSet(world_of("position(\naltimeter( " + text + " ) )")); });
  };
  expect_in("trial.world:2: 'noise'", refused("noise -1"));
  expect_in("'datum'", refused("datum 1e9"));
}

}  // namespace
}  // namespace sf::trial
