// World-file settings of sonar and infrared, valid and invalid; the predefined rings; payloads.

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <limits>

#include "sensors/infrared.h"
#include "sensors/sensor_set.h"
#include "sensors/sonar.h"
#include "tests/refusal.h"
#include "tests/sensors/cone_trial.h"

namespace sf::sensors {
namespace {

using trial::cone_setting;

world::Sensor bare_sonar(const std::string& type = "sonar") {
  world::Sensor sensor = trial::cones(type, {Pose{}});
  sensor.settings.clear();
  return sensor;
}

world::Sensor with(std::vector<world::Setting> settings, const std::string& type = "sonar") {
  world::Sensor sensor = bare_sonar(type);
  sensor.settings = std::move(settings);
  return sensor;
}

TEST(SonarSettings, DefaultIsOneTransducerOfAPioneer) {
  const ConeArray s = read_sonar(bare_sonar(), 3, 1);
  EXPECT_EQ(s.row.mover, 3u);
  EXPECT_EQ(s.row.sensor, 1u);
  EXPECT_EQ(s.row.elements, 1u);
  EXPECT_EQ(s.row.limit, 4.0);
  EXPECT_EQ(s.row.rate, 25.0);
  EXPECT_DOUBLE_EQ(s.fov, 25.0 * kDegree);
  EXPECT_EQ(s.rays, 11u);
  EXPECT_EQ(s.range_min, 0.10);
  EXPECT_EQ(s.range_max, 4.0);
  EXPECT_EQ(s.turns, 1u);
  EXPECT_EQ(s.min_cosine, 0.0);
  EXPECT_EQ(s.sigma, 0.0);
  EXPECT_EQ(s.proportional, 0.0);
}

TEST(SonarSettings, DefaultIsOneElementOfAKhepera) {
  const ConeArray s = read_infrared(bare_sonar("infrared"), 0, 0);
  EXPECT_EQ(s.row.elements, 1u);
  EXPECT_EQ(s.row.limit, 0.05);
  EXPECT_EQ(s.row.rate, 50.0);
  EXPECT_DOUBLE_EQ(s.fov, 30.0 * kDegree);
  EXPECT_EQ(s.rays, 11u);
  EXPECT_EQ(s.range_min, 0.0);
  EXPECT_EQ(s.range_max, 0.05);
  EXPECT_EQ(s.turns, 1u);
  EXPECT_EQ(s.proportional, 0.0);
}

TEST(SonarSettings, UsesTheUnitsOfTheFile) {
  world::Sensor sensor =
      with({cone_setting("scount", {2}), cone_setting("spose[0]", {20, -5, 90}),
            cone_setting("spose3[1]", {1, 2, 3, -180}), cone_setting("fov", {15}), cone_setting("range", {10, 300}),
            cone_setting("incidence", {60}), cone_setting("noise", {2, 0.01})});
  sensor.metres_per_unit = 0.01;
  sensor.radians_per_unit = kDegree;
  const ConeArray s = read_sonar(sensor, 0, 0);
  EXPECT_DOUBLE_EQ(s.X_SC[0].x, 0.2);
  EXPECT_DOUBLE_EQ(s.X_SC[0].y, -0.05);
  EXPECT_DOUBLE_EQ(s.X_SC[0].yaw, M_PI / 2);
  EXPECT_DOUBLE_EQ(s.X_SC[1].z, 0.03);
  EXPECT_DOUBLE_EQ(s.fov, 15 * kDegree);
  EXPECT_DOUBLE_EQ(s.range_min, 0.1);
  EXPECT_DOUBLE_EQ(s.range_max, 3.0);
  EXPECT_DOUBLE_EQ(s.min_cosine, 0.5);
  EXPECT_DOUBLE_EQ(s.sigma, 0.02);
  EXPECT_EQ(s.proportional, 0.01);
}

/// Stage's older settings with the same meaning.
TEST(SonarSettings, AcceptsStagesView) {
  const ConeArray old = read_sonar(with({cone_setting("sview", {0.2, 5, 0.25})}), 0, 0);
  EXPECT_EQ(old.range_min, 0.2);
  EXPECT_EQ(old.range_max, 5.0);
  EXPECT_EQ(old.fov, 0.25);
  const ConeArray both = read_sonar(
      with({cone_setting("sview", {0.2, 5, 0.25}), cone_setting("range", {0.1, 2}), cone_setting("fov", {0.5})}), 0, 0);
  EXPECT_EQ(both.range_max, 2.0) << "`range` and `fov` take precedence";
  EXPECT_EQ(both.fov, 0.5);
}

TEST(SonarSettings, TurnsAreTheTransducersOfOneArray) {
  const auto turns = [](double count, std::vector<world::Setting> more) {
    world::Sensor sensor = trial::cones("sonar", std::vector<Pose>(static_cast<std::size_t>(count)), std::move(more));
    return read_sonar(sensor, 0, 0).turns;
  };
  EXPECT_EQ(turns(16, {}), 16u);
  EXPECT_EQ(turns(16, {cone_setting("arrays", {2})}), 8u);
  EXPECT_EQ(turns(16, {cone_setting("arrays", {16})}), 1u);
  EXPECT_EQ(turns(16, {cone_setting("firing", {}, "sequential")}), 16u);
  EXPECT_EQ(turns(16, {cone_setting("firing", {}, "all"), cone_setting("arrays", {2})}), 1u);
}

TEST(SonarSettings, OneRayIsOnTheAxis) {
  EXPECT_EQ(read_sonar(with({cone_setting("fov", {0})}), 0, 0).rays, 1u);
  EXPECT_EQ(read_sonar(with({cone_setting("incidence", {M_PI / 2})}), 0, 0).min_cosine, 0.0) << "off";
}

struct WrongSonar {
  const char* key;
  std::vector<double> numbers;
  const char* text;
  std::string says;
  const char* type = "sonar";
};

TEST(SonarSettings, RejectsInvalidSettingsWithFileAndLine) {
  const std::vector<WrongSonar> corpus = {
      {"scount", {0}, "", "'scount' is 0; expected 1 to 64"},
      {"scount", {65}, "", "'scount' is 65; expected 1 to 64"},
      {"scount", {2}, "", "'spose[0]' is missing"},
      {"spose[1]", {0, 0, 0}, "", "'spose[1]' is beyond 'scount 1'"},
      {"spose[0]", {0, 0}, "", "'spose[0]' expects [x y yaw]"},
      {"fov", {-0.1}, "", "'fov' is -0.1"},
      {"fov", {6.3}, "", "'fov' is 6.3"},
      {"fov", {}, "wide", "'fov' expects a number"},
      {"rays", {10}, "", "'rays' is 10; expected an odd number"},
      {"rays", {0}, "", "'rays' is 0; expected 1 to 1025"},
      {"rays", {1027}, "", "'rays' is 1027; expected 1 to 1025"},
      {"rays", {2.5}, "", "whole number"},
      {"range", {4}, "", "'range' expects [min max]"},
      {"range", {4, 4}, "", "'range' is [4 4] m; expected [min max] with 0 <= min < max"},
      {"range", {-0.1, 4}, "", "'range' is [-0.1 4] m"},
      {"range", {0, 1e-7}, "", "'range' is [0 1e-07] m"},
      {"range", {0, 2e4}, "", "'range' is [0 20000] m"},
      {"sview", {0, 5}, "", "'sview' expects [min max fov]"},
      {"sview", {5, 0, 0.2}, "", "'sview' is [5 0] m"},
      {"sview", {0, 5, 7}, "", "the third number of 'sview'"},
      {"firing", {}, "random", "'firing' is \"random\"; expected \"sequential\" or \"all\""},
      {"arrays", {2}, "", "'arrays' is 2; expected 1 to 1"},
      {"incidence", {0}, "", "'incidence' is 0"},
      {"incidence", {1.6}, "", "'incidence' is 1.6"},
      {"noise", {-0.01}, "", "'noise' is [-0.01 0]; expected [constant proportional]"},
      {"noise", {0, -1}, "", "'noise' is [0 -1]"},
      {"noise", {0, 1001}, "", "'noise' is [0 1001]"},
      {"noise", {}, "loud", "'noise' expects [constant proportional]"},
      {"rate", {0}, "", "'rate' is 0"},
      {"noise", {-1}, "", "'noise' is -1; expected 0 to 1000", "infrared"},
      {"range", {0.05, 0.01}, "", "'range' is [0.05 0.01] m", "infrared"},
  };
  for (const WrongSonar& wrong : corpus) {
    const world::Sensor sensor = with({cone_setting(wrong.key, wrong.numbers, wrong.text)}, wrong.type);
    const auto read = sensor.type == "sonar" ? read_sonar : read_infrared;
    const std::string error = refusal_of([&] { read(sensor, 0, 0); });
    expect_in(wrong.says, error);
    expect_in("made.world:42", error);
  }
}

TEST(SonarSettings, AcceptsTheLargestNoise) {
  const ConeArray s = read_sonar(with({cone_setting("noise", {1e4, 1e3})}), 0, 0);
  EXPECT_EQ(s.sigma, 1e4);
  EXPECT_EQ(s.proportional, 1e3);
}

TEST(SonarSettings, ArraysDivideTheTransducers) {
  const world::Sensor sensor = trial::cones("sonar", std::vector<Pose>(16), {cone_setting("arrays", {3})});
  expect_in("'arrays 3' does not divide the 16 transducers", refusal_of([&] { read_sonar(sensor, 0, 0); }));
}

// --- The predefined rings.

world::World shipped(const std::string& body) {
  const std::string file = testing::TempDir() + "/rangers.world";
  std::ofstream(file) << "include \"" SF_SOURCE_DIR "/worlds/robots.inc\"\n" << body;
  return world::load_world(file, {.sensors = world_file_words()});
}

TEST(SonarSettings, RingsOfThePioneer) {
  const world::World world = shipped("pioneer3at( name \"pioneer1\" pioneer_sonar( ) )\n");
  EXPECT_TRUE(world.warnings.empty());
  const auto arrays = cone_arrays_of(world, "sonar", read_sonar);
  ASSERT_EQ(arrays.size(), 1u);
  const ConeArray& ring = arrays[0];
  ASSERT_EQ(ring.X_SC.size(), 16u);
  EXPECT_NEAR(ring.row.X_MS.z, 0.24, 1e-12);
  EXPECT_EQ(ring.turns, 8u);
  // The robot is symmetric: front transducers k and 7 - k are mirror images, and the rear ones too.
  for (std::size_t k = 0; k < 8; ++k)
    for (const std::size_t first : {0u, 8u}) {
      const Pose& left = ring.X_SC[first + k];
      const Pose& right = ring.X_SC[first + 7 - k];
      EXPECT_EQ(left.x, right.x) << k;
      EXPECT_EQ(left.y, -right.y) << k;
      EXPECT_NEAR(std::remainder(left.yaw + right.yaw, 2.0 * M_PI), 0.0, 1e-12) << k;
    }
  // All transducers face outward.
  for (const Pose& p : ring.X_SC) EXPECT_GT(p.x * std::cos(p.yaw) + p.y * std::sin(p.yaw), 0.1);
  for (const world::Segment& side : world.movers[0].body) EXPECT_LT(side.z_max, 0.281) << "no body of its own";
}

TEST(SonarSettings, RingOfTheKhepera) {
  const world::World world = shipped("khepera2( name \"khepera1\" khepera_infrared( ) )\n");
  EXPECT_TRUE(world.warnings.empty());
  const auto arrays = cone_arrays_of(world, "infrared", read_infrared);
  ASSERT_EQ(arrays.size(), 1u);
  ASSERT_EQ(arrays[0].X_SC.size(), 8u);
  EXPECT_NEAR(arrays[0].row.X_MS.z, 0.02, 1e-12);
  EXPECT_EQ(arrays[0].proportional, 0.01);
  for (const Pose& p : arrays[0].X_SC) {
    EXPECT_LT(std::hypot(p.x, p.y), 0.035) << "within its body";
    EXPECT_GT(p.x * std::cos(p.yaw) + p.y * std::sin(p.yaw), 0.02);
  }
  for (const world::Segment& side : world.movers[0].body) EXPECT_LT(side.z_max, 0.031) << "no body of its own";
}

// --- Payloads.

TEST(SonarPackets, RejectsImpossibleNumbers) {
  SensorSpec row;
  row.elements = 1;
  base::ReadingBlock block;
  base::Bytes bytes;
  const std::vector<double> negative{-0.5};
  block.values = negative;
  sonar_type.encode(row, block, WireFormat::farm, 0, bytes);
  EXPECT_EQ(sonar_type.decode(row, bytes, kSonar, WireFormat::farm).fault, PayloadError::out_of_range);
  bytes.clear();
  const std::vector<double> beyond_ten_bits{0.01, 1030.0};
  block.values = beyond_ten_bits;
  infrared_type.encode(row, block, WireFormat::farm, 0, bytes);
  EXPECT_EQ(infrared_type.decode(row, bytes, kInfrared, WireFormat::farm).fault, PayloadError::out_of_range);
}

}  // namespace
}  // namespace sf::sensors
