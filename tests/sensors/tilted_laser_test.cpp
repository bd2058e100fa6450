// Lasers of tilted robots cut the scene of solids in their plane.

#include <gtest/gtest.h>

#include <cmath>

#include "raycast/casters.h"
#include "scene/rasterizer.h"
#include "sensors/laser.h"
#include "sensors/lidar.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

/// A laser and a lidar of one ring at one place, 0.5 m above the floor, with equal beams.
world::World twins(const std::string& laser = "") {
  return world_of(
      "define robot position( size [0.4 0.4 0.5] origin [0 0 0 0] laser( pose [0.1 0 0.25 20] size [0 0 0] samples 91 "
      "fov 180 range_max 12 " +
      laser +
      " ) lidar( pose [0.1 0 0.25 20] size [0 0 0] elevations [0] columns 91 fov 180 "
      "range [0 12] ) )\n"
      "model( name \"low\" pose [3 0.4 0 10] size [1 2 0.6] )\n"
      "model( name \"wall\" pose [9 0 0 0] size [0.2 12 3] )\n"
      "robot( name \"r1\" pose [0 0 0 0] )\nrobot( name \"r2\" pose [0 3 0 0] )\n");
}

struct Scan {
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  double bound = 0.0;
};

Scan sense(const world::World& world, std::uint8_t type, const base::Tilt& tilt, const char* caster = "auto") {
  farm::FarmOptions options{.noise = false, .threads = 2};
  options.scene.caster = raycast::caster_named(caster);
  farm::Farm farm(world, host_device(), options);
  const base::ReadingBlock r = farm.sense(0, type, 0, {0.3, -0.2, 0.0, 0.4}, tilt);
  return {{r.values.begin(), r.values.end()}, {r.hits.begin(), r.hits.end()}, r.bound};
}

/// The lidar's beams are known to be exact; the laser's are the same.
TEST(TiltedLaser, ReadsWhatALidarOfOneRingReads) {
  const world::World world = twins();
  for (const base::Tilt& tilt : {base::Tilt{0.0, 0.1}, base::Tilt{0.3, 0.0}, base::Tilt{-0.2, -0.15}})
    for (const char* caster : {"auto", "reference"}) {
      const Scan laser = sense(world, sensors::kLaser, tilt, caster),
                 lidar = sense(world, sensors::kLidar, tilt, caster);
      EXPECT_EQ(laser.hits, lidar.hits);
      ASSERT_EQ(laser.values.size(), lidar.values.size());
      for (std::size_t i = 0; i < laser.values.size(); ++i) EXPECT_NEAR(laser.values[i], lidar.values[i], 1e-9);
      EXPECT_EQ(laser.bound, scene::kRangeError);
    }
}

/// Nose down by 10 degrees, the middle beam meets the floor h / sin(10 degrees) ahead, below the wall behind it.
TEST(TiltedLaser, SeesTheFloor) {
  const world::World world = world_of(
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] laser( pose [0 0 0.25 0] size [0 0 0] samples 3 fov 90 range_max "
      "8 ) )");
  const double pitch = 10 * M_PI / 180;
  const Scan scan = sense(world, sensors::kLaser, {0.0, pitch});
  EXPECT_NEAR(scan.values[1], 0.5 / std::sin(pitch), 1e-9);
  EXPECT_EQ(scan.hits[1], base::kFloorHit);
  EXPECT_EQ(sense(world, sensors::kLaser, {}).values[1], 8.0);
}

/// Level scans keep their bytes after tilted ones, and `range_min`, `resolution` and noise apply to tilted ones too.
TEST(TiltedLaser, IsReworkedAsLevelScansAre) {
  const world::World world = twins("range_min 2.5 resolution 3");
  const Scan full = sense(twins(), sensors::kLaser, {0.0, 0.1});
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 1});
  const base::Pose X{0.3, -0.2, 0.0, 0.4};
  const auto level = farm.sense(0, sensors::kLaser, 0, X).values;
  const std::vector<double> before(level.begin(), level.end());
  const base::ReadingBlock tilted = farm.sense(0, sensors::kLaser, 0, X, {0.0, 0.1});
  for (std::size_t i = 0; i < full.values.size(); i += 3) {
    EXPECT_EQ(tilted.values[i], std::max(2.5, full.values[i]));
    EXPECT_EQ(tilted.quality[i] == base::QualityFlag::too_near, full.values[i] < 2.5);
  }
  EXPECT_EQ(tilted.quality[1], base::QualityFlag::not_cast);
  EXPECT_TRUE(std::ranges::equal(farm.sense(0, sensors::kLaser, 0, X).values, before));
}

}  // namespace
}  // namespace sf::trial
