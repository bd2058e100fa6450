#include "server/simulated_sensors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sensors/sensor_type.h"
#include "tests/units.h"
#include "tests/world/read_world.h"

namespace sf::server {
namespace {

world::World robot_with(const std::string& more) {
  return world::read_world(
      "position( name \"roomba\" pose [1 0 0 90] size [0.33 0.33 0.1] drive \"diff\" track 0.258\n"
      "  encoder( per_count 0.001 track 0.258 slip 0.005 scale [1.04 1.02] ) " +
          more + " )\n",
      {.sensors = sensors::world_file_words()});
}

/// Drives two minutes on a circle of 1 m at 0.2 m/s.
struct Round {
  explicit Round(const std::string& more, std::uint64_t seed = 1)
      : world(robot_with(more)),
        sensor_set(world),
        own(world.movers[0], 0,
            {.cameras = {}, .sensors = control::position_sensors_of(world.movers[0]), .start = world.movers[0].X_WM}),
        sensors(world, sensor_set, 0, control::position_sensors_of(world.movers[0]), seed) {}

  void drive() {
    constexpr double kRate = 0.2;  // [rad/s], and [m/s] at 1 m
    base::Report before{.X_WM = world.movers[0].X_WM};
    for (int k = 1; k <= 1200; ++k) {
      const double angle = 0.1 * kRate * k;
      const base::Report after{
          0, k * kTick, {std::cos(angle), std::sin(angle), 0.0, angle + 0.5 * M_PI}, {kRate, 0.0, kRate}};
      sensors.measure(before.X_WM, after, k * kTick, own);
      own.predict(k * kTick);
      if (!own.is_lost()) errors.add(own.state().X_WM, after.X_WM);
      lost += own.is_lost();
      before = after;
    }
  }

  world::World world;
  sensors::SensorSet sensor_set;
  OwnState own;
  SimulatedSensors sensors;
  control::LocalizationError errors;
  int lost = 0;
};

TEST(SimulatedSensors, GyroAndSatellitesBoundTheDriftOfWheels) {
  Round wheels(""), gyro("gyro( bias 0.5 noise 0.1 )"),
      all("gyro( bias 0.5 noise 0.1 ) gps( satellites 8 noise 0.2 rate 1 latency 0.1 pose [0.1 0 0 0] )");
  for (Round* round : {&wheels, &gyro, &all}) round->drive();
  EXPECT_EQ(all.lost, 0);
  EXPECT_GT(all.errors.steps, 1100u);
  EXPECT_LT(all.errors.rms(), 0.12);
  EXPECT_GT(wheels.errors.max, 2.0 * all.errors.max);
  EXPECT_LT(all.errors.yaw_max, 0.2);
  EXPECT_GT(wheels.errors.yaw_max, 2.0 * all.errors.yaw_max);
  EXPECT_GT(gyro.own.calibration().gyro_bias.sigma, 0.0);
}

TEST(SimulatedSensors, StatedCovarianceCoversTheErrors) {
  double squares = 0.0, stated = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Round round("gyro( bias 0.5 noise 0.1 ) gps( satellites 8 noise 0.2 rate 1 )", seed);
    round.drive();
    squares += round.errors.rms() * round.errors.rms();
    stated += round.own.quality().covariance[0] + round.own.quality().covariance[3];
    EXPECT_TRUE(round.own.quality().stated);
    EXPECT_LE(round.own.quality().age, kSecond + kTick);
  }
  EXPECT_LT(squares, 2.0 * stated);
}

}  // namespace
}  // namespace sf::server
