// The derived sensor `sideslip`: a car that slips in a farm, sensors that are refused, and what is not stated.

#include "sensors/sideslip.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/time.h"
#include "farm/farm.h"
#include "robots/car_dynamics.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/host_trial.h"
#include "tests/units.h"
#include "world/stage/build_world.h"

namespace sf::trial {
namespace {

world::World car_with(const std::string& derived) {
  return world::build_world(
      "car.world",
      "define car position( size [4.3 1.7 1.4] drive \"car\" velocity_bounds [-40 40 0 0 0 0 -90 90]\n"
      "encoder( rate 100 per_count 0.0001 ) gyro( rate 100 noise 0.2 )\n" +
          derived + " )\ncar( name \"r0\" pose [0 0 0 0] )\n",
      {.sensors = sensors::world_file_words()});
}

struct SideslipDrive {
  std::vector<double> reading;                     ///< the last one
  double sideslip = 0.0, front = 0.0, rear = 0.0;  ///< true, at that time
  double worst = 0.0;                              ///< [rad] largest error after the first valid reading
  int valid = 0;                                   ///< number of valid readings
};

/// Drives a curve of about 0.6 g from 25 m/s, on the four-wheel model. The commanded turn states the steering angle.
SideslipDrive drive_curve(const std::string& derived) {
  const world::World world = car_with(derived);
  const robots::CarModel model;
  farm::Farm farm(world, host_device(), {.seed = 1, .threads = 1});
  farm.subscribe(0, base::only(sensors::kSideslip));
  robots::CarState state = robots::straight(model, 25.0);
  SideslipDrive drive;
  for (int tick = 0; tick <= 300; ++tick) {
    const base::Report report{
        0,
        tick * kSecond / 100,
        {state[robots::kCarX], state[robots::kCarY], 0.0, base::wrap_angle(state[robots::kCarYaw])},
        {state[robots::kCarForward], state[robots::kCarLeft], state[robots::kCarTurn]}};
    const double turn = report.velocity.forward * std::tan(state[robots::kCarSteer]) / model.wheelbase();
    const base::Twist command{report.velocity.forward, 0.0, turn};
    farm.set_commands({&command, 1});
    for (const base::ReadingBlock& block : farm.tick(tick * kSecond / 100, {&report, 1})) {
      drive.reading.assign(block.values.begin(), block.values.end());
      if (drive.reading[3] == 0.0) continue;
      ++drive.valid;
      drive.worst = std::max(drive.worst, std::abs(drive.reading[0] - robots::sideslip(state)));
    }
    const robots::CarForces f = robots::car_forces(model, state);
    drive.sideslip = robots::sideslip(state);
    drive.front = f.across[0] + f.across[1], drive.rear = f.across[2] + f.across[3];
    for (int k = 0; k < 20; ++k) state = robots::step(model, state, {tick > 50 ? 0.045 : 0.0, 150.0});
  }
  return drive;
}

TEST(SideslipSensor, FollowsACarThatSlips) {
  for (const std::string observer : {"extended-luenberger", "ekf", "sliding-mode"}) {
    SCOPED_TRACE(observer);
    const SideslipDrive drive = drive_curve(
        "derived( type \"sideslip\" inputs [\"gyro\" \"encoder\" \"command\"] observer \"" + observer + "\" )");
    ASSERT_EQ(drive.reading.size(), 10u);
    EXPECT_GT(drive.valid, 145) << "at 50 Hz, from the second reading of the encoder on";
    EXPECT_LT(drive.sideslip, -1.0 * kDegree);
    EXPECT_LT(drive.worst, 0.5 * kDegree);
    EXPECT_NEAR(drive.reading[0], drive.sideslip, 0.25 * kDegree);
    EXPECT_NEAR(drive.reading[1], drive.front, 0.1 * drive.front);
    EXPECT_NEAR(drive.reading[2], drive.rear, 0.1 * drive.rear);
    EXPECT_EQ(std::isfinite(drive.reading[4]), observer == "ekf") << "only the filter states a covariance";
  }
}

TEST(SideslipSensor, StartsWithItsSpeedIfItMeasuresNone) {
  const SideslipDrive drive =
      drive_curve("derived( type \"sideslip\" inputs [\"gyro\" \"command\"] start_speed 25 phase 0.01 )");
  EXPECT_GT(drive.valid, 145);
  EXPECT_LT(drive.worst, 0.5 * kDegree);
  const SideslipDrive slow = drive_curve("derived( type \"sideslip\" inputs [\"gyro\" \"command\"] start_speed 2 )");
  EXPECT_EQ(slow.valid, 0) << "below 3 m/s";
}

TEST(SideslipSensor, RefusesWhatItCannotUse) {
  const auto refusal = [](const std::string& more) {
    return refusal_of([&] { const sensors::SensorSet all(car_with("derived( type \"sideslip\" " + more + " )")); });
  };
  EXPECT_EQ(refusal("inputs [\"encoder\" \"command\"]"), "");
  expect_in("needs a steering angle", refusal("inputs [\"gyro\" \"encoder\"]"));
  expect_in("needs a speed", refusal("inputs [\"gyro\" \"command\"]"));
  expect_in("inputs of a sideslip sensor are those of its own robot",
            refusal("inputs [\"gyro\" \"encoder\" \"command\"] ) ) car( name \"r1\" derived( type \"sideslip\" inputs "
                    "[\"r0/gyro\" \"encoder\" \"command\"]"));
  const std::string inputs = "inputs [\"encoder\" \"command\"] ";
  expect_in("luenberger", refusal(inputs + "observer \"kalman\""));
  expect_in("c1 c2 > c3", refusal(inputs + "friction [1 1 2]"));
  expect_in("'axles' expects numbers above 0", refusal(inputs + "axles [1 0]"));
  expect_in("'noise' expects numbers above 0", refusal(inputs + "noise [0 1]"));
}

}  // namespace
}  // namespace sf::trial
