// The derived sensor `localization`: covariance, order of arrival, and consistency.

#include "sensors/localization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "base/time.h"
#include "farm/farm.h"
#include "tests/device.h"
#include "tests/instrumented.h"
#include "tests/sensors/host_trial.h"
#include "world/stage/build_world.h"

namespace sf::trial {
namespace {

world::World robot_with(const std::string& own, const std::string& others = "") {
  return world::build_world(
      "localized.world",
      "define bot position( size [0.3 0.3 0.1] drive \"diff\" encoder( per_count 0.001 slip 0.01 rate 20 )\n" + own +
          " )\nbot( name \"r0\" pose [1 2 0 30] )\n" + others,
      {.sensors = sensors::world_file_words()});
}

/// Drives an arc of 0.3 m/s and 0.2 rad/s. Returns the last reading of the localization.
std::vector<double> reading_after_an_arc(const world::World& world, std::uint64_t seed, double seconds,
                                         base::Pose& truth, bool known_start = true) {
  farm::Farm farm(world, host_device(), {.seed = seed, .threads = 1});
  if (known_start) farm.subscribe_all();
  std::vector<double> last;
  truth = world.movers[0].X_WM;
  constexpr double kStep = 0.05, kTurn = 0.2;
  for (int tick = 0; tick * kStep <= seconds; ++tick) {
    const base::Report report{0, 0, truth, {0.3, 0.0, kTurn}};
    for (const base::ReadingBlock& block : farm.tick(base::nanoseconds(tick * kStep), {&report, 1}))
      if (block.type == sensors::kLocalization) last.assign(block.values.begin(), block.values.end());
    truth = {truth.x + 0.3 * kStep * std::cos(truth.yaw + 0.5 * kTurn * kStep),
             truth.y + 0.3 * kStep * std::sin(truth.yaw + 0.5 * kTurn * kStep), truth.z, truth.yaw + kTurn * kStep};
    if (tick == 0) farm.subscribe_all();
    if ((tick + 1) * kStep > seconds) truth = report.X_WM;
  }
  return last;
}

TEST(Localization, FollowsItsEncodersFromTheStartPose) {
  const world::World world = robot_with("derived( type \"localization\" inputs [\"encoder\"] )");
  base::Pose truth;
  const std::vector<double> reading = reading_after_an_arc(world, 1, 20.0, truth);
  ASSERT_EQ(reading.size(), 10u);
  EXPECT_EQ(reading[3], 1.0) << "valid";
  EXPECT_NEAR(reading[0], truth.x, 4.0 * std::sqrt(reading[4])) << "within four standard deviations";
  EXPECT_NEAR(reading[1], truth.y, 4.0 * std::sqrt(reading[7]));
  EXPECT_GT(reading[4] * reading[7], reading[5] * reading[5]) << "positive definite";
}

TEST(Localization, TakesTheYawRateOfAnImuMountedInAnyWay) {
  base::Pose truth;
  const auto reading_with = [&](const std::string& imu, const std::string& input) {
    return reading_after_an_arc(robot_with(imu + "derived( type \"localization\" inputs [\"encoder\"" + input + "] )"),
                                1, 20.0, truth);
  };
  const double alone = reading_with("", "")[9];  // [rad^2]
  for (const char* const mount : {"[0 0 0 0 0 0]", "[0.1 0 0.1 90 0 30]", "[0 0 0 180 20 0]"}) {
    const auto reading = reading_with(std::string("imu( rate 20 gyro_noise 0.02 pose6 ") + mount + " ) ", " \"imu\"");
    EXPECT_LT(4.0 * reading[9], alone) << mount;
    EXPECT_NEAR(base::wrap_angle(reading[2] - truth.yaw), 0.0, 4.0 * std::sqrt(reading[9])) << mount;
  }
}

/// The mean normalized squared error of 100 seeds is within its 95 % band: chi square of 300 degrees of freedom.
TEST(Localization, CovarianceIsConsistentOver100Seeds) {
  const world::World world = robot_with(
      "gyro( noise 0.2 bias 0.5 rate 20 ) gps( noise 1.5 rate 5 ) derived( type \"localization\" inputs [\"encoder\" "
      "\"gyro\" \"gps\"] )");
  if (instrumented()) GTEST_SKIP() << "a statistic; FollowsItsEncodersFromTheStartPose runs the same code";
  constexpr std::uint64_t kSeeds = 100;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    base::Pose truth;
    const std::vector<double> r = reading_after_an_arc(world, seed, 30.0, truth, false);
    const glm::dvec3 e{r[0] - truth.x, r[1] - truth.y, base::wrap_angle(r[2] - truth.yaw)};
    const glm::dmat3 P{{r[4], r[5], r[6]}, {r[5], r[7], r[8]}, {r[6], r[8], r[9]}};
    sum += glm::dot(e, glm::inverse(P) * e);
  }
  const double mean = sum / (3.0 * static_cast<double>(kSeeds));
  EXPECT_GT(mean, 0.846);
  EXPECT_LT(mean, 1.166);
}

constexpr const char* kLandmarks =
    "define mark model( size [0.1 0.1 0.4] fiducial_return 3 )\n"
    "mark( pose [4 3 0 0] fiducial_return 1 ) mark( pose [-3 4 0 0] fiducial_return 2 ) mark( pose [1 7 0 0] )\n"
    "position( name \"r1\" pose [0 6 0 0] size [0.3 0.3 0.4] fiducial_return 9 )\n";

/// Landmarks replace satellites: 100 seeds of a minute, with a finder ahead of the robot's middle that looks back.
TEST(Localization, LandmarksGiveAConsistentPose) {
  const std::string encoders = "derived( type \"localization\" inputs [\"encoder\"] )";
  const world::World world = robot_with(
      "fiducial( pose [0.1 0.05 0 150] rate 2 noise [0.1 2 0] ) derived( type \"localization\" inputs "
      "[\"encoder\" \"fiducial\"] )",
      kLandmarks);
  const std::uint64_t seeds = instrumented() ? 2 : 100;
  double sum = 0.0, squares = 0.0, squares_without = 0.0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    base::Pose truth;
    const std::vector<double> without = reading_after_an_arc(robot_with(encoders), seed, 60.0, truth);
    const std::vector<double> r = reading_after_an_arc(world, seed, 60.0, truth);
    const glm::dvec3 e{r[0] - truth.x, r[1] - truth.y, base::wrap_angle(r[2] - truth.yaw)};
    const glm::dmat3 P{{r[4], r[5], r[6]}, {r[5], r[7], r[8]}, {r[6], r[8], r[9]}};
    sum += glm::dot(e, glm::inverse(P) * e);
    squares += e.x * e.x + e.y * e.y;
    squares_without += std::pow(without[0] - truth.x, 2) + std::pow(without[1] - truth.y, 2);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(seeds)), 0.05) << "[m]";
  EXPECT_GT(squares_without, 4.0 * squares);
  if (instrumented()) return;
  EXPECT_GT(sum / (3.0 * static_cast<double>(seeds)), 0.7);
  EXPECT_LT(sum / (3.0 * static_cast<double>(seeds)), 1.3);
}

