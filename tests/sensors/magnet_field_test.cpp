// The field of a magnet, boundary case by boundary case, compared with physics.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/compare.h"
#include "tests/sensors/field_on_both.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::trial {
namespace {

using scenes::magnet;
using scenes::magnitude;
using sensors::FieldPoint;
using sensors::FieldSum;

constexpr double kGauss = 1e-4;
/// Moments have 32 bits on the device.
constexpr double kMoment = 1.0 / (1 << 24);

world::World one(const world::Magnet& m) {
  world::World world;
  world.magnets.push_back(m);
  return world;
}

TEST(MagnetField, AboveAndBelowItIsTwiceTheStrengthOverTheCube) {
  for (const double z : {0.5, -0.5}) {
    const FieldSum b = field_at(one(magnet({3, 4})), {3, 4, z});
    EXPECT_NEAR(b.z, 2e-7 / 0.125, 2e-7 / 0.125 * kMoment);
    EXPECT_EQ(b.x, 0.0);
    EXPECT_EQ(b.y, 0.0);
  }
}

TEST(MagnetField, AtTheSideItPointsDownWithTheStrengthOverTheCube) {
  const FieldSum b = field_at(one(magnet({0, 0})), {0.3, -0.4, 0.0});
  EXPECT_NEAR(b.z, -1e-7 / 0.125, 1e-7 / 0.125 * kMoment);
  EXPECT_NEAR(b.x, 0.0, 1e-7 / 0.125 * 1e-15) << "within the term that avoids a division by zero";
}

TEST(MagnetField, AtTheCentreItIsTheFieldAboveAtTheRadius) {
  const double most = 2e-7 / std::pow(0.0125, 3);
  const FieldSum b = field_at(one(magnet({7, -2}, 0.04)), {7, -2, 0.04});
  EXPECT_NEAR(b.z, most, most * 4 * kMoment);
  EXPECT_NEAR(b.magnitudes, most, most * 4 * kMoment);
  EXPECT_EQ(std::hypot(b.x, b.y), 0.0);
}

/// At the limits of doubles, no root overflows or underflows.
TEST(MagnetField, IsFiniteNextToTheCentre) {
  for (const double d : {1e-300, 1e-160, 1e-40, 1e-30, 1e-20, 1e-18, 1e-17, 1e-9}) {
    for (const FieldPoint& point :
         {FieldPoint{d, 0, 0}, FieldPoint{0, -d, 0}, FieldPoint{0, 0, d}, FieldPoint{0, 0, -d}, FieldPoint{d, d, -d}}) {
      const FieldSum b = field_at(one(magnet({0, 0})), point);
      const double most = 2e-7 / std::pow(0.0125, 3);
      ASSERT_TRUE(std::isfinite(b.x + b.y + b.z + b.magnitudes)) << d;
      EXPECT_LE(magnitude(b), most * 1.000001) << d;
      EXPECT_GE(magnitude(b), 0.0) << d;
    }
  }
}

/// The field is continuous across the radius, in any direction.
TEST(MagnetField, IsContinuousAtTheRadiusAndConstantInside) {
  Chance chance(1);
  for (int i = 0; i < 40; ++i) {
    const double a = chance.between(-M_PI, M_PI), b = chance.between(-1.5, 1.5);
    const auto at = [&](double r) {
      return field_at(one(magnet({0, 0})),
                      {r * std::cos(b) * std::cos(a), r * std::cos(b) * std::sin(a), r * std::sin(b)});
    };
    const FieldSum outside = at(0.0125 * (1 + 1e-9));
    for (const double r : {0.0125, 0.0125 * (1 - 1e-9), 0.006, 1e-4}) {
      const FieldSum inside = at(r);
      EXPECT_NEAR(inside.x, outside.x, 1e-6 * magnitude(outside)) << r;
      EXPECT_NEAR(inside.y, outside.y, 1e-6 * magnitude(outside)) << r;
      EXPECT_NEAR(inside.z, outside.z, 1e-6 * magnitude(outside)) << r;
    }
  }
}

TEST(MagnetField, OppositePairsCancelExactly) {
  world::World world = one(magnet({0.5, 0.25}, 0.1, 2.5));
  world.magnets.push_back(magnet({0.5, 0.25}, 0.1, -2.5));
  const FieldSum b = field_at(world, {0.55, 0.2, 0.3});
  EXPECT_EQ(b.x, 0.0);
  EXPECT_EQ(b.y, 0.0);
  EXPECT_EQ(b.z, 0.0);
  EXPECT_GT(b.magnitudes, 0.0) << "their magnitudes do not";
}

TEST(MagnetField, ALineEvery71MillimetresIs181AboveAnd074AtFifteenCentimetres) {
  const world::World world = scenes::line(201, 0.071);
  EXPECT_NEAR(magnitude(field_at(world, {0, 0, 0.125})) / kGauss, 1.81, 0.005);
  EXPECT_NEAR(magnitude(field_at(world, {0, 0.15, 0.125})) / kGauss, 0.74, 0.005);
}

TEST(MagnetField, IsZeroWithoutMagnets) {
  const FieldSum b = field_at({}, {1, 2, 3});
  EXPECT_EQ(magnitude(b) + b.magnitudes, 0.0);
}

/// Moments of 1e-12 to 1e12 A m^2 at 1e-6 to 1e6 m: sixty orders of magnitude of field.
TEST(MagnetField, NeitherOverflowsNorUnderflows) {
  for (const double moment : {1e-12, 1e-3, 1.0, 1e6, 1e12})
    for (const double r : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
      const world::World world = one(magnet({0, 0}, 0, moment, 1e-9));
      const FieldPoint point{0.6 * r, 0, 0.8 * r};
      const scenes::Exact truth = scenes::exact(world, point);
      EXPECT_LE(scenes::apart(truth, field_at(world, point)), 1e-7 * magnitude(truth))
          << moment << " A m^2, " << r << " m";
    }
}

TEST(MagnetField, IsZeroAtHugeDistances) {
  for (const double r : {1e12, 1e19, 1e30, 1e150}) {
    const FieldSum b = field_at(one(magnet({0, 0})), {r, 0, 0});
    EXPECT_LE(magnitude(b), 1e-40) << r;
  }
}

}  // namespace
}  // namespace sf::trial
