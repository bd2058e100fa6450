// A robot's estimate of its own state from wheels and cameras, closed over a simulated Create and UDP.

#include "server/own_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/matrix.hpp>
#include <random>

#include "netio/outbox.h"
#include "robots/estimation/chi_square.h"
#include "server/real_robot.h"
#include "tests/create_simulator.h"
#include "tests/instrumented.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::server {
namespace {

constexpr std::uint32_t kTag = 7;

/// A robot that starts at (1, 2) with a heading of 0.5, and cameras that see its tag with errors of 5 mm and 0.01 rad.
struct OwnStateTest : testing::Test {
  explicit OwnStateTest(bool wheels = true) {
    world::World world = scenes::boxed_world(8.0, 8.0);
    mover = scenes::add_create(world, {1.0, 2.0, 0.0, 0.5});
    mover.track = 0.258;
    if (wheels) encoder = sensors::Encoder{.per_count = 1e-3, .angle_step = kDegree, .slip = 0.001, .track = 0.258};
    restart();
  }
  void restart() {
    own.emplace(mover, 3,
                OwnStateOptions{.cameras = CameraOptions{.bind = {netio::kLoopback, 0},
                                                         .tag = kTag,
                                                         .clock = {.source = estimation::ClockSource::arrival},
                                                         .position_sigma = 0.005,
                                                         .yaw_sigma = 0.01},
                                .sensors = {.wheels = encoder, .gyro = {}, .gps = {}},
                                .stop_after = kSecond});
    outbox.emplace();
  }
  void see(const base::Pose& X) {
    const auto normal = [&](double sigma) { return sigma * std::normal_distribution<double>{}(random); };
    const double yaw = X.yaw + normal(0.01);
    const netio::Tag tag{.position = {X.x + normal(0.005), X.y + normal(0.005), 0.0},
                         .orientation = {0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)}};
    netio::Header header{.type = netio::Type::tag, .robot = kTag, .sequence = sequence++, .time = now};
    header.state = {.stated = stated[0] > 0.0f, .covariance = stated};
    base::Bytes bytes;
    netio::encode(header, tag, bytes);
    outbox->queue({netio::kLoopback, own->port()}, bytes);
    outbox->flush();
    own->receive(now);
  }

  world::Mover mover;
  std::optional<sensors::Encoder> encoder;
  std::optional<OwnState> own;
  std::optional<netio::Outbox> outbox;
  std::mt19937_64 random{1};
  std::array<float, 6> stated{};  ///< covariance of the next poses; 0: not stated
  std::uint32_t sequence = 0;
  std::int64_t now = 0;
};

struct CamerasOnly : OwnStateTest {
  CamerasOnly() : OwnStateTest(false) {}
};

/// Its odometry is 5 % wrong. Drives curves and straight lines at 0.1 m/s.
struct CreateRun {
  CreateRun(OwnStateTest& fixture, std::uint64_t seed)
      : test(fixture), drive(make_real_robot({.device = create.device()}, test.mover.X_WM, 0.258)) {
    create.seed(seed);
    create.scale = 1.05;
    create.slip = 0.001;
    create.X = test.mover.X_WM;
    EXPECT_TRUE(create.streaming());
  }
  void run(int ticks, bool cameras) {
    for (int k = 0; k < ticks; ++k) {
      const double turn = cameras ? std::array{0.0, 0.3, 0.0, -0.3}[test.now / (5 * kSecond) % 4] : 0.0;
      test.now += 7 * 15 * kMs;
      create.run(7);
      drive->update(test.now);
      test.own->add_wheels(test.now, drive->rolled(0.258));
      if (cameras) test.see(create.X);
      test.own->predict(test.now);
      drive->drive({0.1, 0.0, turn}, test.now);
      EXPECT_TRUE(create.driven(create.drives + 1));
    }
  }
  glm::dvec2 error() const {
    const base::Pose& X = test.own->state().X_WM;
    return {X.x - create.X.x, X.y - create.X.y};
  }
  /// Returns the squared error of the position in units of its stated covariance: chi-square with 2 degrees.
  double normalized_square() const {
    const std::array<float, 6>& P = test.own->quality().covariance;
    return glm::dot(error(), glm::inverse(glm::dmat2{P[0], P[1], P[1], P[3]}) * error());
  }

  OwnStateTest& test;
  CreateSimulator create;
  std::unique_ptr<RealRobot> drive;
};

