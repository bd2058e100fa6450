// Worlds of other simulators and other files that are no worlds: named, with a way to use them.

#include <gtest/gtest.h>

#include "tests/world/read_world.h"

namespace sf::world {
namespace {

void expect_said(const std::string& text, const std::string& what) {
  const std::string error = error_of(text);
  EXPECT_NE(error.find(what), std::string::npos) << text << ": " << error;
}

TEST(ForeignWorlds, AreNamedByTheirRootElement) {
  const std::string xml = "<?xml version=\"1.0\" ?>\n<!-- a > b -->\n<!DOCTYPE x>\n";
  expect_said(xml + "<sdf version=\"1.6\">\n</sdf>",
              "test.world: is a file of Gazebo (SDFormat); expected a Stage world");
  expect_said("\xEF\xBB\xBF<sdf version='1.9'><world/></sdf>", "libgazebo_2Dmap_plugin.so");
  expect_said("<mvsim_world version=\"1.0\">", "MVSim");
  expect_said("\n  <argos-configuration>", "ARGoS");
  expect_said("<mujoco model=\"a\">", "MuJoCo");
  expect_said("<mujoco/>", "MuJoCo");
  expect_said("<robot name=\"r\">", "URDF");
  expect_said("<launch>", "a launch file");
  expect_said("<osm version=\"0.6\">", "OpenStreetMap");
  expect_said("<svg>", "SVG");
  expect_said("<COLLADA xmlns=\"x\">", "COLLADA");
  expect_said("<OpenDRIVE>", "OpenDRIVE");
  expect_said("<sdformat>", "the root <sdformat>, of no known simulator");
}

TEST(ForeignWorlds, AreNamedByTheirFirstBytes) {
  expect_said("#VRML_SIM R2023b utf8\nWorldInfo {\n}\n", "test.world:1: is a file of Webots");
  expect_said("#VRML V2.0 utf8\n", "a file of VRML");
  expect_said("#usda 1.0\n(\n)\n", "Universal Scene Description");
  expect_said("PXR-USDC\n", "Universal Scene Description");
}

TEST(ForeignWorlds, PicturesAndOutlinesSayWhereTheyBelong) {
  expect_said("\x89PNG\r\n\x1a\n", "is a picture; expected a world: name it by model( bitmap");
  expect_said("P5\n2 2\n255\nabcd", "is a picture");
  expect_said("POLYGON ((0 0, 1 0, 1 1))", "by model( outlines");
  expect_said("WKT,height\n\"POINT (0 0)\",1\n", "by model( outlines");
  expect_said("{ \"type\": \"FeatureCollection\" }", "by model( outlines");
}

TEST(ForeignWorlds, PlayersConfigurationNamesItsWorld) {
  const std::string driver = "driver\n(\n  name \"stage\"\n  provides [\"simulation:0\"]\n  plugin \"stageplugin\"\n";
  expect_said(driver + "  worldfile \"simple.world\"\n)\n",
              "test.world:1: 'driver' belongs to a configuration file of "
              "Player; expected a world: load \"simple.world\"");
  expect_said(driver + ")\n", "the world that its `worldfile` names");
}

/// Comments and words that only look like those of others.
TEST(ForeignWorlds, OurOwnWorldsAreNone) {
  EXPECT_EQ(error_of("# <sdf>\nmodel( name \"sdf\" )"), "");
  EXPECT_EQ(error_of("# VRML_SIM\nmodel( )"), "");
  EXPECT_EQ(error_of("P5( )"), "");
  EXPECT_EQ(error_of("driver( )"), "") << "an unknown type, with a warning";
  EXPECT_NE(error_of("model( ) <sdf>").find("unexpected '<'"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
