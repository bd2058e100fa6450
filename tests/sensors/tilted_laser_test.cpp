// Lasers of tilted robots cut the scene of solids in their plane.

#include <gtest/gtest.h>

#include <cmath>

#include "raycast/casters.h"
#include "robots/kinematics.h"
#include "scene/rasterizer.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/lidar.h"
#include "sensors/mover_trail.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

/// A laser and a lidar of one ring at one place, 0.75 m above the floor, with equal beams.
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

/// A tilted mount of a level robot, and of a tilted one.
TEST(TiltedLaser, IsMountedAsALidar) {
  const world::World world = world_of(
      "define robot position( size [0.4 0.4 0.5] origin [0 0 0 0] laser( pose [0.1 0 0.25 20] pose6 [0 0.1 0.2 25 -15 "
      "30] size [0 0 0.1] samples 91 fov 180 range_max 12 ) lidar( pose [0.1 0 0.25 20] pose6 [0 0.1 0.2 25 -15 30] "
      "size [0 0 0.1] elevations [0] columns 91 fov 180 range [0 12] ) )\n"
      "model( name \"low\" pose [3 0.4 0 10] size [1 2 0.6] )\nmodel( name \"wall\" pose [9 0 0 0] size [0.2 12 3] )\n"
      "robot( name \"r1\" pose [0 0 0 0] )\nrobot( name \"r2\" pose [0 3 0 0] )\n");
  for (const base::Tilt& tilt : {base::Tilt{}, base::Tilt{0.3, -0.1}}) {
    const Scan laser = sense(world, sensors::kLaser, tilt), lidar = sense(world, sensors::kLidar, tilt);
    EXPECT_EQ(laser.hits, lidar.hits);
    ASSERT_EQ(laser.values.size(), lidar.values.size());
    for (std::size_t i = 0; i < laser.values.size(); ++i) EXPECT_NEAR(laser.values[i], lidar.values[i], 1e-9);
    EXPECT_EQ(laser.bound, scene::kRangeError);
  }
  const auto parsed = sensors::laser_type.parse(world);
  EXPECT_GE(sensors::laser_type.bound(world, parsed, 0).error, scene::kRangeError);
  // The settings survive a world that is built in code.
  world::World built = world;
  const sensors::LaserSettings before = sensors::lasers_of(world.movers[0])[0];
  built.movers[0].sensors = {sensors::laser_sensor(before)};
  const base::RigidTransform X = mount_of(before), Y = mount_of(sensors::lasers_of(built.movers[0])[0]);
  for (int k = 0; k < 3; ++k) EXPECT_LT(glm::length(X.R[k] - Y.R[k]), 1e-15) << k;
}

/// Without roll and pitch, `pose6` is `pose` to the bit: the planar caster casts, with its bound.
TEST(TiltedLaser, LevelPose6IsPose) {
  const auto scan = [](const std::string& mount) {
    return sense(world_of("position( size [0.4 0.4 0.5] laser( " + mount +
                          " samples 91 fov 360 range_max 12 ) )\n"
                          "model( pose [9 0 0 0] size [0.2 12 3] )"),
                 sensors::kLaser, {});
  };
  const Scan six = scan("pose6 [0.1 0.2 0.3 0 0 20]"), four = scan("pose [0.1 0.2 0.3 20]");
  EXPECT_EQ(six.values, four.values);
  EXPECT_EQ(six.bound, four.bound);
  EXPECT_LT(six.bound, scene::kRangeError);
}

/// Sensors that stay level refuse a mount that they would ignore, and so do the uses of a tilted scan as a planar one.
TEST(TiltedLaser, LevelSensorsRefuseATiltedMount) {
  const auto refused = [](const std::string& inside) {
    return refusal_of([&] {
      const world::World world = world_of("position( size [1 1 1]\n" + inside + " )");
      farm::Farm farm(world, host_device(), {.threads = 1});
    });
  };
  for (const char* sensor : {"sonar", "infrared", "magnetometer", "gyro", "fiducial"}) {
    const std::string text = refused(std::string(sensor) + "( pose6 [0 0 0 0 10 0] )");
    expect_in("2: '" + std::string(sensor) + "' stays level and has no 'pose6'; expected 'pose [x y z yaw]'", text);
    for (const char* has : {"lidar", "laser", "sensor of ranger", "camera", "radar", "imu"}) expect_in(has, text);
  }
  expect_in("'ranger' stays level", refused("ranger( pose6 [0 0 0 0 10 0] sensor( ) )"));
  EXPECT_EQ(refused("ranger( sensor( pose6 [0 0 0 0 10 0] ) )"), "");
  for (const char* use :
       {"occupancy( )", "occupancy( sources [\"laser\"] )", "derived( type \"features\" inputs [\"laser\"] )"})
    expect_in("laser 'laser:0' is tilted by its 'pose6'",
              refused(std::string("laser( samples 9 pose6 [0 0 0 0 10 0] ) ") + use));
}

