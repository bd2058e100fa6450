// The derived sensor `model`: files of learnt models, wiring, and readings.

#include "sensors/model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/time.h"
#include "farm/farm.h"
#include "robots/fleet.h"
#include "sensors/model_file.h"
#include "tests/device.h"
#include "tests/folder.h"
#include "tests/refusal.h"
#include "world/stage/build_world.h"

namespace sf::sensors {
namespace {

/// value = 2 rate + 1 rad/s, for rates from -1 to 1 rad/s; error 0.5.
ModelFile twice_the_rate() {
  ModelFile file{.inputs = {"gyro.rate_rad_s"}, .output = "gyro:1.rate_rad_s", .rate = 20.0, .regression = {}};
  file.regression = {.structure = {},
                     .scales = {{0.0, 1.0}},
                     .output = {1.0, 2.0},
                     .weights = {0.0, 1.0},
                     .range = {{-1.0}, {1.0}, {1.0}, 10.0},
                     .error = {0.25, 0.5}};
  return file;
}

/// value = 0.5 times the value before + rate.
ModelFile decay() {
  ModelFile file = twice_the_rate();
  file.regression.structure.output_lags = 1;
  file.regression.scales = {{0.0, 1.0}, {0.0, 1.0}};
  file.regression.output = {0.0, 1.0};
  file.regression.weights = {0.0, 1.0, 0.5};
  file.regression.range = {{-1.0, -9.0}, {1.0, 9.0}, {1.0, 0.0, 1.0}, 100.0};
  return file;
}

class ModelTest : public FolderTest {
 protected:
  world::World robot_with(const std::string& model) {
    write("model.toml", text_of(file_));
    return world::build_world(path("model.world"),
                              "position( name \"r\" size [0.3 0.3 0.1] drive \"diff\" gyro( name \"a\" rate 20 ) "
                              "gyro( name \"b\" rate 20 ) encoder( rate 20 )\n" +
                                  model + " )\n",
                              {.sensors = world_file_words()});
  }
  std::string refusal(const std::string& model) {
    return refusal_of([&] { const SensorSet all(robot_with(model)); });
  }
  /// Readings of the model while the robot turns at these rates, tick by tick.
  std::vector<std::vector<double>> readings(const std::string& model, std::initializer_list<double> rates) {
    const world::World world = robot_with(model);
    farm::Farm farm(world, host_device(), {.noise = false, .threads = 1});
    farm.subscribe_all();
    std::vector<base::Report> reports = robots::states_at_load(world);
    std::vector<std::vector<double>> all;
    std::int64_t tick = 0;
    for (const double rate : rates) {
      reports[0].velocity.turn = rate;
      for (const base::ReadingBlock& block : farm.tick(tick++ * base::kSecond / 20, reports))
        if (block.type == kModel) all.emplace_back(block.values.begin(), block.values.end());
    }
    return all;
  }

  ModelFile file_ = twice_the_rate();
};

constexpr const char* kSimple = "derived( type \"model\" file \"model.toml\" inputs [\"gyro\"] rate 20 )";

TEST_F(ModelTest, ValueIsTheModelsWithItsErrorAsVariance) {
  const auto all = readings(kSimple, {0.25, -0.5});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0], (std::vector<double>{1.5, 1.0, 0.25}));
  EXPECT_EQ(all[1], (std::vector<double>{0.0, 1.0, 0.25}));
}

TEST_F(ModelTest, InputsOutsideTheTrainingRangeAreNotValid) {
  const auto all = readings(kSimple, {0.25, 1.25, 0.25});
  EXPECT_EQ(all[1][1], 0.0);
  EXPECT_TRUE(std::isnan(all[1][0]));
  EXPECT_EQ(all[2][1], 1.0) << "valid again";
}

TEST_F(ModelTest, UsesItsOwnValuesWithoutTheSensorThatItStandsFor) {
  file_ = decay();
  const auto all = readings(kSimple, {1.0, 0.0, 0.0});
  EXPECT_EQ(all[0][0], 1.0);
  EXPECT_EQ(all[1][0], 0.5);
  EXPECT_EQ(all[2][0], 0.25);
  EXPECT_EQ(all[2][2], 0.25) << "variance of free runs";
}

