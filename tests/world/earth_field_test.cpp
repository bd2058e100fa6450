// The Earth's magnetic field: as a vector, by a place, and by a road network's place.

#include "world/stage/earth_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/read_world.h"

namespace sf::world {
namespace {

TEST(EarthField, IsReadInGauss) {
  const World world = read_world("earth_field [0.2 -0.01 -0.45] model( )");
  EXPECT_EQ(warnings_of(world), "");
  EXPECT_DOUBLE_EQ(world.earth_field.x, 2e-5);
  EXPECT_DOUBLE_EQ(world.earth_field.y, -1e-6);
  EXPECT_DOUBLE_EQ(world.earth_field.z, -4.5e-5);
  EXPECT_EQ(read_world("model( )").earth_field, glm::dvec3{}) << "off unless requested";
}

/// Values of the formula computed apart, and its limits at poles and equator.
TEST(EarthField, DipoleAtKnownPlaces) {
  const glm::dvec3 columbus = dipole_field(40.0, -83.0);
  EXPECT_NEAR(columbus.x, 873.1e-9, 0.1e-9);
  EXPECT_NEAR(columbus.y, 19443.4e-9, 0.1e-9);
  EXPECT_NEAR(columbus.z, -45147.9e-9, 0.1e-9);
  EXPECT_NEAR(dipole_field(90.0, 0.0).z, -2 * 29404.8e-9, 1e-12) << "down at the north pole";
  EXPECT_NEAR(dipole_field(-90.0, 0.0).z, 2 * 29404.8e-9, 1e-12) << "up at the south pole";
  EXPECT_NEAR(dipole_field(0.0, 0.0).y, 29404.8e-9, 1e-12) << "north at the equator";
  for (const double latitude : {-60.0, 0.0, 35.0})
    EXPECT_NEAR(glm::length(dipole_field(latitude, -180.0) - dipole_field(latitude, 180.0)), 0.0, 1e-18);
}

/// The field is -grad V: differences of the potential between neighbouring places.
TEST(EarthField, DipoleIsTheGradientOfItsPotential) {
  const double g10 = -29404.8e-9, g11 = -1450.9e-9, h11 = 4652.5e-9, step = 1e-5;
  const auto potential = [&](double r, double t, double p) {
    return (g10 * std::cos(t) + (g11 * std::cos(p) + h11 * std::sin(p)) * std::sin(t)) / (r * r);
  };
  for (const double latitude : {-71.0, -20.0, 3.0, 40.0})
    for (const double longitude : {-150.0, -83.0, 0.0, 77.0}) {
      const double t = (90.0 - latitude) * M_PI / 180.0, p = longitude * M_PI / 180.0;
      const auto slope = [&](double dr, double dt, double dp) {
        return (potential(1 + dr, t + dt, p + dp) - potential(1 - dr, t - dt, p - dp)) / (2 * step);
      };
      const glm::dvec3 b = dipole_field(latitude, longitude);
      EXPECT_NEAR(b.x, -slope(0, 0, step) / std::sin(t), 1e-14);
      EXPECT_NEAR(b.y, slope(0, step, 0), 1e-14);
      EXPECT_NEAR(b.z, -slope(step, 0, 0), 1e-13);
    }
}

TEST(EarthField, LocationTurnsWithTheHeading) {
  const glm::dvec3 b = dipole_field(40.0, -83.0);
  const glm::dvec3 plain = read_world("earth_location [40 -83] model( )").earth_field;
  EXPECT_EQ(plain, b) << "x is east";
  const glm::dvec3 turned = read_world("unit_angle \"radians\" earth_location [40 -83 90] model( )").earth_field;
  EXPECT_NEAR(turned.x, -b.y, 1e-18) << "east is along y; degrees in any file";
  EXPECT_NEAR(turned.y, b.x, 1e-18);
  EXPECT_EQ(turned.z, b.z);
}

TEST(EarthField, RoadGivesTheLocation) {
  const std::string road = "road( rndf \"" SF_SOURCE_DIR "/worlds/simville/simville.rndf\" )\n";
  const World world = read_world(road + "earth_location \"road\"");
  EXPECT_GT(glm::length(world.earth_field), 2e-5);
  EXPECT_LT(glm::length(world.earth_field), 7e-5);
  EXPECT_EQ(error_of("model( )\nearth_location \"road\"").find("test.world:2: 'earth_location' is \"road\", but the "),
            0u);
}

TEST(EarthField, InvalidOnesAreRejected) {
  const struct {
    const char* name;
    const char* text;
    const char* says;
  } rows[] = {
      {"two numbers", "earth_field [0 1]", "[x y z] in Gauss"},
      {"one number", "earth_field 0.5", "[x y z] in Gauss"},
      {"beyond all", "earth_field [0 0 2e6]", "expected at most 1e+06"},
      {"latitude", "earth_location [91 0]", "a latitude from -90 to 90"},
      {"longitude", "earth_location [0 181]", "a longitude from -180 to 180"},
      {"heading", "earth_location [0 0 361]", "a heading from -360 to 360"},
      {"one coordinate", "earth_location [40]", "[latitude longitude heading]"},
      {"another word", "earth_location \"Ohio\"", "or \"road\""},
      {"both", "earth_location [0 0] earth_field [0 0 1]", "expected one of them"},
  };
  for (const auto& [name, text, says] : rows) {
    const std::string error = error_of(std::string("model( )\n") + text);
    EXPECT_EQ(error.find("test.world:2: "), 0u) << name << ": " << error;
    EXPECT_NE(error.find(says), std::string::npos) << name << ": " << error;
  }
  EXPECT_NE(warnings_of(read_world("earth_field [20 0 -45] model( )")).find("write 0.45 if it is in microtesla"),
            std::string::npos);
}

}  // namespace
}  // namespace sf::world
