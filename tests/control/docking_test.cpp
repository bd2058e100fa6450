#include "control/docking.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "robots/fleet.h"
#include "tests/robots/scenes.h"

namespace sf::control {
namespace {

using base::Pose;
using base::Vec2;

constexpr std::int64_t kTick = 100'000'000;
constexpr double kRange = 1.8, kFov = 0.7, kHalo = 0.6;

// The dock's light by formula: the red buoy's beam on the left, the green one's on the right, a quarter of each in
// common.
double byte_at(const Pose& X_WD, Vec2 p) {
  const Vec2 from = base::rotate(-X_WD.yaw, p - Vec2{X_WD.x, X_WD.y});
  const double bearing = std::atan2(from.y, from.x), far = base::length(from);
  int byte = far <= kHalo ? 2 : 0;
  if (far <= kRange && std::abs(bearing - 0.375 * kFov) <= 0.5 * kFov) byte += 8;
  if (far <= kRange && std::abs(bearing + 0.375 * kFov) <= 0.5 * kFov) byte += 4;
  return byte == 0 ? 255.0 : 240.0 + byte;
}

struct Docked {
  bool done = false;
  double aside = 0.0;  // [m] from the dock's axis
  double off = 0.0;    // [rad] from facing it
  double far = 0.0;    // [m]
  double seconds = 0.0;
};

Docked dock(const Pose& X_WD, const Pose& from, bool solid) {
  world::World world = scenes::empty_world();
  scenes::add_create(world, from).sensors.push_back({.type = "irreceiver"});
  world.emitters.push_back(
      {.kind = world::Emitter::Kind::dock, .X_WE = X_WD, .range = kRange, .fov = kFov, .halo = kHalo});
  if (solid) {  // a face across the axis that the bumper meets
    scenes::add_wall(world, base::transform(X_WD, {0.08, -0.15}), base::transform(X_WD, {0.08, 0.15}));
  }
  Settings settings("controller 'docking'", {});
  const auto controller = docking_controller.make({world}, settings);
  robots::Fleet fleet(world);
  Docked result;
  for (int i = 0; i < 2400 && !controller->done(); ++i) {
    const base::Report& state = fleet.reports()[0];
    const std::vector<double> values{0.0, byte_at(X_WD, {state.X_WM.x, state.X_WM.y})};
    const base::ReadingBlock block{.kind = 11, .values = values};
    const base::Twist command[] = {controller->step(
        {.time = i * kTick, .state = state, .readings = {&block, 1}, .contact = fleet.contacts()[0] != 0})};
    EXPECT_TRUE(controller->intent().docking);
    fleet.move(command, kTick);
    result.seconds += 0.1;
  }
  const Pose& X = fleet.reports()[0].X_WM;
  const Vec2 at = base::rotate(-X_WD.yaw, Vec2{X.x, X.y} - Vec2{X_WD.x, X_WD.y});
  return {controller->done(), std::abs(at.y), std::abs(base::wrap_angle(X.yaw - X_WD.yaw - M_PI)), base::length(at),
          result.seconds};
}

TEST(Docking, from_anywhere_before_the_dock) {
  for (std::uint32_t i = 0; i < 40; ++i) {
    const auto u = base::random_uniform({.seed = 5, .a = i}, 0),
               v = base::random_uniform({.seed = 5, .a = i, .b = 1}, 0);
    const Pose X_WD{3.0, -2.0, 0.0, 6.28 * u[0]};
    const Pose from = base::compose(X_WD, {0.6 + 2.0 * u[1], 3.0 * v[0] - 1.5, 0.0, 6.28 * v[1]});
    for (const bool solid : {false, true}) {
      const Docked d = dock(X_WD, from, solid);
      ASSERT_TRUE(d.done) << i;
      EXPECT_LT(d.aside, 0.05) << i;
      EXPECT_LT(d.off, 0.75) << i;
      EXPECT_LT(d.far, solid ? 0.26 : 0.2) << i;
      EXPECT_LT(d.seconds, 120) << i;
    }
  }
}

struct Seen {
  double byte;
  double turn;  // its sign
  double forward;
  const char* why;
};

TEST(Docking, follows_the_line_between_the_buoys) {
  const Pose X_WD{};  // beams along x; the robot faces it
  for (const Seen& s : {Seen{252, 0, 0.1, "both"}, Seen{254, 0, 0.03, "both, in the force field: slowly"},
                        Seen{248, 1, 0, "red alone: to the left"}, Seen{244, -1, 0, "green alone: to the right"},
                        Seen{250, 1, 0, "red, in the field"}, Seen{246, -1, 0, "green, in the field"}}) {
    Docking docking({.X_WD = X_WD});
    const std::vector<double> both{0.0, 252.0};
    const base::ReadingBlock before{.kind = 11, .values = both};
    docking.step({.state = {.X_WM = {1.2, 0, 0, M_PI}}, .readings = {&before, 1}});
    const std::vector<double> values{0.0, s.byte};
    const base::ReadingBlock block{.kind = 11, .values = values};
    const base::Twist twist = docking.step({.state = {.X_WM = {1.0, 0, 0, M_PI}}, .readings = {&block, 1}});
    EXPECT_NEAR(twist.forward, s.forward, 1e-12) << s.why;
    EXPECT_EQ(std::abs(twist.turn) < 1e-9 ? 0.0 : std::copysign(1.0, twist.turn), s.turn) << s.why;
  }
}

TEST(Docking, without_light_it_goes_to_a_place_before_the_dock) {
  for (const double byte : {255.0, 242.0, 240.0, 130.0, std::nan("")}) {
    Docking docking({.X_WD = {}, .stage = 1.0});
    const std::vector<double> values{0.0, byte};
    const base::ReadingBlock block{.kind = 11, .values = values};
    const base::Twist twist = docking.step({.state = {.X_WM = {1.0, 2.0, 0, -M_PI / 2}}, .readings = {&block, 1}});
    EXPECT_EQ(twist.forward, 0.1) << byte;
    EXPECT_NEAR(twist.turn, 0.0, 1e-9) << byte;
  }
}

TEST(Docking, near_with_one_buoy_alone_it_begins_again) {
  Docking docking({.X_WD = {}, .stage = 1.0});
  const std::vector<double> values{0.0, 250.0};
  const base::ReadingBlock block{.kind = 11, .values = values};
  const base::Twist twist = docking.step({.state = {.X_WM = {0.4, 0.2, 0, 0}}, .readings = {&block, 1}});
  EXPECT_LT(twist.turn, 0.0) << "to (1, 0), away from the dock";
  EXPECT_NEAR(twist.turn, 3.0 * std::atan2(-0.2, 0.6), 1e-9);
}

TEST(Docking, a_touch_elsewhere_is_no_dock) {
  Docking docking({.X_WD = {}});
  docking.step({.state = {.X_WM = {1.5, 0, 0, M_PI}}, .contact = true});
  EXPECT_FALSE(docking.done());
  docking.step({.state = {.X_WM = {0.25, 0, 0, M_PI}}, .contact = true});
  EXPECT_TRUE(docking.done());
}

}  // namespace
}  // namespace sf::control
