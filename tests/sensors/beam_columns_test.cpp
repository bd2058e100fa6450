// Obstacles above the ground in the columns of depth images and lidars: slopes, leaning walls, noise.

#include "sensors/beam_columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "sensors/sensor_set.h"
#include "sensors/settings.h"
#include "world/stage/build_world.h"

namespace sf::sensors {
namespace {

constexpr double kHeight = 1.4;  // [m] of the sensors above the ground

world::World carrier(const std::string& sensor) {
  return world::build_world("columns.world", "position( size [1 1 1.4] " + sensor + " )",
                            {.sensors = world_file_words()});
}

/// [m] Returns the distance at which a beam meets ground that is flat, then rises as `slope` from `from` on.
double ground_range(const glm::dvec3& u, double from, double slope) {
  const double across = std::hypot(u.x, u.y), level = -u.z / across;
  const double flat = level > 0.0 ? kHeight / level : HUGE_VAL;
  if (flat <= from) return flat / across;
  return level + slope > 0.0 ? (kHeight + slope * from) / (level + slope) / across : HUGE_VAL;
}

/// Returns the largest count of columns with an obstacle in ten images of `range_of` the beams.
std::ptrdiff_t columns_in_images(double noise, const std::function<double(const glm::dvec3&)>& range_of) {
  const world::World world = carrier("camera( resolution [160 90] fov 50 range [0.5 150] size [0 0 0] )");
  CameraSettings camera = CameraReader().read(world.movers[0].sensors[0]);
  camera.depth_noise = noise;
  BeamColumns columns(camera);
  std::mt19937_64 random(1);
  std::ptrdiff_t most = 0;
  for (int image = 0; image < 10; ++image) {
    std::vector<double> depths;
    for (const glm::dvec3& d : camera.beams->directions) {
      const double depth = std::min(range_of(camera.X_MS.R * d) * d.x, camera.range_max);
      depths.push_back(depth + (depth < camera.range_max ? camera.depth_sigma(depth) : 0.0) *
                                   std::normal_distribution<double>{}(random));
    }
    sensorfarm::Reading reading;
    reading.values = depths;
    most = std::max(most, std::ranges::count_if(columns.ranges(reading), [](double r) { return std::isfinite(r); }));
  }
  return most;
}

TEST(BeamColumns, NoiseOnASlopeIsNoObstacle) {
  const auto hill = [](const glm::dvec3& u) { return ground_range(u, 15.0, 0.2); };
  EXPECT_EQ(columns_in_images(0.0, hill), 0);
  EXPECT_LE(columns_in_images(5e-4, hill), 3) << "of 145, of one image in ten";
}

/// A wall that leans by 10 degrees, 12 m ahead, 1.3 m high. Its rows are 10 cm apart, less than a step of the ground.
TEST(BeamColumns, FindsWallsThatLean) {
  const auto wall = [](const glm::dvec3& u) {
    const double slope = 1.0 / std::tan(10.0 * M_PI / 180.0);
    const double ahead = (12.0 * slope + kHeight) / (slope - u.z / u.x), height = kHeight + ahead * u.z / u.x;
    return height > 0.0 && height < 1.3 ? ahead / u.x : ground_range(u, HUGE_VAL, 0.0);
  };
  for (const double noise : {0.0, 5e-4}) EXPECT_GE(columns_in_images(noise, wall), 140) << noise;

  const world::World world = carrier("lidar( channels 91 fov_v [-20 10] columns 101 fov 50 range [0.3 120] )");
  LidarReader reader;
  const LidarSettings lidar = reader.read(world, world.movers[0].sensors[0]);
  BeamColumns columns(lidar);
  std::vector<double> ranges;
  for (const glm::dvec3& d : lidar.beams->directions)
    ranges.push_back(std::min(wall(lidar.X_MS.R * d), lidar.echo.range_max));
  sensorfarm::Reading reading;
  reading.values = ranges;
  for (const double range : columns.ranges(reading)) EXPECT_NEAR(range, 12.0, 2.0);
}

}  // namespace
}  // namespace sf::sensors
