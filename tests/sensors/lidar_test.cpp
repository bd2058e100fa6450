// Lidars: against every face in `long double`, their patterns, mounts, noise, packets and refusals.

#include "sensors/lidar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "raycast/casters.h"
#include "scene/reference_scan.h"
#include "scene/solids.h"
#include "sensors/lidar_beams.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

using base::QualityFlag;

constexpr const char* kScene =
    "define robot position( size [0.4 0.4 0.5] origin [0 0 0 0] )\n"
    "model( name \"block\" pose [4 0.3 0 10] size [1 2 0.8] )\n"
    "model( name \"stack\" pose [4 0.3 0.8 50] size [0.5 0.5 0.5] )\n"
    "model( name \"wall\" pose [9 0 0 0] size [0.2 12 3] )\n"
    "model( name \"bridge\" pose [-3 0 1.5 0] size [2 6 0.2] )\n"
    "model( name \"ring\" pose [0 5 0 0] size [3 3 0.7] block( points 4 point[0] [0 0] point[1] [2 0] point[2] [2 1] "
    "point[3] [0 3] ) )\n";

/// A robot with a lidar, and two others.
world::World scene_with(const std::string& lidar, const std::string& before = "") {
  return world_of(before + kScene + "robot( name \"r1\" pose [0 0 0 20] lidar( " + lidar +
                  " ) )\nrobot( name \"r2\" pose [2 2 0 30] )\nrobot( name \"r3\" pose [2 -1 0.4 -70] )\n");
}

/// One reading, with the pose and the directions of its beams.
struct Sensed {
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  std::vector<QualityFlag> quality;
  double bound = 0.0;
  base::RigidTransform X_WS;
  std::vector<glm::dvec3> directions;
};

Sensed sense(const world::World& world, const base::Pose& X_WM, const base::Tilt& tilt = {},
             std::uint32_t threads = 2) {
  farm::Farm farm(world, host_device(), {.noise = false, .threads = threads});
  const base::ReadingBlock reading = farm.sense(0, sensors::kLidar, 0, X_WM, tilt);
  const sensors::SensorSet sensor_set(world);
  const sensors::SpatialBeams beams = sensor_set.beams(reading);
  Sensed out{{reading.values.begin(), reading.values.end()},
             {reading.hits.begin(), reading.hits.end()},
             {reading.quality.begin(), reading.quality.end()},
             reading.bound,
             base::compose(base::transform_of(X_WM, tilt), beams.X_MS),
             {beams.directions.begin(), beams.directions.end()}};
  out.quality.resize(out.values.size());
  return out;
}

