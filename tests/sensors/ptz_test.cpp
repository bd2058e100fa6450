// Pan-tilt-zoom mounts: views in turn, speeds, limits.

#include "sensors/ptz.h"

#include <gtest/gtest.h>

#include "tests/sensors/host_trial.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using sensors::position_of;
using sensors::Ptz;
using sensors::PtzAxes;

TEST(PanTiltZoom, VisitsViewsInTurn) {
  const Ptz mount{{1.0, 0.5, 2.0}, {{{0, 0, 1}, 2.0}, {{1, 1, 0.5}, 1.0}}};
  const auto expect = [&](double time, const PtzAxes& axes, const char* why) {
    const PtzAxes at = position_of(mount, time);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(at[k], axes[k], 1e-9) << why << ", axis " << k;
  };
  expect(0, {0, 0, 1}, "starts in the first view");
  expect(2, {0, 0, 1}, "holds it");
  expect(3, {0.5, 0.5, 0.75}, "half way: tilting by 1 rad takes 2 s");
  expect(4, {1, 1, 0.5}, "arrives");
  expect(5, {1, 1, 0.5}, "holds the second");
  expect(6.5, {0.25, 0.25, 0.875}, "on its way back");
  expect(7, {0, 0, 1}, "one cycle");
  expect(7e6 + 3, {0.5, 0.5, 0.75}, "a million cycles");
  EXPECT_EQ(position_of({{1, 1, 1}, {{{0.1, 0.2, 0.3}, 0.0}}}, 5.0), (PtzAxes{0.1, 0.2, 0.3})) << "one view";
}

/// Speeds are never exceeded.
TEST(PanTiltZoom, KeepsItsSpeeds) {
  const Ptz mount{{1.0, 0.5, 2.0}, {{{0, 0, 1}, 0.3}, {{1, -1, 0.5}, 0.0}, {{-1, 0.2, 0.2}, 0.1}}};
  PtzAxes last = position_of(mount, 0.0);
  for (int i = 1; i < 2000; ++i) {
    const PtzAxes now = position_of(mount, 0.01 * i);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LE(std::abs(now[k] - last[k]), 0.01 * mount.speed[k] + 1e-9) << i;
    last = now;
  }
}

TEST(PanTiltZoom, ReadsAtTheTimeOfEachReading) {
  const world::World world =
      carriers(fitted("ptz", {setting("pan_speed", {90}), setting("views", {2}), setting("view[0]", {0, 0, 45, 1}),
                              setting("view[1]", {90, 0, 45, 0}), setting("rate", {20})}));
  farm::Farm farm(world, device());
  farm.subscribe_all();
  const std::vector<base::Report> states = robots::states_at_load(world);
  EXPECT_EQ(farm.tick(0, states)[0].values[0], 0.0);
  EXPECT_NEAR(farm.sample(1'050'000'000, states)[0].values[0], 4.5 * kDegree, 1e-9);
  EXPECT_NEAR(farm.tick(1'100'000'000, states)[0].values[0], 9 * kDegree, 1e-9);
  EXPECT_NEAR(farm.tick(2'000'000'000, states)[0].values[0], 90 * kDegree, 1e-9);
  const std::vector<double> still = read_once(carriers(fitted("ptz")));
  EXPECT_EQ(still[0], 0.0) << "without views it looks ahead";
  EXPECT_NEAR(still[2], 47.5 * kDegree, 1e-12);
}

TEST(PanTiltZoom, RejectsInvalidSettings) {
  expect_refused("ptz", {setting("views", {1})}, 8, "'view[0]' is missing");
  expect_refused("ptz", {setting("views", {1}), setting("view[0]", {101, 0, 40, 1})}, 9,
                 "has the pan 101; expected -100");
  expect_refused("ptz", {setting("views", {1}), setting("view[0]", {0, 0, 60, 1})}, 9, "has the fov 60");
  expect_refused("ptz", {setting("views", {1}), setting("view[0]", {0, 0, 40, -1})}, 9, "holds -1 s");
  expect_refused("ptz", {setting("views", {1}), setting("view[0]", {0, 0, 40})}, 9, "[pan tilt fov seconds]");
  expect_refused("ptz", {setting("view[0]", {0, 0, 40, 1})}, 8, "beyond 'views 0'");
  expect_refused("ptz", {setting("views", {33})}, 8, "expected 1 to 32");
  expect_refused("ptz", {setting("pan", {10, -10})}, 8, "'pan' is [10 -10]");
  expect_refused("ptz", {setting("pan_speed", {0})}, 8, "'pan_speed' is 0");
}

}  // namespace
}  // namespace sf::trial
