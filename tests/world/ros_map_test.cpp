#include "world/ros_map.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "tests/robots/scenes.h"
#include "world/free_space.h"
#include "world/wall_tree.h"

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
    for (const Segment& wall : world.walls) sum += base::cross(wall.a, wall.b) / 2;
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

/// Grey 205 is (255 - 205) / 255 = 0.19608 occupied: just above map_server's threshold of 0.196; 206 is below.
TEST_F(RosMap, Grey205IsUnknownAnd206IsFree) {
  const std::string yaml = "image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n";
  const auto known = [&](const std::string& greys, const std::string& more = "") {
    write("m.pgm", "P2 2 1 255\n" + greys + "\n");
    double sum = 0.0;
    for (const Segment& edge : known_free(load(yaml + more))) sum += base::cross(edge.a, edge.b) / 2;
    return sum;
  };
  EXPECT_NEAR(known("205 206"), 0.25, 1e-12);
  EXPECT_NEAR(known("254 206"), 0.5, 1e-12);
  EXPECT_NEAR(known("205 0"), 0.0, 1e-12) << "neither unknown nor a wall is known to be free";
  EXPECT_NEAR(known("205 254", "free_thresh: 0.25\n"), 0.5, 1e-12) << "as the file says";
}

/// The layout of Nav2's sandbox: an arena of 5 m with a pillar at the map's origin, in an unexplored area of 20 m.
void write_sandbox(const std::filesystem::path& folder) {
  std::string pixels(400 * 400, static_cast<char>(205));
  for (int row = 0; row < 400; ++row)
    for (int column = 0; column < 400; ++column) {
      const int x = column - 200, y = row - 200;  // of 5 cm
      if (std::max(std::abs(x), std::abs(y)) > 50) continue;
      const bool wall = std::max(std::abs(x), std::abs(y)) >= 49 || x * x + y * y < 16;
      pixels[static_cast<std::size_t>(row * 400 + column)] = static_cast<char>(wall ? 0 : 254);
    }
  std::ofstream(folder / "m.pgm", std::ios::binary) << "P5 400 400 255\n" << pixels;
}
constexpr const char* kSandbox =
    "image: m.pgm\nresolution: 0.05\norigin: [-10, -10, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: ";

TEST_F(RosMap, CopiesStartInsideTheArenaAmidTheUnknown) {
  write_sandbox(folder_);
  for (const char* threshold : {"0.196", "0.25"})  // with the latter the unexplored area counts as free
    for (const Pose& start : {Pose{}, Pose{-7.0, 3.0, 0.0, 0.0}, Pose{1.0, 1.0, 0.0, 0.0}}) {
      if (threshold[3] == '5' && start.x < -5.0) continue;  // it stands in an area that the file declares free
      World world = load(std::string(kSandbox) + threshold + "\n");
      scenes::add_create(world, start);
      update_extent_and_hash(world);
      clone_robots(world, 8, 1);
      ASSERT_EQ(world.movers.size(), 8u);
      for (const Mover& mover : world.movers) {
        EXPECT_LT(std::max(std::abs(mover.X_WM.x), std::abs(mover.X_WM.y)), 2.5) << start.x;
        EXPECT_EQ(PlaceCheck(world).problem(mover, mover.X_WM), "");
      }
    }
}

TEST_F(RosMap, PosesThatNobodyCanHaveAreNamed) {
  write_sandbox(folder_);
  World world = load(std::string(kSandbox) + "0.196\n");
  scenes::add_create(world, {});
  update_extent_and_hash(world);
  const auto where = [&](double x, double y) { return PlaceCheck(world).problem(world.movers[0], {x, y, 0.0, 0.3}); };
  EXPECT_EQ(where(1, 1), "");
  EXPECT_EQ(where(0, 0), "within a wall");
  EXPECT_EQ(where(2.35, 1), "partly in a wall of 'map'");
  EXPECT_EQ(where(-6, 1), "where the map knows nothing");
  EXPECT_EQ(where(-10.1, 1), "outside of 'map'");
}

TEST_F(RosMap, TheKnownAreaTurnsWithTheMap) {
  std::string yaml = kGood;
  yaml.replace(yaml.find("20, 0]"), 6, "20, 1.5707963267948966]");
  const std::vector<Segment> known = known_free(load(yaml));
  EXPECT_NE(winding_number(known, {9.25, 21.25}), 0) << "the pixel beside the unknown one";
  EXPECT_EQ(winding_number(known, {9.25, 20.75}), 0) << "the unknown one";
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
  write("m.pgm", "P2 2 1 255\n51 50\n");  // 0.8 occupied, which is not above 0.8, and slightly more
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
  for (const char* origin : {"[.nan, 2, 0]", "[1, .nan, 0]", "[1, 2, .nan]", "[-.inf, 2, 0]", "[1, 2, .inf]"})
    EXPECT_EQ(error(without("origin", std::string("origin: ") + origin)).substr(0, 9), "m.yaml:3:") << origin;
  EXPECT_EQ(error(without("negate", "negate: maybe")).substr(0, 9), "m.yaml:4:");
  EXPECT_EQ(error(without("occupied", "occupied_thresh: 2")).substr(0, 9), "m.yaml:5:");
  EXPECT_EQ(error(without("occupied", "occupied_thresh: .nan")).substr(0, 9), "m.yaml:5:");
  EXPECT_EQ(error(without("free", "free_thresh: 0.9")).substr(0, 9), "m.yaml:6:");
  EXPECT_EQ(error(without("free", "free_thresh: -0.1")).substr(0, 9), "m.yaml:6:");
  EXPECT_EQ(error(kGood + "mode: raw\n").substr(0, 9), "m.yaml:7:");
  EXPECT_NE(error("a: [1").find("not YAML"), std::string::npos);
  EXPECT_NE(error("- 1\n- 2\n").find("expected the YAML of a ROS map"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
