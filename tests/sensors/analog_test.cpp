// Analogue inputs: constant voltages, photo sensors, range and resolution of the converter.

#include "sensors/analog.h"

#include <gtest/gtest.h>

#include "tests/sensors/host_trial.h"

namespace sf::trial {
namespace {

world::Setting source(const std::string& key, const std::string& word, double gain) {
  world::Setting made = setting(key, {gain});
  made.text = word;
  return made;
}

TEST(Analog, ConvertsVoltages) {
  const auto read = [](double volts, std::vector<world::Setting> more = {}) {
    more.insert(more.begin(), source("input[0]", "constant", volts));
    return read_once(carriers(fitted("analog", std::move(more))));
  };
  EXPECT_EQ(read(2.5), (std::vector<double>{2.5, 512})) << "half of 1023, rounded";
  EXPECT_EQ(read(0), (std::vector<double>{0, 0}));
  EXPECT_EQ(read(5), (std::vector<double>{5, 1023}));
  EXPECT_EQ(read(6), (std::vector<double>{5, 1023})) << "saturates";
  EXPECT_EQ(read(-1), (std::vector<double>{0, 0}));
  EXPECT_EQ(read(1, {setting("bits", {1})}), (std::vector<double>{1, 0}));
  EXPECT_EQ(read(0, {setting("range", {-10, 10}), setting("bits", {16})}), (std::vector<double>{0, 32768}));
}

TEST(Analog, InputsWithoutACircuitAreAtZero) {
  EXPECT_EQ(read_once(carriers(fitted("analog"))), (std::vector<double>{0, 0}));
  EXPECT_EQ(read_once(carriers(fitted("analog", {setting("inputs", {2}), source("input[1]", "constant", 5)}))),
            (std::vector<double>{0, 0, 5, 1023}));
}

TEST(Analog, ReadsPhotoSensorsAtTheirPlaces) {
  world::World world = carriers(
      fitted("analog", {setting("inputs", {3}), source("input[0]", "light", 0.004), source("input[1]", "light", 0.004),
                        source("input[2]", "constant", 1.5), setting("spose[1]", {1, 0, 0})}));
  world.lamps = {{world::kNone, {3, 0, 0, 0}, 900.0}};
  world.ambient_light = 100.0;
  const std::vector<double> r = read_once(world);
  ASSERT_EQ(r.size(), 6u);
  EXPECT_DOUBLE_EQ(r[0], 0.004 * (100 + 100));
  EXPECT_DOUBLE_EQ(r[2], 0.004 * (100 + 225)) << "a metre nearer";
  EXPECT_EQ(r[4], 1.5);
}

TEST(Analog, RejectsInvalidSettings) {
  const world::Setting good = source("input[0]", "constant", 1);
  expect_refused("analog", {source("input[0]", "sonar", 1)}, 8, "[\"constant\" volts]");
  expect_refused("analog", {setting("input[0]", {1})}, 8, "[\"constant\" volts]");
  expect_refused("analog", {source("input[0]", "constant", 1e4)}, 8, "expected -1000 to 1000");
  expect_refused("analog", {good, source("input[1]", "constant", 1)}, 9, "beyond 'inputs 1'");
  expect_refused("analog", {good, setting("spose[1]", {0, 0, 0})}, 9, "beyond 'inputs 1'");
  expect_refused("analog", {good, setting("inputs", {17})}, 9, "expected 1 to 16");
  expect_refused("analog", {good, setting("bits", {17})}, 9, "expected 1 to 16");
  expect_refused("analog", {good, setting("range", {5, 5})}, 9, "min below max");
}

}  // namespace
}  // namespace sf::trial
