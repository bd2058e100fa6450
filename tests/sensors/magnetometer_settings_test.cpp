// World-file settings of magnetometers, valid and invalid.

#include <gtest/gtest.h>

#include <functional>

#include "base/error.h"
#include "sensors/magnetometer.h"
#include "sensors/sensor_set.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::sensors {
namespace {

using scenes::setting;

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

/// One invalid file: the change, and the expected message in addition to file and line.
struct Wrong {
  std::string name;
  std::function<void(world::Sensor&)> spoil;
  std::string says;
};

void put(world::Sensor& sensor, const std::string& key, std::vector<double> numbers) {
  std::erase_if(sensor.settings, [&](const world::Setting& s) { return s.key == key; });
  sensor.settings.push_back({key, std::move(numbers), "", 42, "park.world"});
}

void say(world::Sensor& sensor, const std::string& key, const std::string& text) {
  sensor.settings.push_back({key, {}, text, 42, "park.world"});
}

TEST(MagnetometerSettings, RejectsInvalidSettingsWithFileAndLine) {
  const std::vector<Wrong> corpus = {
      {"the thesis' sample, whose spose[0] came five times",
       [](auto& s) {
         std::erase_if(s.settings, [](const auto& x) { return x.key != "scount" && x.key != "spose[0]"; });
       },
       "'spose[1]' is missing: 'scount 5' requires spose[0] to spose[4]"},
      {"the last one missing", [](auto& s) { s.settings.pop_back(); }, "'spose[4]' is missing"},
      {"one more than counted",
       [](auto& s) {
         put(s, "spose[5]", {0, 0, 0});
       },
       "'spose[5]' is beyond 'scount 5'"},
      {"far more than counted",
       [](auto& s) {
         put(s, "spose3[99999999999999999999]", {0, 0, 0, 0});
       },
       "is beyond"},
      {"no count", [](auto& s) { std::erase_if(s.settings, [](const auto& x) { return x.key == "scount"; }); },
       "is beyond 'scount 1'"},
      {"none", [](auto& s) { put(s, "scount", {0}); }, "expected 1 to 16"},
      {"too many", [](auto& s) { put(s, "scount", {17}); }, "expected 1 to 16"},
      {"a half", [](auto& s) { put(s, "scount", {2.5}); }, "whole number"},
      {"negative", [](auto& s) { put(s, "scount", {-1}); }, "expected 1 to 16"},
      {"a word",
       [](auto& s) {
         std::erase_if(s.settings, [](const auto& x) { return x.key == "scount"; });
         say(s, "scount", "five");
       },
       "expects a number"},
      {"two numbers",
       [](auto& s) {
         put(s, "spose[2]", {0, 0});
       },
       "[x y yaw]"},
      {"flat and lifted",
       [](auto& s) {
         put(s, "spose3[2]", {0, 0, 0, 0});
       },
       "both spose[2] and spose3[2]"},
      {"three of four",
       [](auto& s) {
         put(s, "spose3[0]", {0, 0, 0});
         std::erase_if(s.settings, [](const auto& x) { return x.key == "spose[0]"; });
       },
       "[x y z yaw]"},
      {"far away",
       [](auto& s) {
         put(s, "spose[3]", {0, 2e6, 0});
       },
       "more than"},
      {"sensitivity the wrong way round",
       [](auto& s) {
         put(s, "ssensitivity", {1, -1});
       },
       "min below max"},
      {"no width",
       [](auto& s) {
         put(s, "ssensitivity", {1, 1});
       },
       "min below max"},
      {"one bound", [](auto& s) { put(s, "ssensitivity", {1}); }, "[min max] in Gauss"},
      {"beyond all",
       [](auto& s) {
         put(s, "ssensitivity", {-1e10, 1});
       },
       "1e+09"},
      {"negative noise", [](auto& s) { put(s, "noise", {-0.1}); }, "'noise'"},
      {"noise without a number", [](auto& s) { put(s, "noise", {}); }, "'noise'"},
      {"another sum", [](auto& s) { say(s, "sum", "maximum"); }, "\"vector\" or \"magnitude\""},
  };
  for (const Wrong& wrong : corpus) {
    world::Sensor sensor = listed(5);
    for (world::Setting& s : sensor.settings) s.file = "park.world", s.line = 42;
    wrong.spoil(sensor);
    try {
      read_magnetometer(sensor);
      ADD_FAILURE() << wrong.name << ": taken";
    } catch (const base::InputError& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with("park.world:42: ")) << wrong.name << ": " << what;
      EXPECT_NE(what.find(wrong.says), std::string::npos) << wrong.name << ": " << what;
    }
  }
}

}  // namespace
}  // namespace sf::sensors