TEST_F(OwnStateTest, LearnsTheScaleOfACreateAndCoastsWhenItsTagIsCovered) {
  double with_cameras = 0.0, without = 0.0, worst = 0.0;
  int beyond = 0;
  const int seeds = instrumented() ? 10 : 50;
  for (int seed = 1; seed <= seeds; ++seed) {
    random.seed(seed);
    now = 0;
    restart();
    CreateRun create(*this, static_cast<std::uint64_t>(seed));
    create.run(571, true);  // one minute
    EXPECT_NEAR(own->calibration().left_scale.value, 1.05, 0.01) << seed;
    EXPECT_NEAR(own->calibration().right_scale.value, 1.05, 0.01) << seed;
    with_cameras += create.normalized_square();
    create.run(190, false);  // 20 s
    EXPECT_FALSE(own->is_lost());
    beyond += glm::length(create.error()) > 0.04;
    worst = std::max(worst, glm::length(create.error()));
    without += create.normalized_square();
  }
  EXPECT_LE(beyond, 2) << "a whole degree of odometry is 3.5 cm after 2 m";
  EXPECT_LT(worst, 0.05);
  // The central 95 %.
  for (const double sum : {with_cameras, without}) {
    EXPECT_GT(sum, estimation::chi_square_limit(2 * seeds, 0.975)) << "the covariance is too large";
    EXPECT_LT(sum, estimation::chi_square_limit(2 * seeds, 0.025)) << "the covariance is too small";
  }
  std::printf(
      "[ measured ] squared errors of positions over their covariance, %d seeds: %.3f with cameras, %.3f after 20 s "
      "without\n",
      seeds, with_cameras / (2 * seeds), without / (2 * seeds));
}

// A pose with a stated covariance of 1 m counts less than the wheels, and one of 1 mm more.
TEST_F(OwnStateTest, WeighsPosesByTheirStatedCovariance) {
  for (const float sigma : {1.0f, 1e-3f}) {
    random.seed(1);
    now = 0;
    restart();
    own->add_wheels(now, {0.0, 0.0});
    see(mover.X_WM);
    stated = {sigma * sigma, 0, 0, sigma * sigma, 0, 1e-4f};
    now += kTick;
    own->add_wheels(now, {0.0, 0.0});
    see({mover.X_WM.x + 0.02, mover.X_WM.y, 0.0, mover.X_WM.yaw});
    own->predict(now);
    const double moved = own->state().X_WM.x - mover.X_WM.x;
    EXPECT_EQ(moved > 0.01, sigma < 0.1f) << moved;
    stated = {};
  }
}

/// Cameras that measure tilt tilt the robot's own state, which it broadcasts.
TEST_F(CamerasOnly, TiltIsThatOfTheNewestPose) {
  const auto see_tilted = [&](std::uint32_t number, double roll) {
    base::Bytes bytes;
    netio::encode({.robot = kTag, .sequence = number, .time = number * 100 * kMs},
                  netio::Tag{.orientation = {std::sin(0.5 * roll), 0.0, 0.0, std::cos(0.5 * roll)}}, bytes);
    outbox->queue({netio::kLoopback, own->port()}, bytes);
    outbox->flush();
    own->receive(now += 100 * kMs);
    own->predict(now);
  };
  for (const auto& [number, roll] : {std::pair{1u, 0.1}, {3u, 0.3}}) {
    see_tilted(number, roll);
    EXPECT_NEAR(own->state().tilt.roll, roll, 1e-15);
  }
  EXPECT_NEAR(own->pose_at(now - 50 * kMs).tilt.roll, 0.2, 1e-12) << "half way";
}

TEST_F(OwnStateTest, IsLostUntilACameraSeesIt) {
  own->add_wheels(now, {0.0, 0.0});
  own->predict(now);
  EXPECT_TRUE(own->is_lost());
  see({-1.0, 0.5, 0.0, 2.0});
  own->predict(now);
  EXPECT_FALSE(own->is_lost());
  EXPECT_NEAR(own->state().X_WM.x, -1.0, 0.03);
  EXPECT_EQ(own->state().mover, 3u);
}

TEST_F(OwnStateTest, IsLostWhenItsPositionIsTooUncertain) {
  own->add_wheels(now, {0.0, 0.0});
  see(mover.X_WM);
  own->predict(now);
  double rolled = 0.0;
  for (int k = 0; k < 4000 && !own->is_lost(); ++k) {
    now += kTick;
    rolled += 0.02;
    own->add_wheels(now, {rolled, rolled});
    own->predict(now);
  }
  EXPECT_TRUE(own->is_lost());
  EXPECT_GT(now, 20 * kSecond) << "it coasts for long";
  EXPECT_NEAR(own->sigma(), 0.5, 0.1);
  see({1.0 + rolled * std::cos(0.5), 2.0 + rolled * std::sin(0.5), 0.0, 0.5});
  own->predict(now);
  EXPECT_FALSE(own->is_lost()) << "seen again";
}

TEST_F(CamerasOnly, AreLostWhenNoCameraSeesThemForTooLong) {
  see(mover.X_WM);
  own->predict(now += kSecond);
  EXPECT_FALSE(own->is_lost());
  own->predict(now += kMs);
  EXPECT_TRUE(own->is_lost());
  EXPECT_FALSE(own->has_wheels());
}

TEST_F(OwnStateTest, CountsAFlood) {
  for (std::size_t k = 0; k < OwnState::kMostBetweenPredictions + 5; ++k) see(mover.X_WM);
  EXPECT_EQ(own->counts().flooded, 5u);
  own->predict(now);
  see(mover.X_WM);
  EXPECT_EQ(own->counts().flooded, 5u);
}

}  // namespace
}  // namespace sf::server