/// Compares a reading with the reference over walls, floor and the other movers.
void expect_true(const world::World& world, const Sensed& reading, double range_max) {
  std::vector<scene::SurfaceTree> trees{scene::build_tree(scene::mesh_of(world.walls))};
  for (const world::Mover& mover : world.movers) trees.push_back(scene::build_tree(scene::mesh_of(mover.body)));
  std::vector<scene::Instance> instances{{&trees[0], {}, true}};
  for (std::size_t m = 1; m < world.movers.size(); ++m)
    instances.push_back({&trees[m + 1], base::transform_of(world.movers[m].X_WM), false});
  std::size_t wrong = 0, flagged = 0;
  for (std::size_t i = 0; i < reading.values.size(); ++i) {
    if (reading.quality[i] != QualityFlag::none) {
      ++flagged;
      continue;
    }
    const auto hit =
        scene::reference_scan(reading.X_WS, reading.directions[i], range_max, {instances, !world.floor_unseen});
    if (!(std::abs(static_cast<double>(hit.range) - reading.values[i]) <= reading.bound)) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_LT(flagged, reading.values.size() / 100);
}

/// Walls, tops, an overhead bridge, other robots and the floor; level, and with the robot and its mount tilted.
TEST(Lidar, ReadsTheNearestSurface) {
  const world::World world =
      scene_with("channels 24 fov_v [-40 30] columns 90 range [0 20] pose6 [0.1 0.05 0.2 3 -8 15]");
  for (const base::Tilt& tilt : {base::Tilt{}, base::Tilt{0.1, -0.2}, base::Tilt{-0.7, 0.3}}) {
    const Sensed reading = sense(world, {0.2, -0.3, 0.1, 0.4}, tilt);
    expect_true(world, reading, 20.0);
    EXPECT_GT(std::ranges::count(reading.hits, base::kFloorHit), 100);
  }
  EXPECT_EQ(sense(world, world.movers[0].X_WM, {}, 1).values, sense(world, world.movers[0].X_WM, {}, 7).values);
}

/// The reference caster reads the same to rounding.
TEST(Lidar, ReferenceCaster) {
  const world::World world = scene_with("channels 6 fov_v [-40 30] columns 40 range [0 20]");
  farm::FarmOptions options{.noise = false, .threads = 2};
  options.scene.caster = raycast::caster_named("reference");
  farm::Farm farm(world, host_device(), options);
  const base::ReadingBlock reading = farm.sense(0, sensors::kLidar, 0, world.movers[0].X_WM);
  const Sensed exact = sense(world, world.movers[0].X_WM);
  EXPECT_TRUE(std::ranges::equal(reading.hits, exact.hits));
  for (std::size_t i = 0; i < exact.values.size(); ++i) EXPECT_NEAR(reading.values[i], exact.values[i], exact.bound);
}

/// Values worked out by hand: the sensor is 0.85 m above the floor, at half of its model's height.
TEST(Lidar, HandValues) {
  const world::World world = world_of(
      "model( name \"wall\" pose [5 0 0 0] size [2 2 1] )\n"
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] lidar( size [0.1 0.1 0.1] pose [0 0 0.3 0] elevations [-45 0 5] "
      "columns 4 range [0 30] ) )");
  const Sensed r = sense(world, {});
  EXPECT_NEAR(r.X_WS.p.z, 0.85, 1e-15);
  EXPECT_NEAR(r.values[2], 0.85 * std::sqrt(2.0), 1e-8) << "the floor, ahead: columns begin behind";
  EXPECT_EQ(r.hits[2], base::kFloorHit);
  EXPECT_NEAR(r.values[4 + 2], 4.0, 1e-8) << "the front of the wall";
  EXPECT_EQ(world.models[r.hits[6]].name, "wall");
  EXPECT_EQ(r.values[8 + 2], 30.0) << "above its top";
  EXPECT_EQ(r.hits[8 + 2], base::kNoHit);
  EXPECT_NEAR(r.directions[8 + 2].z, std::sin(M_PI / 36), 1e-15);
}

/// A beam through a hole in the floor meets nothing; its neighbours meet the floor up to the edge, and beyond it.
TEST(Lidar, HolesInTheFloor) {
  const std::string lidar =
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] lidar( size [0.1 0.1 0.1] pose [0 0 0.3 0] elevations [-60 -45 "
      "-25] "
      "columns 4 range [0 30] ) )\n";
  const world::World world = world_of(lidar + "model( name \"pit\" pose [1.1 0 0 0] size [1 1 0.1] cliff_return 1 )\n");
  const Sensed r = sense(world, {});
  EXPECT_NEAR(r.values[2], 0.85 / std::sin(M_PI / 3), 1e-8) << "0.49 m ahead, before the hole";
  EXPECT_EQ(r.hits[2], base::kFloorHit);
  EXPECT_EQ(r.values[4 + 2], 30.0) << "0.85 m ahead, in the hole";
  EXPECT_EQ(r.hits[4 + 2], base::kNoHit);
  EXPECT_NEAR(r.values[8 + 2], 0.85 / std::sin(M_PI / 7.2), 1e-8) << "1.82 m ahead, behind it";
  EXPECT_EQ(r.hits[8 + 2], base::kFloorHit);
  const Sensed whole = sense(world_of(lidar), {});
  for (std::size_t i = 0; i < r.values.size(); ++i)
    EXPECT_NEAR(i == 6 ? whole.values[i] : r.values[i], whole.values[i], 1e-8);
  const world::World unseen = world_of("floor_return 0\n" + lidar + "model( size [1 1 0.1] cliff_return 1 )\n");
  EXPECT_EQ(std::ranges::count(sense(unseen, {}).hits, base::kFloorHit), 0);
}

/// Holes that overlap, at angles, and a sensor far from all: each beam meets the floor unless its point is in a hole.
TEST(Lidar, FloorBetweenOverlappingHoles) {
  const std::string lidar =
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] lidar( channels 40 fov_v [-60 -10] columns 360 "
      "range [0 30] ) )\n";
  const world::World world = world_of(lidar +
                                      "model( pose [0.6 0.3 0 20] size [0.5 0.4 0.1] cliff_return 1 )\n"
                                      "model( pose [0.7 0.35 0 50] size [0.5 0.4 0.1] cliff_return 1 )\n"
                                      "model( pose [0.6 0.3 0 65] size [0.9 0.1 0.1] cliff_return 1 )\n");
  const auto inside = [](const std::vector<glm::dvec2>& outline, glm::dvec2 p) {
    bool in = false;
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++)
      if ((outline[i].y > p.y) != (outline[j].y > p.y) &&
          p.x < (outline[j].x - outline[i].x) * (p.y - outline[i].y) / (outline[j].y - outline[i].y) + outline[i].x)
        in = !in;
    return in;
  };
  for (const base::Pose& X_WM : {base::Pose{}, base::Pose{0.6, 0.3, 0.0, 0.2}, base::Pose{500.0, -300.0, 0.0, 0.0}}) {
    const Sensed r = sense(world, X_WM);
    std::size_t holes = 0, wrong = 0;
    for (std::size_t i = 0; i < r.values.size(); ++i) {
      const glm::dvec3 d = r.X_WS.R * r.directions[i];
      const double range = -r.X_WS.p.z / d.z;
      const glm::dvec2 p = glm::dvec2(r.X_WS.p) + range * glm::dvec2(d);
      const bool hole = std::ranges::any_of(world.floor_holes, [&](const auto& h) { return inside(h.outline, p); });
      holes += hole;
      wrong += hole ? r.hits[i] != base::kNoHit : !(std::abs(r.values[i] - range) < 1e-8);
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(holes > 0, X_WM.x < 100.0);
  }
}

/// A road above the floor is a surface from above and from below, and counts as ground.
TEST(Lidar, RoadsAboveTheFloor) {
  world::World world = world_of(
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] lidar( size [0.1 0.1 0.1] pose [0 0 0.3 0] elevations [-30 45 80] "
      "columns 4 range [0 30] ) )\n");
  world.ramps.push_back({{3.0, -5.0}, {3.0, 5.0}, 2.85, 2.85, 1.5});  // over x from 1.5 to 4.5
  const Sensed r = sense(world, {});
  EXPECT_NEAR(r.values[4 + 2], 2.0 * std::sqrt(2.0), 1e-8) << "2 m above the sensor, from below";
  EXPECT_EQ(r.hits[4 + 2], base::kFloorHit);
  EXPECT_EQ(r.hits[8 + 2], base::kNoHit) << "it passes 0.35 m ahead";
  const Sensed above = sense(world, {3.0, 0.0, 2.85, 0.0});
  EXPECT_NEAR(above.values[2], 0.85 * 2.0, 1e-8) << "on the road";
}

/// Positive pitch lowers the nose, positive roll raises the left side, yaw turns left: R = Rz Ry Rx.
TEST(Lidar, MountAngles) {
  const auto forward = [](const std::string& angles) {
    const world::World world =
        world_of("position( lidar( columns 1 channels 1 fov 10 pose6 [0 0 0 " + angles + "] ) )");
    const Sensed r = sense(world, {});
    return r.X_WS.R * r.directions[0];
  };
  EXPECT_NEAR(glm::distance(forward("0 30 0"), {std::cos(M_PI / 6), 0, -0.5}), 0.0, 1e-15);
  EXPECT_NEAR(glm::distance(forward("0 0 90"), {0, 1, 0}), 0.0, 1e-15);
  EXPECT_NEAR(glm::distance(forward("90 30 90"), {0, std::cos(M_PI / 6), -0.5}), 0.0, 1e-15);
  const world::World rolled = world_of("position( lidar( columns 1 channels 1 fov 10 pose6 [0 0 0 30 0 0] ) )");
  EXPECT_NEAR(sense(rolled, {}).X_WS.R[1].z, 0.5, 1e-15);
}

/// The floor is a surface unless the world says otherwise, and its worlds differ.
TEST(Lidar, FloorReturn) {
  const std::string lidar = "channels 2 fov_v [-30 -20] columns 8";
  const world::World with = scene_with(lidar), without = scene_with(lidar, "floor_return 0\n");
  EXPECT_GT(std::ranges::count(sense(with, {}).hits, base::kFloorHit), 0);
  EXPECT_EQ(std::ranges::count(sense(without, {}).hits, base::kFloorHit), 0);
  EXPECT_NE(with.hash, without.hash);
  EXPECT_TRUE(world::from_snapshot(world::snapshot(without)).floor_unseen);
}

/// Presets have the numbers of the data sheets; settings override them.
TEST(Lidar, Presets) {
  const auto elements = [](const std::string& settings) {
    return sensors::SensorSet(scene_with(settings)).of(sensors::kLidar, 0)[0];
  };
  EXPECT_EQ(elements("preset \"VLP-16\"").elements, 16u * 1800u);
  EXPECT_EQ(elements("preset \"HDL-32E\"").elements, 32u * 2250u);
  EXPECT_EQ(elements("preset \"OS1-64\"").elements, 64u * 1024u);
  EXPECT_EQ(elements("preset \"OS1-64\"").limit, 120.0);
  EXPECT_EQ(elements("preset \"OS1-64\" columns 512 range [1 50]").elements, 64u * 512u);
  const world::World world = scene_with("preset \"Mid-40\"");
  const Sensed rosette = sense(world, {});
  for (const glm::dvec3& d : rosette.directions) EXPECT_LE(std::acos(d.x), 19.3 * M_PI / 180.0);
  expect_true(world, rosette, 260.0);
}

/// Tables of elevations and azimuth offsets, one number per channel.
TEST(Lidar, Tables) {
  const Sensed r = sense(scene_with("elevations [-10 0 3] azimuth_offsets [1 0 -1] columns 5 fov 90"), {});
  ASSERT_EQ(r.directions.size(), 15u);
  const auto azimuth = [&](std::size_t i) { return std::atan2(r.directions[i].y, r.directions[i].x) * 180.0 / M_PI; };
  EXPECT_NEAR(azimuth(0), -44.0, 1e-12);
  EXPECT_NEAR(azimuth(4), 46.0, 1e-12);
  EXPECT_NEAR(azimuth(10), -46.0, 1e-12);
  EXPECT_NEAR(std::asin(r.directions[12].z) * 180.0 / M_PI, 3.0, 1e-12);
}

/// Noise is normal, new in each reading, and leaves beams without a hit alone.
TEST(Lidar, Noise) {
  const world::World world = scene_with("channels 8 fov_v [-30 10] columns 90 range [0 20] noise [0.02 0.001]");
  const auto readings = series(world, sensors::kLidar, 12);
  const Sensed exact = sense(world, world.movers[0].X_WM);
  double squares = 0.0, sum = 0.0;
  double count = 0.0;
  for (const auto& reading : readings)
    for (std::size_t i = 0; i < reading.size(); ++i) {
      if (exact.hits[i] == base::kNoHit) {
        EXPECT_EQ(reading[i], 20.0);
      } else if (exact.values[i] < 19.0) {
        const double z = (reading[i] - exact.values[i]) / std::hypot(0.02, 0.001 * exact.values[i]);
        squares += z * z, sum += z, count += 1.0;
      }
    }
  ASSERT_GT(count, 4000.0);
  EXPECT_NEAR(sum / count, 0.0, 4.0 / std::sqrt(count));
  EXPECT_NEAR(squares / count, 1.0, 6.0 / std::sqrt(count));
  EXPECT_NE(readings[0], readings[1]);
}

/// A surface nearer than the smallest range reads that range, with a flag.
TEST(Lidar, TooNear) {
  const Sensed r = sense(scene_with("channels 2 fov_v [-50 -40] columns 6 range [3 20]"), {});
  for (std::size_t i = 0; i < r.values.size(); ++i) {
    EXPECT_GE(r.values[i], 3.0);
    EXPECT_EQ(r.values[i] == 3.0, r.quality[i] == QualityFlag::too_near);
  }
  EXPECT_GT(std::ranges::count(r.quality, QualityFlag::too_near), 0);
}

/// A copy of a world sees its own movers only, and has the readings of the world alone.
TEST(Lidar, CopiesDoNotSeeEachOther) {
  world::World world = scene_with("channels 8 fov_v [-20 10] columns 60 range [0 20]");
  const Sensed alone = sense(world, world.movers[0].X_WM);
  world::copy_movers(world, 3);
  EXPECT_EQ(sense(world, world.movers[0].X_WM).values, alone.values);
}

/// Packets carry ranges in parts, and reject those of other types.
TEST(Lidar, Packets) {
  const world::World world = scene_with("channels 8 fov_v [-20 10] columns 60 range [0 80]");
  const Sensed r = sense(world, {});
  const sensors::SensorSpec spec = sensors::SensorSet(world).of(sensors::kLidar, 0)[0];
  const sensors::SensorType& type = sensors::lidar_type;
  const base::ReadingBlock block{.type = sensors::kLidar, .values = r.values};
  std::vector<double> received(r.values.size());
  const std::uint32_t parts = type.parts(spec, sensors::WireFormat::farm);
  EXPECT_EQ(parts, 2u);
  for (std::uint32_t part = 0; part < parts; ++part) {
    base::Bytes bytes;
    const std::uint8_t id = type.encode(spec, block, sensors::WireFormat::farm, part, bytes);
    EXPECT_EQ(id, sensors::kLidar + sensors::kExtended);
    const auto decoded = type.decode(spec, bytes, id, sensors::WireFormat::farm);
    ASSERT_EQ(decoded.fault, sensors::PayloadError::none);
    type.read(spec, bytes, id, sensors::WireFormat::farm, received);
    EXPECT_NE(type.decode(spec, bytes, 1, sensors::WireFormat::farm).fault, sensors::PayloadError::none);
  }
  const double error = type.wire_error(spec, block);
  for (std::size_t i = 0; i < received.size(); ++i) EXPECT_NEAR(received[i], r.values[i], error);
}

/// Each refusal names the setting, the expected values, and the line.
TEST(Lidar, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& lidar) {
    return refusal_of([&] {
      const world::World world = world_of("position( \nlidar( " + lidar + " ) )");
      const sensors::SensorSet sensor_set(world);
    });
  };
  expect_in("trial.world:2: there is no preset \"VLP16\"; expected VLP-16", refused("preset \"VLP16\""));
  expect_in("'channels'", refused("channels 0"));
  expect_in("2048000 beams; expected at most 1000000", refused("channels 1024 columns 2000"));
  expect_in("leave out 'channels'", refused("elevations [1 2] channels 2"));
  expect_in("2 offsets of 3 channels", refused("elevations [1 2 3] azimuth_offsets [0 0]"));
  expect_in("an angle of 91 degrees", refused("elevations [91]"));
  expect_in("'fov'", refused("fov 361"));
  expect_in("'fov'", refused("fov 0"));
  expect_in("a range from 5 to 2 m", refused("range [5 2]"));
  expect_in("a range from 5 to 5 m", refused("range [5 5]"));
  expect_in("'fov' is 0; expected 5.73e-08 to 360", refused("fov 0"));  // 1e-9 rad, rounded up
  expect_in("at most 100000 m", refused("range [0 1e6]"));
  expect_in("'noise' is negative", refused("noise -1"));
  expect_in("'pose6' expects [x y z roll pitch yaw]", refused("pose6 [1 2 3]"));
  expect_in("'pose6' is more than 1e6 m away", refused("pose6 [1e7 0 0 0 0 0]"));
  expect_in("an angle of 'pose6'", refused("pose6 [0 0 0 1e300 0 0]"));
  for (const char* key : {"channels 3", "fov_v [0 1]", "elevations [0]", "azimuth_offsets [1]"})
    expect_in("the beams of \"Mid-40\" form no rings", refused(std::string("preset \"Mid-40\" ") + key));
  expect_in("'range_max' is 50, but 'range' states 20; expected one of them", refused("range_max 50 range [0 20]"));
  expect_in("'range_min' is 1, but 'range' states 0", refused("range_min 1 range [0 20]"));
}

}  // namespace
}  // namespace sf::trial
