// Worlds of other simulators and other files that are not worlds: the error names them and says how to use them.

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
  expect_said("<mujocoinclude>\n</mujocoinclude>", "MuJoCo");
  expect_said("<!DOCTYPE sdf [<!ENTITY a \"b>c]\"> <!ENTITY d '>'>]>\n<sdf version='1.6'/>", "Gazebo");
  expect_said("<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"http://w\">\n<svg/>", "SVG");
  expect_said("<robot name=\"r\">", "URDF");
  expect_said("<launch>", "a launch file");
  expect_said("<osm version=\"0.6\">", "OpenStreetMap");
  expect_said("<svg>", "SVG");
  expect_said("<COLLADA xmlns=\"x\">", "COLLADA");
  expect_said("<OpenDRIVE>", "OpenDRIVE");
  expect_said("<sdformat>", "the root <sdformat>, which belongs to no known simulator");
}

TEST(ForeignWorlds, AreNamedByTheirFirstBytes) {
  expect_said("#VRML_SIM R2023b utf8\nWorldInfo {\n}\n", "test.world:1: is a file of Webots");
  expect_said("#VRML V2.0 utf8\n", "a file of VRML");
  expect_said("#usda 1.0\n(\n)\n", "Universal Scene Description");
  expect_said("PXR-USDC\n", "Universal Scene Description");
  expect_said("\n\r\n#VRML_SIM R2023b utf8\n", "a file of Webots");
  expect_said("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n", "point clouds (PCD)");
  expect_said("ply\nformat ascii 1.0\n", "a file of PLY");
}

TEST(ForeignWorlds, AreNamedByTheirContent) {
  expect_said("solid cube\nfacet normal 0 0 0\n", "a file of STL");
  expect_said(std::string(80, 'x') + std::string("\1\0\0\0", 4) + std::string(50, '\0'), "a file of STL");
  expect_said("# Blender\n\nmtllib a.mtl\no Cube\nv 1.0 1.0 -1.0\nf 1 2 3\n", "Wavefront OBJ");
  expect_said("v 0 0 0\nv 1 0 0\n", "Wavefront OBJ");
  expect_said("%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n--- !u!29 &1\n", "a file of Unity");
  expect_said("---\nimage: a.pgm\n", "is YAML; expected a Stage world, or a ROS map in a file that ends in .yaml");
  expect_said("{\"asset\": {\"version\": \"2.0\"}, \"meshes\": []}", "a file of glTF");
  expect_said("{\"world\": {}}", "is JSON of no known program");
}

TEST(ForeignWorlds, AreNamedInUtf16) {
  const auto wide = [](const std::string& text, bool little) {
    std::string bytes;
    for (const char c : text) bytes += little ? std::string{c, '\0'} : std::string{'\0', c};
    return bytes;
  };
  for (const std::string mark : {"", "\xFF\xFE"}) {
    expect_said(mark + wide("<?xml version='1.0'?><sdf/>", true), "Gazebo");
    expect_said(mark.empty() ? wide("<sdf/>", false) : "\xFE\xFF" + wide("<sdf/>", false), "Gazebo");
  }
  expect_said("\xFF\xFE" + wide("model( )", true), "is UTF-16 text: save it as UTF-8");
}

TEST(ForeignWorlds, ErrorsOnPicturesAndOutlinesSayWhereTheyBelong) {
  expect_said("\x89PNG\r\n\x1a\n", "is a picture; expected a world: include it with model( bitmap");
  expect_said("P5\n2 2\n255\nabcd", "is a picture");
  expect_said("POLYGON ((0 0, 1 0, 1 1))", "with model( outlines");
  expect_said("WKT,height\n\"POINT (0 0)\",1\n", "with model( outlines");
  expect_said("{ \"type\": \"FeatureCollection\" }", "with model( outlines");
  expect_said("{ \"type\": \"Point\", \"coordinates\": [0, 0] }", "with model( outlines");
}

TEST(ForeignWorlds, PlayerConfigurationNamesItsWorld) {
  const std::string driver = "driver\n(\n  name \"stage\"\n  provides [\"simulation:0\"]\n  plugin \"stageplugin\"\n";
  expect_said(driver + "  worldfile \"simple.world\"\n)\n",
              "test.world:1: 'driver' belongs to a configuration file of "
              "Player; expected a world: load \"simple.world\"");
  expect_said(driver + ")\n", "the world that its `worldfile` names");
}

/// Comments and words that only look like those of other programs.
TEST(ForeignWorlds, StageWorldsAreNotForeign) {
  EXPECT_EQ(error_of("# <sdf>\nmodel( name \"sdf\" )"), "");
  EXPECT_EQ(error_of("# VRML_SIM\nmodel( )"), "");
  EXPECT_EQ(error_of("P5( )"), "");
  EXPECT_EQ(error_of("solid( )"), "");
  EXPECT_EQ(error_of("v 0\no( )"), "");
  EXPECT_EQ(error_of("driver( )"), "") << "an unknown type, with a warning";
  EXPECT_NE(error_of("model( ) <sdf>").find("unexpected '<'"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
