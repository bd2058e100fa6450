// Bumpers: switches pressed by contacts, and invalid settings.

#include "sensors/bumper.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "tests/sensors/host_trial.h"

namespace sf::trial {
namespace {

using sensors::read_bumper;

world::Sensor zones(const std::vector<std::vector<double>>& arcs, double yaw = 0.0) {
  std::vector<world::Setting> settings{setting("zones", {static_cast<double>(arcs.size())})};
  for (std::size_t i = 0; i < arcs.size(); ++i) settings.push_back(setting("zone[" + std::to_string(i) + "]", arcs[i]));
  world::Sensor sensor = fitted("bumper", std::move(settings));
  sensor.X_MS.yaw = yaw;
  return sensor;
}

std::uint32_t one(double from, double to, double yaw = 0.0) { return read_bumper(zones({{from, to}}, yaw))[0]; }

TEST(Bumper, ZonesContainSectorsByTheirCentre) {
  EXPECT_EQ(one(0, 90), 0x000000FFu) << "eight sectors to the left";
  EXPECT_EQ(one(-90, 0), 0xFF000000u) << "eight to the right: none in common";
  EXPECT_EQ(one(-180, 180), 0xFFFFFFFFu) << "all round";
  EXPECT_EQ(one(0, 360), 0xFFFFFFFFu);
  EXPECT_EQ(one(0, 11.25), 0x1u) << "one sector";
  EXPECT_EQ(one(5, 6), 0x1u) << "just its middle, 5.625 degrees";
  EXPECT_EQ(one(0, 16.8), 0x1u) << "short of the next one's middle, 16.875";
  EXPECT_EQ(one(0, 16.9), 0x3u);
  EXPECT_EQ(one(150, -150), one(150, 210)) << "through straight behind";
  EXPECT_EQ(one(-11.25, 90), 0x800000FFu) << "one sector across the middle";
  EXPECT_EQ(one(0, 90, M_PI), 0x00FF0000u) << "turned with the sensor: rear right";
}

TEST(Bumper, AdjacentZonesShareNoSector) {
  for (int k = 0; k < 64; ++k) {
    const double edge = -180.0 + 5.625 * k;  // edges and centres of sectors
    const std::uint32_t left = one(edge, edge + 180.0), right = one(edge + 180.0, edge + 360.0);
    EXPECT_EQ(left & right, 0u) << edge;
    EXPECT_EQ(left | right, 0xFFFFFFFFu) << edge;
  }
}

TEST(Bumper, HasOneSwitchAllAroundWithoutZones) {
  EXPECT_EQ(read_bumper(fitted("bumper")), (std::vector<std::uint32_t>{0xFFFFFFFFu}));
}

/// Stage's Roomba: two bars of 0.33 m across both front corners.
TEST(Bumper, StageBarsAreArcsBetweenTheirEnds) {
  std::vector<world::Setting> bars{setting("bcount", {2}), setting("blength", {0.33}),
                                   setting("bpose[0]", {0.12, 0.12, 0.02, 45}),
                                   setting("bpose[1]", {0.12, -0.12, 0.02, -45})};
  EXPECT_EQ(read_bumper(fitted("bumper", bars)), (std::vector<std::uint32_t>{0x000000FFu, 0xFF000000u}));
  bars.push_back(setting("blength[1]", {0.03}));
  EXPECT_EQ(read_bumper(fitted("bumper", bars))[1], 1u << 28) << "a short one is as wide as a sector";
  bars.pop_back();
  bars.pop_back();
  EXPECT_THROW(read_bumper(fitted("bumper", bars)), base::InputError) << "the second bar is missing";
}

/// At the rear, where bearings wrap; rotated and moved with the sensor; with Stage's default length.
TEST(Bumper, StageBarsBehindAndOnARotatedSensor) {
  const auto bar = [](std::vector<double> pose, const base::Pose& X_MS, std::vector<world::Setting> more = {}) {
    std::vector<world::Setting> settings{setting("bcount", {1}), setting("bpose[0]", std::move(pose))};
    settings.insert(settings.end(), more.begin(), more.end());
    world::Sensor sensor = fitted("bumper", std::move(settings));
    sensor.X_MS = X_MS;
    return read_bumper(sensor)[0];
  };
  const world::Setting wide = setting("blength", {0.33});
  constexpr std::uint32_t kRear = 0x001FF800u;  // centres from 129 to 231 degrees; the bar's ends are at 126 and 234
  EXPECT_EQ(bar({-0.12, 0, 0, 180}, {}, {wide}), kRear);
  EXPECT_EQ(bar({0.12, 0, 0, 0}, {0, 0, 0, M_PI}, {wide}), kRear) << "turned";
  EXPECT_EQ(bar({0, 0, 0, 0}, {-0.12, 0, 0, M_PI}, {wide}), kRear) << "moved";
  EXPECT_EQ(bar({0.05, 0, 0, 0}, {}), 0xF000000Fu) << "10 cm long, 45 degrees to either side";
}

/// Each sector alone, and its reading, robot by robot.
TEST(Bumper, ReadsCurrentContacts) {
  const world::World world = carriers(zones({{0, 90}, {-90, 0}}), {{0, 0, 0, 0}, {1, 0, 0, 2}});
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  for (std::uint32_t k = 0; k < base::kContactSectors; ++k) {
    states[0].contact_mask = 1u << k;
    states[1].contact_mask = k == 3 ? 0xFFFFFFFFu : 0u;
    const auto readings = farm.tick(k * 100'000'000ll, states);
    ASSERT_EQ(readings.size(), 2u);
    EXPECT_EQ(readings[0].type, sensors::kBumper);
    EXPECT_EQ(values_of(readings[0]), (std::vector<double>{k < 8 ? 1.0 : 0.0, k >= 24 ? 1.0 : 0.0})) << k;
    EXPECT_EQ(readings[1].values[0], k == 3 ? 1.0 : 0.0) << "released with the next tick";
  }
}

TEST(Bumper, IsReleasedBeforeTheFirstReport) {
  const world::World world = carriers(fitted("bumper"));
  const Glance run(world);
  EXPECT_EQ(values_of(run.readings[0]), std::vector<double>{0.0});
  EXPECT_EQ(run.farm.sensor_set().of(sensors::kBumper, 0)[0].elements, 1u);
}

TEST(Bumper, RejectsInvalidSettings) {
  const std::string type = "bumper";
  expect_refused(type, {setting("zones", {0})}, 8, "expected 1 to 32");
  expect_refused(type, {setting("zones", {33})}, 8, "expected 1 to 32");
  expect_refused(type, {setting("zones", {1.5})}, 8, "whole number");
  expect_refused(type, {text("zones", "two")}, 8, "'zones' expects a number");
  expect_refused(type, {setting("zones", {2}), setting("zone[0]", {0, 90})}, 8, "'zone[1]' is missing");
  expect_refused(type, {setting("zone[1]", {0, 90})}, 8, "beyond 'zones 1'");
  expect_refused(type, {setting("zones", {1}), setting("zone[0]", {0})}, 9, "expects [from to]");
  expect_refused(type, {setting("zone[0]", {20, 20})}, 8, "an arc counter-clockwise");
  expect_refused(type, {setting("zone[0]", {0, 361})}, 8, "at most one turn");
  expect_refused(type, {setting("zone[0]", {1e9, 2e9})}, 8, "within one turn");
  expect_refused(type, {setting("zone[0]", {0, 5})}, 8, "widen it");
}

}  // namespace
}  // namespace sf::trial
