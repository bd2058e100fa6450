#include "world/ros_map.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace sf::world {
namespace {

class RosMap : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    write("m.pgm", "P2 3 2 255\n0 128 255\n255 255 255\n");  // wall, unknown, free; a free row below
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  World load(const std::string& yaml, const LoadOptions& options = {}) const {
    write("m.yaml", yaml);
    return load_world((folder_ / "m.yaml").string(), options);
  }
  std::string error(const std::string& yaml) const {
    try {
      load(yaml);
    } catch (const base::InputError& caught) {
      const std::string what = caught.what();
      return what.substr(what.find("m.yaml"));
    }
    return {};
  }
  static double area(const World& world) {
    double sum = 0.0;
    for (const Segment& wall : world.walls) sum += cross(wall.a, wall.b) / 2;
    return sum;
  }
  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("ros_map_" + std::to_string(::getpid()));
};

const std::string kGood =
    "image: m.pgm\nresolution: 0.5\norigin: [10, 20, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

TEST_F(RosMap, TheOriginIsTheLowerLeftCornerAndTheFirstRowIsTheTop) {
  const World world = load(kGood);
  ASSERT_EQ(world.walls.size(), 4u);
  EXPECT_DOUBLE_EQ(world.extent.x_min, 10.0);
  EXPECT_DOUBLE_EQ(world.extent.x_max, 10.5);
  EXPECT_DOUBLE_EQ(world.extent.y_min, 20.5);
  EXPECT_DOUBLE_EQ(world.extent.y_max, 21.0);
  EXPECT_NEAR(area(world), 0.25, 1e-12);
  EXPECT_EQ(world.walls[0].z_min, 0.0);
  EXPECT_EQ(world.walls[0].z_max, kMapWallHeight);
  EXPECT_TRUE(world.models.at(0).is_bitmap);
}

TEST_F(RosMap, TakesTheOrderedAccuracy) {
  LoadOptions options;
  options.accuracy = "skip2";
  EXPECT_EQ(load(kGood, options).accuracy.word, "skip2");
  EXPECT_EQ(load(kGood).accuracy.word, "");
}

TEST_F(RosMap, UnknownIsAWallOnlyWhenAskedFor) {
  LoadOptions options;
  options.unknown_is_wall = true;
  EXPECT_NEAR(area(load(kGood, options)), 0.5, 1e-12);
}

TEST_F(RosMap, NegatedMapsAreBrightWhereTheyAreOccupied) {
  std::string yaml = kGood;
  yaml.replace(yaml.find("negate: 0"), 9, "negate: 1");
  EXPECT_NEAR(area(load(yaml)), 0.25 * 4, 1e-12);
}

TEST_F(RosMap, TheYawTurnsAboutTheOrigin) {
  std::string yaml = kGood;
  yaml.replace(yaml.find("20, 0]"), 6, "20, 1.5707963267948966]");
  const World world = load(yaml);
  EXPECT_NEAR(world.extent.x_min, 9.0, 1e-12);
  EXPECT_NEAR(world.extent.x_max, 9.5, 1e-12);
  EXPECT_NEAR(world.extent.y_min, 20.0, 1e-12);
}

TEST_F(RosMap, ThresholdsAreStrict) {
  write("m.pgm", "P2 2 1 255\n51 50\n");  // occupied by 0.8, which is not above 0.8, and by a little more
  std::string yaml = kGood;
  yaml.replace(yaml.find("0.65"), 4, "0.8");
  EXPECT_NEAR(area(load(yaml)), 0.25, 1e-12);
}

TEST_F(RosMap, ScaleIsReadAsTrinaryWithAWarning) {
  const World world = load(kGood + "mode: scale\n");
  ASSERT_EQ(world.warnings.size(), 1u);
  EXPECT_EQ(world.warnings[0].line, 7);
  EXPECT_EQ(load(kGood + "mode: trinary\n").warnings.size(), 0u);
}

TEST_F(RosMap, DefaultsAreMapServers) {
  EXPECT_EQ(load("image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n").walls.size(), 4u);
}

TEST_F(RosMap, BadMapsAreRefusedWithTheirLine) {
  const auto without = [](const std::string& key, const std::string& instead) {
    std::string yaml = kGood;
    const auto at = yaml.find(key);
    yaml.replace(at, yaml.find('\n', at) - at, instead);
    return yaml;
  };
  EXPECT_EQ(error(without("image", "image: none.pgm")).substr(0, 9), "m.yaml:1:");
  EXPECT_NE(error(without("image", "picture: m.pgm")).find("'image' is missing"), std::string::npos);
  EXPECT_EQ(error(without("resolution", "resolution: 0")).substr(0, 9), "m.yaml:2:");
  EXPECT_EQ(error(without("resolution", "resolution: fine")).substr(0, 9), "m.yaml:2:");
  EXPECT_EQ(error(without("resolution", "resolution: .nan")).substr(0, 9), "m.yaml:2:");
  EXPECT_EQ(error(without("origin", "origin: [1, 2]")).substr(0, 9), "m.yaml:3:");
  EXPECT_EQ(error(without("origin", "origin: [1, 2, x]")).substr(0, 9), "m.yaml:3:");
  EXPECT_EQ(error(without("origin", "origin: [1e300, 2, 0]")).substr(0, 9), "m.yaml:3:");
  EXPECT_EQ(error(without("negate", "negate: maybe")).substr(0, 9), "m.yaml:4:");
  EXPECT_EQ(error(without("occupied", "occupied_thresh: 2")).substr(0, 9), "m.yaml:5:");
  EXPECT_EQ(error(without("free", "free_thresh: 0.9")).substr(0, 9), "m.yaml:6:");
  EXPECT_EQ(error(kGood + "mode: raw\n").substr(0, 9), "m.yaml:7:");
  EXPECT_NE(error("a: [1").find("not YAML"), std::string::npos);
  EXPECT_NE(error("- 1\n- 2\n").find("expected the YAML of a ROS map"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
