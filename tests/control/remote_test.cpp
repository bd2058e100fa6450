#include "control/remote.h"

#include <gtest/gtest.h>

#include "tests/robots/scenes.h"

namespace sf::control {
namespace {

/// Boundary: a command applies up to its timeout, and a later one again.
TEST(Remote, StopsAfterItsTimeout) {
  Remote remote(500);
  ControllerInput input;
  EXPECT_EQ(remote.step(input).forward, 0.0) << "no command yet";
  input.time = 1000;
  remote.command({0.25, 0.0, 0.5}, 1000);
  EXPECT_EQ(remote.step(input).forward, 0.25);
  input.time = 1500;
  EXPECT_EQ(remote.step(input).turn, 0.5);
  input.time = 1501;
  EXPECT_EQ(remote.step(input).forward, 0.0);
  remote.command({-0.1, 0.0, 0.0}, 1600);
  input.time = 1700;
  EXPECT_EQ(remote.step(input).forward, -0.1);
}

TEST(Remote, IsFoundInItsShell) {
  world::World world = scenes::boxed_world(6.0, 4.0, {-3.0, -2.0});
  scenes::add_mover(world, {}, scenes::rectangle({0.0, 0.0}, 0.3, 0.3));
  ControllerConfig config;
  config.name = "remote";
  EXPECT_NE(remote_of(*make_controller({world}, config).controller), nullptr);
  Remote alone(1);
  EXPECT_EQ(remote_of(alone), &alone);
}

}  // namespace
}  // namespace sf::control
