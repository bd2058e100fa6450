// World-file settings of magnetometers, valid and invalid.

#include <gtest/gtest.h>

#include "sensors/magnetometer.h"
#include "sensors/sensor_set.h"
#include "tests/refusal.h"
#include "tests/sensors/magnet_scenes.h"
#include "world/stage/build_world.h"

namespace sf::sensors {
namespace {

using scenes::setting;
using scenes::text;

world::Sensor bare() {
  world::Sensor sensor = scenes::array({});
  sensor.settings.clear();
  sensor.file = "park.world";
  sensor.line = 7;
  return sensor;
}

/// A sensor of `count` with the poses of the thesis' listing, correctly numbered.
world::Sensor listed(std::uint32_t count) {
  world::Sensor sensor = bare();
  sensor.settings.push_back(setting("scount", {static_cast<double>(count)}));
  for (std::uint32_t i = 0; i < count; ++i)
    sensor.settings.push_back(setting("spose[" + std::to_string(i) + "]", {-0.15 + 0.075 * i, 0, 0}));
  return sensor;
}

TEST(MagnetometerSettings, AcceptsTheNumberedListingOfTheThesis) {
  const Magnetometer m = read_magnetometer(listed(5));
  ASSERT_EQ(m.X_SE.size(), 5u);
  EXPECT_DOUBLE_EQ(m.X_SE[0].x, -0.15);
  EXPECT_DOUBLE_EQ(m.X_SE[4].x, 0.15);
  EXPECT_FALSE(m.magnitudes);
  EXPECT_EQ(m.sigma, 0.0);
}

/// The thesis' figure 23 numbers all five elements 0.
TEST(MagnetometerSettings, ReadsTheListingOfTheThesis) {
  for (const char* key : {"spose[0] [", "spose3[0] [0 "}) {
    SCOPED_TRACE(key);
    const auto line = [&](const char* x) { return std::string(key) + x + " 0 0 ]\n"; };
    const world::World world = world::build_world(
        "figure23.world",
        "define roombamagnetometer magnetometer\n(\nscount 5\n" + line("-0.15") + line("-0.075") + line("0.00") +
            line("0.075") + line("0.15") + "ssensitivity [ -10000 10000 ]\nssize [ 0.01 0.05 ]\n)\n" +
            "define roomba position( size [0.33 0.33 0.1] )\n" +
            "roomba( name \"roomba0\" color \"red\" roombamagnetometer( pose [0 -0.2 -0.04 0] size [0.1 0.1 0.1] ) )",
        {.sensors = world_file_words()});
    const bool lifted = key[5] == '3';
    const Magnetometer m = read_magnetometer(world.movers.at(0).sensors.at(0));
    ASSERT_EQ(m.X_SE.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_DOUBLE_EQ(lifted ? m.X_SE[i].y : m.X_SE[i].x, -0.15 + 0.075 * static_cast<double>(i));
    ASSERT_EQ(world.warnings.size(), 4u);
    for (int i = 1; i < 5; ++i) {
      const world::Warning& warning = world.warnings[static_cast<std::size_t>(i - 1)];
      EXPECT_EQ(warning.line, 4 + i);
      expect_in("read as '" + std::string(lifted ? "spose3[" : "spose[") + std::to_string(i) + "]'", warning.message);
    }
  }
}

TEST(MagnetometerSettings, DefaultIsOneElementAtTheCentre) {
  const Magnetometer m = read_magnetometer(bare());
  ASSERT_EQ(m.X_SE.size(), 1u);
  EXPECT_EQ(m.X_SE[0].x, 0.0);
  EXPECT_EQ(m.X_SE[0].yaw, 0.0);
}

TEST(MagnetometerSettings, UsesTheUnitsOfTheFile) {
  world::Sensor sensor = bare();
  sensor.metres_per_unit = 0.01;
  sensor.radians_per_unit = M_PI / 180;
  sensor.settings = {setting("scount", {2}), setting("spose[0]", {20, -5, 90}), setting("spose3[1]", {1, 2, 3, -180}),
                     setting("ssensitivity", {-2, 3}), setting("noise", {0.5})};
  const Magnetometer m = read_magnetometer(sensor);
  EXPECT_DOUBLE_EQ(m.X_SE[0].x, 0.2);
  EXPECT_DOUBLE_EQ(m.X_SE[0].y, -0.05);
  EXPECT_DOUBLE_EQ(m.X_SE[0].yaw, M_PI / 2);
  EXPECT_DOUBLE_EQ(m.X_SE[1].z, 0.03);
  EXPECT_DOUBLE_EQ(m.X_SE[1].yaw, -M_PI);
  EXPECT_DOUBLE_EQ(m.least, -2e-4);
  EXPECT_DOUBLE_EQ(m.most, 3e-4);
  EXPECT_DOUBLE_EQ(m.sigma, 0.5e-4);
}

TEST(MagnetometerSettings, ElementsAreAtHalfTheModelsHeight) {
  world::World world;
  world::Sensor sensor = listed(3);
  sensor.X_MS = {0.1, 0, 0.06, 0};
  sensor.height = 0.05;
  scenes::add_carrier(world, {0, 0, 0, 0}, sensor);
  scenes::add_carrier(world, {0, 0, 0, 0}, sensor);
  const SensorSet sensor_set(world);
  const auto rows = sensor_set.of(kMagnetometer, 1);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_DOUBLE_EQ(rows[0].X_MS.z, 0.085);
  EXPECT_EQ(rows[0].elements, 3u);
  EXPECT_EQ(rows[0].mover, 1u);
  EXPECT_EQ(rows[0].sensor, 0u);
}

TEST(MagnetometerSettings, RejectsInvalidSettingsWithFileAndLine) {
  const struct {
    const char* name;
    const char* removed;  ///< key
    world::Setting changed;
    const char* says;
  } rows[] = {
      {"a missing pose", "spose[1]", {}, "'spose[1]' is missing: 'scount 5' requires spose[0] to spose[4]"},
      {"the last one missing", "spose[4]", {}, "'spose[4]' is missing"},
      {"one more than counted", "", setting("spose[5]", {0, 0, 0}), "'spose[5]' is beyond 'scount 5'"},
      {"far more than counted", "", setting("spose3[99999999999999999999]", {0, 0, 0, 0}), "is beyond"},
      {"no count", "scount", {}, "is beyond 'scount 1'"},
      {"none", "", setting("scount", {0}), "expected 1 to 16"},
      {"too many", "", setting("scount", {17}), "expected 1 to 16"},
      {"a half", "", setting("scount", {2.5}), "whole number"},
      {"negative", "", setting("scount", {-1}), "expected 1 to 16"},
      {"a word", "", text("scount", "five"), "expects a number"},
      {"two numbers", "", setting("spose[2]", {0, 0}), "[x y yaw]"},
      {"flat and lifted", "", setting("spose3[2]", {0, 0, 0, 0}), "both spose[2] and spose3[2]"},
      {"three of four", "spose[0]", setting("spose3[0]", {0, 0, 0}), "[x y z yaw]"},
      {"far away", "", setting("spose[3]", {0, 2e6, 0}), "more than"},
      {"sensitivity in the wrong order", "", setting("ssensitivity", {1, -1}), "min below max"},
      {"no width", "", setting("ssensitivity", {1, 1}), "min below max"},
      {"one bound", "", setting("ssensitivity", {1}), "[min max] in Gauss"},
      {"beyond all", "", setting("ssensitivity", {-1e10, 1}), "1e+09"},
      {"negative noise", "", setting("noise", {-0.1}), "'noise'"},
      {"noise without a number", "", setting("noise", {}), "'noise'"},
      {"another sum", "", text("sum", "maximum"), "\"vector\" or \"magnitude\""},
  };
  for (const auto& [name, removed, changed, says] : rows) {
    SCOPED_TRACE(name);
    world::Sensor sensor = listed(5);
    std::erase_if(sensor.settings, [&](const world::Setting& s) { return s.key == removed || s.key == changed.key; });
    if (!changed.key.empty()) sensor.settings.push_back(changed);
    for (world::Setting& s : sensor.settings) s.file = "park.world", s.line = 42;
    const std::string error = refusal_of([&] { read_magnetometer(sensor); });
    EXPECT_TRUE(error.starts_with("park.world:42: ")) << error;
    expect_in(says, error);
  }
}

}  // namespace
}  // namespace sf::sensors