TEST(Localization, NeedsSomethingThatLocates) {
  const auto refusal = [](const std::string& inputs, const std::string& others = "") {
    try {
      const sensors::SensorSet all(
          robot_with("gyro( ) imu( ) fiducial( ) derived( type \"localization\" inputs " + inputs + " )", others));
    } catch (const base::InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal("[\"encoder\"]"), "accepted");
  EXPECT_NE(refusal("[\"gyro\"]").find("needs an encoder, a gps, a pose or a fiducial"), std::string::npos)
      << refusal("[\"gyro\"]");
  EXPECT_NE(refusal("[\"encoder\" \"encoder\"]").find("'encoder' is listed twice"), std::string::npos);
  EXPECT_NE(refusal("[\"encoder\" \"gyro\" \"imu\"]").find("takes a gyro or an imu, not both"), std::string::npos);
  const char* const kOther =
      "position( name \"other\" encoder( ) derived( type \"localization\" inputs [\"encoder\"] ) )";
  EXPECT_NE(refusal("[\"encoder\" \"other/localization\"]", kOther).find("are sensors of its own robot"),
            std::string::npos)
      << "it would be taken for the robot's own pose";
  EXPECT_EQ(refusal("[\"fiducial\"]", kLandmarks), "accepted");
  EXPECT_NE(refusal("[\"fiducial\"]", std::string(kLandmarks) + "mark( pose [9 9 0 0] )")
                .find("two models that stand still have fiducial_return 3"),
            std::string::npos);
  const std::string moving = "position( name \"r1\" pose [0 6 0 0] fiducial_return 9 )";
  EXPECT_NE(refusal("[\"fiducial\"]", moving).find("no model that stands still"), std::string::npos);
}

}  // namespace
}  // namespace sf::trial