/// Nose down by 10 degrees, the middle beam meets the floor. The sensor, 0.75 m above the origin, tilts with its robot.
TEST(TiltedLaser, SeesTheFloor) {
  const world::World world = world_of(
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] laser( pose [0 0 0.25 0] size [0 0 0] samples 3 fov 90 range_max "
      "8 ) )");
  const double pitch = 10 * M_PI / 180;
  const Scan scan = sense(world, sensors::kLaser, {0.0, pitch});
  EXPECT_NEAR(scan.values[1], 0.75 / std::tan(pitch), 1e-9);
  EXPECT_EQ(scan.hits[1], base::kFloorHit);
  EXPECT_EQ(sense(world, sensors::kLaser, {}).values[1], 8.0);
}

/// A level laser in a world with terrain sees it, as a lidar does: 2 m high from x = 4 on.
TEST(TiltedLaser, SeesTerrainFromALevelRobot) {
  world::World world = world_of(
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] laser( pose [0 0 0.25 0] size [0 0 0] samples 3 fov 2 range_max 8 "
      ") )");
  world.terrain.push_back({"", {5.0, 0.0, 0.0, 0.0}, {1.0, 1.0}, 11, 11, std::vector<float>(121)});
  for (std::size_t i = 0; i < 121; ++i) world.terrain[0].heights[i] = i % 11 >= 4 ? 2.0f : 0.0f;
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 1});
  const base::ReadingBlock r = farm.sense(0, sensors::kLaser, 0, {});
  EXPECT_NEAR(r.values[1], 3.375, 1e-6) << "the slope from x = 3 to 4 at 0.75 m";
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

/// Drives in ticks of 10 ms. @return the last scan
std::vector<double> drive(const world::World& world, const base::Twist& twist, base::Pose& X_WM) {
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 2});
  farm.subscribe(0, base::only(sensors::kLaser));
  std::vector<double> last;
  base::Report state{0, 0, X_WM, twist};
  for (int tick = 0; tick <= 20; ++tick, state.time += 10'000'000) {
    if (tick > 0) state.X_WM = robots::advance(state.X_WM, twist, 0.01);
    for (const base::ReadingBlock& r : farm.tick(state.time, std::span(&state, 1)))
      last.assign(r.values.begin(), r.values.end());
  }
  X_WM = state.X_WM;
  return last;
}

/// Each beam of a rolling scan has the range from the pose at its own time: a half turn of a laser of 10 Hz takes 50
/// ms, and the last of its 91 beams is cast at the time of the reading.
TEST(RollingLaser, EachBeamIsCastFromThePoseAtItsTime) {
  world::World rolling = twins("rolling 1");
  rolling.interval = 0.01;
  const base::Twist twist{1.0, 0.2, 2.0};
  base::Pose last{0.3, -0.2, 0.0, 0.4};
  const std::vector<double> values = drive(rolling, twist, last);
  const world::World still = twins();
  farm::Farm farm(still, host_device(), {.noise = false, .threads = 1});
  std::size_t moved = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const base::Pose then = robots::advance(last, twist, -0.05 * static_cast<double>(90 - i) / 91);
    EXPECT_NEAR(farm.sense(0, sensors::kLaser, 0, then).values[i], values[i], 1e-6) << i;
    moved += std::abs(farm.sense(0, sensors::kLaser, 0, last).values[i] - values[i]) > 1e-3;
  }
  EXPECT_GT(moved, 20u);
}

