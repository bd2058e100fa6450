// Cameras: depth, labels and normals of each pixel, against known planes and against every face in `long double`.

#include "sensors/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "raycast/casters.h"
#include "scene/rasterizer.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

/// A robot with a camera 0.75 m above the floor, a board 4 m ahead and a wall 9 m ahead.
world::World boards(const std::string& camera) {
  return world_of(
      "define robot position( size [0.4 0.4 0.5] origin [0 0 0 0] )\n"
      "model( name \"board\" pose [4.05 0 0 0] size [0.1 1 3] )\n"
      "model( name \"wall\" pose [9.1 0 0 0] size [0.2 40 8] )\n"
      "robot( name \"r1\" pose [0 0 0 0] camera( pose [0 0 0.25 0] size [0 0 0] " +
      camera + " ) )\n");
}

struct Image {
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  std::vector<base::QualityFlag> quality;
  double bound;
  std::size_t width;
};

Image shoot(const world::World& world, const base::Pose& X_WM = {}, const base::Tilt& tilt = {},
            const char* caster = "auto") {
  farm::FarmOptions options{.noise = false, .threads = 2};
  options.scene.caster = raycast::caster_named(caster);
  farm::Farm farm(world, host_device(), options);
  const base::ReadingBlock r = farm.sense(0, sensors::kCamera, 0, X_WM, tilt);
  Image image{{r.values.begin(), r.values.end()},
              {r.hits.begin(), r.hits.end()},
              {r.quality.begin(), r.quality.end()},
              r.bound,
              r.values.size() / r.hits.size()};
  image.quality.resize(image.hits.size());
  return image;
}

/// Depth is measured along the optical axis: all pixels that see the board read 4 m, all that see the wall 9 m.
TEST(Camera, DepthOfFacingPlanes) {
  const world::World world = boards("resolution [64 48] fov 60 range [0 50]");
  const Image image = shoot(world);
  ASSERT_EQ(image.values.size(), 64u * 48u);
  const std::uint32_t board = 0, wall = 1;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const double depth = image.hits[i] == board ? 4.0 : image.hits[i] == wall ? 9.0 : image.values[i];
    EXPECT_NEAR(image.values[i], depth, image.bound);
  }
  EXPECT_GT(std::ranges::count(image.hits, board), 300);
  EXPECT_GT(std::ranges::count(image.hits, wall), 500);
  EXPECT_EQ(image.hits[47 * 64 + 32], base::kFloorHit) << "rows begin at the top";
}

/// The focal length is half of the width over tan(fov / 2), and whole numbers are centres of pixels: the board's edges,
/// 0.5 m from the axis at 4 m, are at (w - 1) / 2 -+ f / 8.
TEST(Camera, PixelsOfAKnownEdge) {
  const Image image = shoot(boards("resolution [101 1] fov 60 range [0 50]"));
  const double f = 0.5 * 101 / std::tan(30 * M_PI / 180), first = 50 - f / 8, last = 50 + f / 8;
  for (int u = 0; u < 101; ++u) EXPECT_EQ(image.hits[static_cast<std::size_t>(u)] == 0, u >= first && u <= last) << u;
}

