// The worlds that come with the program load without a word, and hold what they promise.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/world/read_world.h"

namespace sf::world {
namespace {

/// As programs ask for it; sensors that are not read here are kept as they are written.
World shipped(const std::string& name) {
  static constexpr std::string_view kAny[] = {"fov",     "samples",      "range_max", "range_min",    "scount",
                                              "spose[]", "ssensitivity", "sum",       "perpendicular"};
  static constexpr SensorWord kWords[] = {{"laneedge", kAny}, {"magnetometer", kAny}};
  LoadOptions options;
  options.sensors = kWords;
  return load_world(SF_SOURCE_DIR "/worlds/" + name, options);
}

TEST(Shipped, EveryWorldLoadsWithoutAWarning) {
  int worlds = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SF_SOURCE_DIR "/worlds")) {
    if (entry.path().extension() != ".world") continue;
    const std::string name = std::filesystem::relative(entry.path(), SF_SOURCE_DIR "/worlds").string();
    EXPECT_EQ(warnings_of(shipped(name)), "") << name;
    ++worlds;
  }
  EXPECT_GE(worlds, 6);
}

TEST(Shipped, TheTestPathIsTheThesis) {
  const World world = shipped("testpath/testpath.world");
  double straight = 0.0;
  for (const Stripe& stripe : world.stripes)
    if (stripe.line.size() == 2) straight += length(stripe.line[1] - stripe.line[0]);
  EXPECT_NEAR(straight, 2 * (2.72 + 1.349), 1e-12);
  EXPECT_EQ(world.magnets.size(), 78u);
  ASSERT_EQ(world.movers.size(), 1u);
  EXPECT_EQ(world.movers[0].sensors.size(), 2u);
}

TEST(Shipped, TheMappingAreaIsThreeMetresWide) {
  const World world = shipped("mapping/mapping.world");
  EXPECT_NEAR(world.extent.x_max - world.extent.x_min, 3.08, 1e-12) << "walls of 4 cm around";
  EXPECT_NEAR(world.extent.y_max - world.extent.y_min, 3.08, 1e-12);
}

TEST(Shipped, SimVilleHasABridgeAndMagnets) {
  const World world = shipped("simville/simville.world");
  EXPECT_GT(world.magnets.size(), 300u);
  bool bridge = false;
  for (const Segment& wall : world.walls)
    bridge = bridge || (world.models[wall.model].name == "bridge" && wall.z_min > 0.3);
  EXPECT_TRUE(bridge);
  EXPECT_GE(world.movers.size(), 5u);
}

}  // namespace
}  // namespace sf::world