/// At rest, it sees another robot pass where that one was at the time of each beam.
TEST(RollingLaser, SeesOthersMove) {
  world::World rolling = twins("rolling 1"), still = twins();
  rolling.interval = 0.01;
  farm::Farm farm(rolling, host_device(), {.noise = false, .threads = 1});
  farm::Farm reference(still, host_device(), {.noise = false, .threads = 1});
  for (farm::Farm* each : {&farm, &reference}) each->subscribe(0, base::only(sensors::kLaser));
  std::vector<base::Report> states{{0, 0, {}, {}}, {1, 0, {1.5, 2.0, 0.4, -1.5}, {6.0, 0.0, 1.0}}};
  std::vector<double> values;
  for (int tick = 0; tick <= 20; ++tick, states[1].time += 10'000'000) {
    if (tick > 0) states[1].X_WM = robots::advance(states[1].X_WM, states[1].velocity, 0.01);
    for (const base::ReadingBlock& r : farm.tick(states[1].time, states))
      values.assign(r.values.begin(), r.values.end());
  }
  std::size_t seen = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::vector<base::Report> then = states;
    then[1].X_WM = robots::advance(then[1].X_WM, then[1].velocity, -0.05 * static_cast<double>(90 - i) / 91);
    const base::ReadingBlock r = reference.tick(static_cast<std::int64_t>(i + 1) * 1'000'000'000, then)[0];
    EXPECT_NEAR(r.values[i], values[i], 1e-6) << i;
    seen += r.hits[i] < rolling.models.size() && rolling.models[r.hits[i]].mover == 1;
  }
  EXPECT_GT(seen, 3u);
}

/// At rest it has the bytes of a scan that is not rolling.
TEST(RollingLaser, AtRestNothingChanges) {
  base::Pose X{0.3, -0.2, 0.0, 0.4};
  EXPECT_EQ(drive(twins("rolling 1"), {}, X), drive(twins(), {}, X));
}

TEST(RollingLaser, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& laser) {
    return refusal_of([&] { const sensors::SensorSet set(world_of("position( \nlaser( " + laser + " ) )")); });
  };
  expect_in("trial.world:2: 'scan_time' is that of a rolling scan", refused("scan_time 0.1"));
  expect_in("'scan_time'", refused("rolling 1 scan_time 0"));
  expect_in("a rolling scan of 20000 beams; expected at most 10000", refused("rolling 1 samples 20000"));
}

/// A mover that is put to x = 5 and then drives 0.12 m in the tick of 50 ms: before the put it stood at 5 m.
TEST(MoverTrail, DrivesFromWhereItWasPut) {
  constexpr std::int64_t kMs = 1'000'000;
  sensors::MoverTrail trail(1000 * kMs, 5.0);
  trail.add({0, 300 * kMs, {0.50, 0.0, 0.0, 0.0}, {1.0}});
  trail.add({0, 350 * kMs, {0.55, 0.0, 0.0, 0.0}, {1.0}});
  const base::Report now{0, 400 * kMs, {5.12, 0.0, 0.0, 0.0}, {2.4}};
  const auto x = [&](std::int64_t ms, const base::Report& last) { return trail.at(ms * kMs, last).X_WM.x; };
  const double before = x(310, now), at_put = x(350, now), after = x(360, now), late = x(380, now), end = x(400, now);
  EXPECT_NEAR(before, 5.0, 1e-12);
  EXPECT_NEAR(at_put, 5.0, 1e-12);
  EXPECT_NEAR(after, 5.024, 1e-12);
  EXPECT_NEAR(late, 5.072, 1e-12);
  EXPECT_EQ(end, 5.12);
  // The same with ticks after the put.
  trail.add(now);
  const base::Report next{0, 450 * kMs, {5.24, 0.0, 0.0, 0.0}, {2.4}};
  EXPECT_NEAR(x(310, next), 5.0, 1e-12);
  EXPECT_NEAR(x(380, next), 5.072, 1e-12);
  EXPECT_NEAR(x(425, next), 5.18, 1e-12);
  // 4 m back to 5.12: the reach includes the pose of the put, which no tick has.
  sensors::MoverTrail turned(1000 * kMs, 5.0);
  turned.add({0, 0, {8.0, 0.0, 0.0, 0.0}, {}});
  EXPECT_NEAR(turned.reach({0, 50 * kMs, {5.12, 0.0, 0.0, 0.0}, {-80.0}}), 4.0, 1e-12);
}

}  // namespace
}  // namespace sf::trial