TEST_F(ModelTest, UsesTheMeasuredOutputWhereItIsAnInput) {
  file_ = decay();
  const auto all = readings(
      "derived( type \"model\" file \"model.toml\" inputs [\"gyro\" \"measured=gyro:1\"] rate 20 )", {1.0, 0.0, 0.0});
  EXPECT_EQ(all[0][1], 0.0) << "no value before the first";
  EXPECT_EQ(all[1][0], 0.5) << "half of 1 rad/s measured";
  EXPECT_EQ(all[2][0], 0.0);
  EXPECT_EQ(all[2][2], 0.0625) << "variance of one step";
}

TEST_F(ModelTest, OtherInputsThanThoseOfTheTrainingAreRefused) {
  EXPECT_EQ(refusal(kSimple), "");
  expect_in("learnt with gyro.rate_rad_s as number 1 of its inputs; this is encoder.left_m",
            refusal("derived( type \"model\" file \"model.toml\" inputs [\"encoder\"] rate 20 )"));
  expect_in("with nothing as number 2",
            refusal("derived( type \"model\" file \"model.toml\" inputs [\"gyro\" \"gyro:1\"] "
                    "rate 20 )"));
  expect_in("output is gyro:1.rate_rad_s; 'measured' is encoder.left_m",
            refusal("derived( type \"model\" file \"model.toml\" inputs [\"gyro\" \"measured=encoder\"] rate 20 )"));
  expect_in("learnt at 20 Hz; this sensor has 10 Hz",
            refusal("derived( type \"model\" file \"model.toml\" inputs [\"gyro\"] rate 10 )"));
  expect_in("identify", refusal("derived( type \"model\" inputs [\"gyro\"] rate 20 )"));
  expect_in("nowhere.toml", refusal("derived( type \"model\" file \"nowhere.toml\" inputs [\"gyro\"] rate 20 )"));
}

TEST(ModelFiles, TextKeepsEveryBit) {
  ModelFile file = decay();
  file.regression.structure.hidden = 1;
  file.regression.weights = {0.1, 1.0 / 3.0, -2e-300, 1e17, 0.0, 1.0, 2.0};
  const ModelFile again = parse_model_file("m.toml", text_of(file));
  EXPECT_EQ(again.regression.weights, file.regression.weights);
  EXPECT_EQ(again.regression.structure, file.regression.structure);
  EXPECT_EQ(again.inputs, file.inputs);
  EXPECT_EQ(text_of(again), text_of(file));
}

TEST(ModelFiles, EachDefectIsNamedWithItsLine) {
  const std::string good = text_of(decay());
  const auto refusal_with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return refusal_of([&] { parse_model_file("m.toml", text); });
  };
  expect_in("'weights' has 2 numbers; expected 3", refusal_with("weights = [0, 1, 0.5]", "weights = [0, 1]"));
  expect_in("m.toml:7: 'hidden' expects a number from 0 to 64", refusal_with("hidden = 0", "hidden = 1000000000"));
  expect_in("m.toml:7: 'hidden' expects a whole number", refusal_with("hidden = 0", "hidden = 0.5"));
  expect_in("expects a number", refusal_with("weights = [0, 1, 0.5]", "weights = [0, 1, nan]"));
  expect_in("'deviations' expects a number", refusal_with("deviations = [1, 1]", "deviations = [1, 0]"));
  expect_in("deviation > 0", refusal_with("output_scale = [0, 1]", "output_scale = [0, -1]"));
  expect_in("0 inputs", refusal_with("inputs = [\"gyro.rate_rad_s\"]", "inputs = []"));
  expect_in("has no 'distance'", refusal_with("distance = 100\n", ""));
  expect_in("unknown key 'depth'", refusal_with("hidden = 0", "depth = 0"));
}

}  // namespace
}  // namespace sf::sensors
