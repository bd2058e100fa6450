// Users' actuator models: the quadrotor of examples/dynamics, and plug-ins that fail.

#include "control/own_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/refusal.h"
#include "tests/robots/scenes.h"

namespace sf::control {
namespace {

constexpr std::int64_t kFlightTick = 100'000'000;
const std::string kQuadrotor = SF_BINARY_DIR "/test_quadrotor.so", kTestPlugin = SF_BINARY_DIR "/test_plugin.so";

world::World flying_world(const std::string& name, std::vector<std::pair<std::string, std::string>> settings = {}) {
  world::World world = scenes::boxed_world(20.0, 20.0);
  world::Mover& mover = scenes::add_square(world, {2.0, 10.0, 0.0, 0.0});
  mover.drive = world::Drive::omni, mover.max_forward = 3.0;
  mover.dynamics = {name, std::move(settings), "a.world:7: "};
  return world;
}

std::string dynamics_refusal(const std::string& name, std::vector<std::pair<std::string, std::string>> settings = {}) {
  const world::World world = flying_world(name, std::move(settings));
  return refusal_of([&] {
    robots::Fleet fleet(world);
    set_own_dynamics(world, fleet);
    fleet.move(std::vector<base::Twist>(1), kFlightTick);
  });
}

TEST(OwnDynamics, AQuadrotorFliesOverAWall) {
  world::World world = flying_world(kQuadrotor, {{"height", "2"}});
  scenes::add_wall(world, {10.0, 0.0}, {10.0, 20.0}, 0.0, 1.0);
  scenes::add_wall(world, {19.0, 0.0}, {19.0, 20.0}, 0.0, 3.0);
  robots::Fleet fleet(world);
  set_own_dynamics(world, fleet);
  const auto fly = [&](const base::Twist& command, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) fleet.move(std::vector{command}, kFlightTick);
    return fleet.reports()[0];
  };
  EXPECT_NEAR(fly({}, 50).X_WM.z, 2.0, 0.01);
  EXPECT_GT(fly({2.0}, 3).tilt.pitch, 0.1) << "to accelerate";
  EXPECT_NEAR(fly({2.0}, 40).velocity.forward, 2.0, 0.05);
  EXPECT_GT(fly({2.0, 0.0, 0.0}, 20).X_WM.x, 10.5) << "over the wall of 1 m";
  EXPECT_LT(fly({0.0, 1.0, 0.0}, 3).tilt.roll, -0.05) << "the left side goes down";
  const base::Report stopped = fly({3.0}, 100);
  EXPECT_NEAR(stopped.X_WM.x, 18.8, 0.01) << "at the wall of 3 m";
  EXPECT_NEAR(stopped.X_WM.z, 2.0, 0.1);
  EXPECT_EQ(stopped.velocity.forward, 0.0);
}

TEST(OwnDynamics, ReportsErrorsOfPlugins) {
  EXPECT_EQ(dynamics_refusal(kQuadrotor), "");
  EXPECT_NE(dynamics_refusal("nowhere.so").find("a.world:7: nowhere.so: cannot be opened"), std::string::npos);
  EXPECT_NE(dynamics_refusal(kQuadrotor + ":helicopter").find("has no dynamics 'helicopter'; expected one of"),
            std::string::npos);
  EXPECT_NE(dynamics_refusal(kQuadrotor, {{"hight", "1"}}).find("did you mean 'height'?"), std::string::npos);
  EXPECT_NE(dynamics_refusal(kQuadrotor, {{"height", "-1"}}).find("expects a number from 0 to 1000"),
            std::string::npos);
  EXPECT_EQ(dynamics_refusal(kTestPlugin + ":test-lift"), "");
  EXPECT_NE(dynamics_refusal(kTestPlugin + ":test-lift", {{"rise", "1e300"}})
                .find("dynamics 'test-lift' of robot 'robot1' failed: it moved to"),
            std::string::npos);
  EXPECT_NE(dynamics_refusal(kTestPlugin + ":test-lift", {{"rise", "-1"}}).find("failed: it cannot sink"),
            std::string::npos);
  EXPECT_NE(dynamics_refusal(kTestPlugin + ":test-large").find("5000 elements; expected at most 4096"),
            std::string::npos);
  EXPECT_NE(dynamics_refusal(kTestPlugin + ":test-picky-dynamics").find("refuses robot 'robot1': no"),
            std::string::npos);
}

TEST(OwnDynamics, AFleetWithoutThemRefusesToMove) {
  const world::World world = flying_world(kQuadrotor);
  robots::Fleet fleet(world);
  EXPECT_NE(refusal_of([&] { fleet.move(std::vector<base::Twist>(1), kFlightTick); }).find("'dynamics' of a plug-in"),
            std::string::npos);
}

}  // namespace
}  // namespace sf::control
