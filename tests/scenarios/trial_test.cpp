// Differences between trials.

#include "scenarios/trial.h"

#include <gtest/gtest.h>

#include <fstream>

#include "sensors/laser_settings.h"
#include "sensors/settings.h"
#include "tests/device.h"

namespace sf::scenarios {

namespace {

/// The first robot of the world `text`, disturbed.
world::Mover robot_of(const std::string& text, const Disturbance& disturbance) {
  Scenario scenario;
  scenario.world = testing::TempDir() + "noise.world";
  std::ofstream(scenario.world) << text;
  return disturbed_world(scenario, disturbance).movers.at(0);
}

}  // namespace

TEST(Trial, SensorsKeepTheirOwnNoise) {
  const world::Mover robot = robot_of(
      "unit_length \"cm\"\n"
      "position( size [40 40 10]\n"
      "  laser( name \"plain\" )\n"
      "  laser( name \"none\" noise [0 0 0] )\n"
      "  laser( name \"angular\" noise [0 0 0.5] )\n"
      "  laser( name \"proportional\" noise [0 0.02 0] )\n"
      "  laser( name \"own\" noise [1 0 0] )\n"
      "  ranger( name \"blocks\" sensor( samples 1 ) sensor( samples 1 noise [0 0 0.5] ) )\n"
      "  laneedge( name \"edge\" ) laneedge( name \"quiet\" noise [0 0 0] )\n"
      "  magnetometer( name \"field\" ) magnetometer( name \"still\" noise [0] ) )\n",
      {.edge_noise = 0.002, .field_noise = 0.004, .scan_noise = 0.003});
  const auto lasers = sensors::lasers_of(robot);
  ASSERT_EQ(lasers.size(), 7u);
  const auto expect = [&](std::size_t i, double constant, double proportional, double degrees) {
    const raycast::ScanNoise& noise = lasers[i].noise;
    EXPECT_NEAR(noise.range_sigma, constant, 1e-15) << lasers[i].name;
    EXPECT_EQ(noise.range_proportional, proportional) << lasers[i].name;
    EXPECT_NEAR(noise.angle_sigma, degrees * M_PI / 180.0, 1e-15) << lasers[i].name;
  };
  expect(0, 0.003, 0.0, 0.0);
  expect(1, 0.0, 0.0, 0.0);
  expect(2, 0.0, 0.0, 0.5);
  expect(3, 0.0, 0.02, 0.0);
  expect(4, 0.01, 0.0, 0.0);
  expect(5, 0.003, 0.0, 0.0);
  expect(6, 0.0, 0.0, 0.5);
  for (const auto& [name, constant] :
       {std::pair{"edge", 0.2}, std::pair{"quiet", 0.0}, std::pair{"field", 0.004}, std::pair{"still", 0.0}}) {
    const auto sensor = std::find_if(robot.sensors.begin(), robot.sensors.end(),
                                     [&](const world::Sensor& each) { return each.name == name; });
    ASSERT_NE(sensor, robot.sensors.end()) << name;
    EXPECT_NEAR(sensors::find(*sensor, "noise")->numbers[0], constant, 1e-15) << name;  // in the file's units
  }
}

/// A controller at 5 Hz in ticks of 0.1 s: one time for each of its errors, every second tick.
TEST(Trial, TimesAreThoseOfTheErrors) {
  Scenario scenario;
  scenario.world = SF_SOURCE_DIR "/worlds/testpath/testpath.world";
  scenario.duration = 4.0;
  scenario.actor.controller = {"lane-keeping", 5.0, {"controller 'lane-keeping'", {{"speed", 0.1, ""}}}};
  const Trial trial = run_trial(scenario, disturbed_world(scenario, {}), device(), {});
  ASSERT_GT(trial.times.size(), 10u);
  EXPECT_EQ(trial.times.size(), trial.counts.at(0).errors.size());
  EXPECT_EQ(trial.times.size(), trial.errors.at(0).count);
  for (std::size_t i = 1; i < trial.times.size(); ++i) EXPECT_NEAR(trial.times[i] - trial.times[i - 1], 0.2, 1e-9) << i;
  EXPECT_EQ(trial.simulated, 4.0);
  EXPECT_EQ(trial.tracks.at(0).poses.size(), 40u);
}

TEST(Trial, WithoutDisturbanceTheWorldIsUnchanged) {
  const world::Mover robot =
      robot_of("position( size [0.4 0.4 0.1] laser( ) magnetometer( ) )\n", {0.0, 0.0, 0.0, 0.0, 0.0});
  for (const world::Sensor& sensor : robot.sensors) EXPECT_EQ(sensors::find(sensor, "noise"), nullptr) << sensor.type;
  EXPECT_EQ(robot.X_WM.x, 0.0);
}

}  // namespace sf::scenarios