/// Every pixel of a tilted camera against the reference, with its normals.
TEST(Camera, AgreesWithEveryFace) {
  const world::World world = boards("resolution [60 40] fov 90 range [0 20] normals 1 pose6 [0.1 0 0.2 5 -10 30]");
  const base::Pose X{0.3, -0.2, 0.0, 0.5};
  const base::Tilt tilt{0.1, 0.15};
  const Image fast = shoot(world, X, tilt), slow = shoot(world, X, tilt, "reference");
  std::size_t compared = 0;
  for (std::size_t i = 0; i < fast.hits.size(); ++i) {
    if (fast.quality[i] != base::QualityFlag::none) continue;
    EXPECT_EQ(fast.hits[i], slow.hits[i]);
    EXPECT_NEAR(fast.values[4 * i], slow.values[4 * i], fast.bound);
    for (std::size_t axis = 1; axis < 4; ++axis)
      EXPECT_NEAR(fast.values[4 * i + axis], slow.values[4 * i + axis], 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 2'300u);
}

/// A wall that is faced has the normal (-1, 0, 0), toward the camera; the floor points up; nothing has 0.
TEST(Camera, NormalsPointToTheCamera) {
  const Image image = shoot(boards("resolution [16 16] fov 100 range [0 8] normals 1"));
  ASSERT_EQ(image.width, 4u);
  for (std::size_t i = 0; i < image.hits.size(); ++i) {
    const glm::dvec3 normal{image.values[4 * i + 1], image.values[4 * i + 2], image.values[4 * i + 3]};
    const glm::dvec3 expected = image.hits[i] == base::kFloorHit ? glm::dvec3{0, 0, 1}
                                : image.hits[i] == base::kNoHit  ? glm::dvec3{}
                                                                 : glm::dvec3{-1, 0, 0};
    EXPECT_NEAR(glm::distance(normal, expected), 0.0, 1e-6);
    EXPECT_EQ(image.values[4 * i] == 8.0, image.hits[i] == base::kNoHit);
  }
}

/// Limits are depths: a corner of an image sees as far as its middle, and too near surfaces read the least depth.
TEST(Camera, LimitsAreDepths) {
  const Image far = shoot(boards("resolution [40 40] fov 120 range [0 9.0001]"));
  EXPECT_GT(std::ranges::count(far.hits, 1u), 300) << "the wall's depth is 9 m up to the corners";
  const Image near = shoot(boards("resolution [40 40] fov 60 range [5 50]"));
  for (std::size_t i = 0; i < near.hits.size(); ++i) {
    EXPECT_GE(near.values[i], 5.0);
    EXPECT_EQ(near.values[i] == 5.0, near.quality[i] == base::QualityFlag::too_near);
  }
}

/// Stage's keys: two fields of view, of which the second follows, and `pantilt`, a positive tilt looking down.
TEST(Camera, ReadsStagesKeys) {
  const world::World world = world_of(
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] camera( pose [0 0 0.25 0] size [0 0 0] resolution [3 3] fov [70 "
      "40] "
      "range [0.2 8] pantilt [0 90] ) )");
  const Image image = shoot(world);
  EXPECT_NEAR(image.values[4], 0.75, 1e-9) << "straight down";
  EXPECT_EQ(image.hits[4], base::kFloorHit);
}

TEST(Camera, Packets) {
  const world::World world = boards("resolution [40 30] fov 60 range [0 50] normals 1");
  const Image image = shoot(world);
  const sensors::SensorSpec spec = sensors::SensorSet(world).of(sensors::kCamera, 0)[0];
  const sensors::SensorType& type = sensors::camera_type;
  const base::ReadingBlock block{.type = sensors::kCamera, .values = image.values};
  std::vector<double> received(image.values.size(), -1.0);
  ASSERT_EQ(type.parts(spec, sensors::WireFormat::farm), 4u);
  for (std::uint32_t part = 0; part < 4; ++part) {
    base::Bytes bytes;
    const std::uint8_t id = type.encode(spec, block, sensors::WireFormat::farm, part, bytes);
    EXPECT_EQ(id, sensors::kCamera + sensors::kExtended);
    ASSERT_EQ(type.decode(spec, bytes, id, sensors::WireFormat::farm).fault, sensors::PayloadError::none);
    type.read(spec, bytes, id, sensors::WireFormat::farm, received);
    EXPECT_NE(type.decode(spec, bytes, sensors::kCamera, sensors::WireFormat::farm).fault, sensors::PayloadError::none);
  }
  for (std::size_t i = 0; i < received.size(); i += 4) {
    EXPECT_NEAR(received[i], image.values[i], type.wire_error(spec, block));
    EXPECT_EQ(received[i + 1], -1.0) << "normals are not sent";
  }
}

TEST(Camera, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& camera) {
    return refusal_of([&] { const sensors::SensorSet set(world_of("position( \ncamera( " + camera + " ) )")); });
  };
  expect_in("trial.world:2: 0 x 5 pixels; expected whole numbers from 1 to 4096", refused("resolution [0 5]"));
  expect_in("1.5 x 5 pixels", refused("resolution [1.5 5]"));
  expect_in("16777216 pixels; expected at most 1000000", refused("resolution [4096 4096]"));
  expect_in("'resolution' expects [width height]", refused("resolution [5]"));
  expect_in("a field of view of 175 degrees", refused("fov 175"));
  expect_in("a field of view of 0 degrees", refused("fov 0"));
  expect_in("depths from 5 to 2 m", refused("range [5 2]"));
}

}  // namespace
}  // namespace sf::trial
