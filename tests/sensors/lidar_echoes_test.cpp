// Tests intensities, angles of incidence, second echoes, dropouts and rolling scans of lidars.

#include "sensors/lidar_echoes.h"

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>
#include <algorithm>
#include <cmath>
#include <fstream>

#include "raycast/casters.h"
#include "robots/kinematics.h"
#include "sensors/lidar.h"
#include "sensors/lidar_beams.h"
#include "sensors/lidar_packets.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"
#include "world/beam_table.h"

namespace sf::trial {
namespace {

constexpr double kDegree = M_PI / 180.0;

/// A robot with a lidar 0.75 m above the floor, a board 4 m ahead and a wall 9 m ahead.
world::World boards(const std::string& lidar, const std::string& board = "reflectance 0.8") {
  return world_of(
      "define robot position( size [0.4 0.4 0.5] origin [0 0 0 0] )\n"
      "model( name \"board\" pose [4.05 0 0 0] size [0.1 1 3] " +
      board +
      " )\n"
      "model( name \"wall\" pose [9.1 0 0 0] size [0.2 40 8] )\n"
      "robot( name \"r1\" pose [0 0 0 0] lidar( pose [0 0 0.25 0] size [0 0 0] " +
      lidar + " ) )\n");
}

struct Read {
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  double bound;
  std::size_t width;
  double at(std::size_t beam, std::size_t column) const { return values[beam * width + column]; }
  std::size_t beams() const { return hits.size(); }
};

Read echoes_of(const world::World& world, const base::Pose& X_WM = {}, const char* caster = "auto") {
  farm::FarmOptions options{.noise = false, .threads = 2};
  options.scene.caster = raycast::caster_named(caster);
  farm::Farm farm(world, host_device(), options);
  const base::ReadingBlock r = farm.sense(0, sensors::kLidar, 0, X_WM);
  return {{r.values.begin(), r.values.end()},
          {r.hits.begin(), r.hits.end()},
          r.bound_without_noise,
          r.values.size() / r.hits.size()};
}

/// Lambert's law at a board that the beams meet at known angles; ranges are those of a lidar without intensities.
TEST(LidarEchoes, IntensityAndIncidence) {
  const std::string beams = "channels 3 fov_v [-5 5] columns 5 fov 8 ";
  const Read plain = echoes_of(boards(beams)), r = echoes_of(boards(beams + "incidence 1"));
  ASSERT_EQ(r.width, 3u);
  EXPECT_EQ(r.hits, plain.hits);
  for (std::size_t i = 0; i < r.beams(); ++i) {
    EXPECT_EQ(r.at(i, 0), plain.values[i]);
    if (r.at(i, 0) > 5.0) continue;
    const double cosine = 4.0 / r.at(i, 0);
    EXPECT_NEAR(r.at(i, 1), 0.8 * cosine, 1e-6);
    EXPECT_NEAR(r.at(i, 2), std::acos(std::min(1.0, cosine)), 1e-3);
  }
  EXPECT_EQ(echoes_of(boards(beams + "intensity 1")).width, 2u);
}

/// Whole scans against the reference, which computes the normals of faces by itself.
TEST(LidarEchoes, CosinesAgreeWithTheReference) {
  const world::World world = boards("channels 24 fov_v [-40 30] columns 90 incidence 1");
  const Read fast = echoes_of(world, {0.3, 0.2, 0.1, 0.7}), slow = echoes_of(world, {0.3, 0.2, 0.1, 0.7}, "reference");
  std::size_t far = 0;
  for (std::size_t i = 0; i < fast.beams(); ++i) {
    if (fast.hits[i] != slow.hits[i]) continue;  // an edge
    far += std::abs(fast.at(i, 1) - slow.at(i, 1)) > 1e-6;
  }
  EXPECT_EQ(far, 0u);
}

/// Without a key a model has the default; the floor too; a beam without an echo has 0.
TEST(LidarEchoes, DefaultReflectance) {
  const Read r = echoes_of(boards("elevations [0 -80 80] columns 1 fov 1 intensity 1", ""));
  EXPECT_NEAR(r.at(0, 1), 0.5, 1e-9);
  EXPECT_NEAR(r.at(1, 1), 0.5 * std::sin(80 * kDegree), 1e-6);
  EXPECT_EQ(r.hits[2], base::kNoHit);
  EXPECT_EQ(r.at(2, 1), 0.0);
}

/// A lane along x between two lines, from 1 to 1.2 m to both sides. @param key in the world
world::World street(const std::string& lidar, const std::string& key = "", const std::string& more = "") {
  return world_of(key +
                  "\npath( pose [-20 0 0 0] pieces 1 straight[0] [40 2] left \"solid_white\" right \"solid_yellow\" "
                  "paint_width 0.2 )\n"
                  "position( name \"r1\" size [0.4 0.4 0.5] origin [0 0 0 0] lidar( pose [0 0 0.25 0] size [0 0 0] " +
                  lidar + " ) )\n" + more);
}

/// Beams on and beside the lines, for the default and for stated reflectances; the reference agrees.
TEST(LidarEchoes, PaintHasAReflectance) {
  const std::string lidar = "channels 30 fov_v [-60 -10] columns 240 intensity 1 range [0 20]";
  const Read usual = echoes_of(street(lidar)),
             stated = echoes_of(street(lidar, "paint_reflectance 20 floor_reflectance 0.1"));
  std::size_t painted = 0, bare = 0;
  for (std::size_t i = 0; i < usual.beams(); ++i) {
    const double down = (-60.0 + 50.0 * static_cast<double>(i / 240) / 29.0) * kDegree,
                 azimuth = (-180.0 + 1.5 * static_cast<double>(i % 240)) * kDegree;
    const double y = usual.at(i, 0) * std::cos(down) * std::sin(azimuth), sine = std::sin(-down);
    if (usual.hits[i] != base::kFloorHit || std::abs(std::abs(std::abs(y) - 1.1) - 0.1) < 1e-9) continue;
    const bool on = std::abs(std::abs(y) - 1.1) < 0.1;
    ++(on ? painted : bare);
    ASSERT_NEAR(usual.at(i, 1), (on ? 0.8 : 0.5) * sine, 1e-6) << y;
    ASSERT_NEAR(stated.at(i, 1), (on ? 20.0 : 0.1) * sine, 2e-5) << y;
  }
  EXPECT_GT(painted, 300u);
  EXPECT_GT(bare, 3000u);
  const Read traced = echoes_of(street(lidar), {}, "reference");
  for (std::size_t i = 0; i < usual.beams(); ++i) ASSERT_NEAR(usual.at(i, 1), traced.at(i, 1), 1e-6) << i;
}

/// Straight down from 0.75 m: the echo of the floor is too weak beside a line, and just strong enough on it.
TEST(LidarEchoes, PaintIsDetectedWhereTheFloorIsNot) {
  const world::World world = street("elevations [-90] columns 1 fov 1 detects [0.75 0.5] range [0 20]",
                                    "paint_reflectance 0.501 floor_reflectance 0.499");
  EXPECT_EQ(echoes_of(world, {0.0, 0.9, 0.0, 0.0}).hits[0], base::kNoHit);
  EXPECT_EQ(echoes_of(world, {0.0, 1.1, 0.0, 0.0}).hits[0], base::kFloorHit);
}

/// What covers paint has its own reflectance.
TEST(LidarEchoes, ModelsCoverPaint) {
  const Read r = echoes_of(street("elevations [-90] columns 1 fov 1 intensity 1", "",
                                  "model( name \"mat\" size [40 4 0.01] reflectance 0.3 )\n"),
                           {0.0, 1.1, 0.0, 0.0});
  EXPECT_NEAR(r.at(0, 1), 0.3, 1e-6);
}

/// Parts of a beam across an edge of paint: the mean of both surfaces.
TEST(LidarEchoes, ConesAcrossPaint) {
  const Read r = echoes_of(street("elevations [-90] columns 1 fov 1 divergence 4 beam_parts 64 intensity 1"),
                           {0.0, 1.0, 0.0, 0.0});
  EXPECT_NEAR(r.at(0, 1), 0.65, 0.01);
}

/// Devices that do not correct for the distance: at twice the reference range a quarter.
TEST(LidarEchoes, InverseSquare) {
  EXPECT_NEAR(echoes_of(boards("elevations [0] columns 1 fov 1 intensity 1 intensity_range 2")).at(0, 1), 0.8 / 4.0,
              1e-9);
}

/// 100 m at 10 % means 4 m at 0.016 %: the board is detected at that reflectance, and just not below.
TEST(LidarEchoes, DetectionRange) {
  const auto range = [](double reflectance) {
    return echoes_of(
               boards("elevations [0] columns 1 fov 1 detects [100 0.1]", fmt::format("reflectance {}", reflectance)))
        .at(0, 0);
  };
  EXPECT_NEAR(range(1.6001e-4), 4.0, 1e-8);
  EXPECT_EQ(range(1.5999e-4), 100.0);
}

/// The share of beams without an echo is binomial; without noise there is none.
TEST(LidarEchoes, DropoutsAreRandom) {
  const world::World world = boards("channels 10 fov_v [-3 3] columns 100 fov 10 dropout 0.2");
  double lost = 0.0, count = 0.0;
  const auto readings = series(world, sensors::kLidar, 5);
  for (const auto& reading : readings)
    for (const double range : reading) lost += range == 100.0, count += 1.0;
  EXPECT_NEAR(lost / count, 0.2, 4.0 * std::sqrt(0.2 * 0.8 / count));
  EXPECT_NE(readings[0], readings[1]);
  for (const double range : echoes_of(world).values) EXPECT_LT(range, 100.0);
}

/// The third number of `noise` grows with the tangent of the angle of incidence, here 60 degrees.
TEST(LidarEchoes, NoiseOfSlopes) {
  const world::World world =
      boards("channels 1 fov_v [0 0] columns 500 fov 0.2 noise [0 0 0.01]", "pose [4 0 0 60] size [0.1 30 3]");
  const Read exact = echoes_of(world);
  double squares = 0.0, count = 0.0;
  for (const auto& reading : series(world, sensors::kLidar, 4))
    for (std::size_t i = 0; i < reading.size(); ++i)
      squares += std::pow((reading[i] - exact.at(i, 0)) / (0.01 * std::tan(60 * kDegree)), 2), count += 1.0;
  EXPECT_NEAR(squares / count, 1.0, 6.0 / std::sqrt(count));
}

/// A cone half on the board's edge returns both surfaces, each with the part of the power that meets it; with a large
/// separation one mixed range between them.
TEST(LidarEchoes, TwoReturns) {
  const std::string cone = "elevations [0] columns 1 fov 1 divergence 1 beam_parts 64 returns 2 ";
  const std::string half = "pose [4.05 0.5 0 0] size [0.1 1 3] reflectance 0.8";
  const Read two = echoes_of(boards(cone, half));
  EXPECT_NEAR(two.at(0, 0), 4.0, 1e-3);
  EXPECT_NEAR(two.at(0, 1), 0.5 * 0.8, 0.03);
  EXPECT_NEAR(two.at(0, 3), 9.0, 1e-3);
  EXPECT_NEAR(two.at(0, 4), 0.5 * 0.5, 0.03);
  const Read mixed = echoes_of(boards(cone + "separation 6", half));
  EXPECT_NEAR(mixed.at(0, 0), (4.0 * 0.4 + 9.0 * 0.25) / 0.65, 0.15);
  EXPECT_EQ(mixed.at(0, 3), 100.0);
  EXPECT_TRUE(std::isinf(mixed.bound)) << "a mixed pixel has no true range";
}

/// The strongest of the other echoes is the second, not the next one.
TEST(LidarEchoes, SecondIsTheStrongestOfTheOthers) {
  const double ranges[] = {3, 5, 5, 8, 8, 8};
  const float cosines[] = {1, 1, 1, 1, 1, 1};
  const std::uint32_t hits[] = {0, 0, 0, 0, 0, 0};
  const base::QualityFlag quality[6] = {};
  sensors::EchoFinder finder;
  const auto echoes = finder.find({}, {ranges, cosines, hits, quality}, sensors::Reflectances(world::World{}, {}));
  EXPECT_EQ(echoes[0]->range, 3.0);
  EXPECT_EQ(echoes[1]->range, 8.0);
}

// --- Accuracy modes

/// Cast columns keep their exact numbers; the others are flagged, and exact on a wall along the horizon.
TEST(LidarModes, SkippedColumnsAreInterpolated) {
  const std::string beams = "channels 3 fov_v [-5 5] columns 32 fov 40 intensity 1 ";
  const world::World world = boards(beams + "accuracy \"skip4\"");
  const Read exact = echoes_of(boards(beams)), skip = echoes_of(world);
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 1});
  const base::ReadingBlock r = farm.sense(0, sensors::kLidar, 0, {});
  EXPECT_EQ(r.mode, 3);
  std::size_t interpolated = 0;
  for (std::size_t i = 0; i < skip.beams(); ++i) {
    const std::size_t column = i % 32;
    const bool cast = column % 4 == 0 || column == 31;
    EXPECT_EQ(r.quality[i] == base::QualityFlag::not_cast, !cast);
    if (cast) {
      EXPECT_EQ(skip.at(i, 0), exact.at(i, 0));
    }
    const std::size_t before = i - column % 4, after = std::min(before + 4, i - column + 31);
    if (cast || exact.hits[before] != exact.hits[after] || exact.hits[i] != exact.hits[before]) continue;
    EXPECT_NEAR(skip.at(i, 0), exact.at(i, 0), i / 32 == 1 ? 1e-9 : 2e-3 * exact.at(i, 0));
    ++interpolated;
  }
  EXPECT_GT(interpolated, 50u);
}

/// A full turn, rolling and with parts: every beam has a number, and no table is shorter than another.
TEST(LidarModes, SkipWithEverythingElse) {
  const Read r =
      echoes_of(boards("channels 2 columns 9 rolling 1 divergence 0.5 beam_parts 3 returns 2 accuracy \"skip2\""));
  EXPECT_EQ(r.beams(), 18u);
  EXPECT_EQ(r.width, 5u);
  for (std::size_t i = 0; i < r.beams(); ++i) EXPECT_GT(r.at(i, 0), 0.0);
}

// --- Rolling scans

constexpr const char* kRolling = "channels 2 fov_v [-4 4] columns 40 range [0 30] rate 10 ";

/// Drives a robot with a constant twist, and returns a reading and the states of all ticks of 10 ms.
std::pair<std::vector<double>, std::vector<base::Report>> drive(const world::World& world, const base::Twist& twist,
                                                                int ticks) {
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 2});
  farm.subscribe(0, base::only(sensors::kLidar));
  std::vector<double> last;
  std::vector<base::Report> states;
  base::Report state{0, 0, {0.1, 0.2, 0.0, 0.3}, twist};
  for (int tick = 0; tick <= ticks; ++tick) {
    for (const base::ReadingBlock& r : farm.tick(state.time, std::span(&state, 1)))
      last.assign(r.values.begin(), r.values.end());
    states.push_back(state);
    state.X_WM = robots::advance(state.X_WM, twist, 0.01);
    state.time += 10'000'000;
  }
  return {last, states};
}

world::World rolling_world(const std::string& lidar) {
  world::World world = boards(std::string(kRolling) + lidar);
  world.interval = 0.01;
  return world;
}

/// Every beam has the range that the robot would read if it stood where it was at the beam's time.
TEST(LidarRolling, EachBeamIsCastFromThePoseAtItsTime) {
  const world::World rolling = rolling_world("rolling 1"), still = rolling_world("");
  const base::Twist twist{2.0, 0.5, 3.0};
  const auto [values, states] = drive(rolling, twist, 20);
  const sensors::SensorSet sensor_set(rolling);
  const auto& beams = *sensor_set.settings_of<sensors::LidarSettings>(sensors::kLidar)[0].beams;
  ASSERT_EQ(beams.times.size(), values.size());
  EXPECT_EQ(beams.times[39], 0.0);
  EXPECT_NEAR(beams.times[0], -0.1 * 39 / 40, 1e-12);
  farm::Farm farm(still, host_device(), {.noise = false, .threads = 1});
  const auto now_values = farm.sense(0, sensors::kLidar, 0, states.back().X_WM).values;
  std::size_t moved = 0;
  for (std::size_t i = 0; i < values.size(); ++i) moved += std::abs(now_values[i] - values[i]) > 1e-3;
  EXPECT_GT(moved, values.size() / 4);
  for (std::size_t i = 0; i < values.size(); i += 7) {
    const base::Pose then = robots::advance(states.back().X_WM, twist, beams.times[i]);
    EXPECT_NEAR(farm.sense(0, sensors::kLidar, 0, then).values[i], values[i], 1e-6) << i;
  }
}

/// At rest a rolling scan has the bytes of one that is not, from the first reading on.
TEST(LidarRolling, AtRestNothingChanges) {
  for (const int ticks : {0, 20})
    EXPECT_EQ(drive(rolling_world("rolling 1"), {}, ticks).first, drive(rolling_world(""), {}, ticks).first);
}

/// A relocation ends the motion: no beam is cast between the two places.
TEST(LidarRolling, NotAcrossARelocation) {
  const world::World world = rolling_world("rolling 1");
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 1});
  farm.subscribe(0, base::only(sensors::kLidar));
  base::Report state{0, 0, {-20.0, 7.0, 0.0, 0.0}, {}};
  std::vector<double> last;
  for (int tick = 0; tick <= 10; ++tick, state.time += 10'000'000) {
    if (tick == 6) state.X_WM = {1.0, 0.0, 0.0, 0.0};
    for (const base::ReadingBlock& r : farm.tick(state.time, std::span(&state, 1)))
      last.assign(r.values.begin(), r.values.end());
  }
  const auto there = farm.sense(0, sensors::kLidar, 0, state.X_WM).values;
  EXPECT_TRUE(std::ranges::equal(last, there));
}

/// Results do not depend on the number of threads.
TEST(LidarRolling, AnyNumberOfThreads) {
  const world::World world = rolling_world("rolling 1 intensity 1 divergence 0.5 beam_parts 3");
  std::vector<std::uint64_t> hashes;
  for (const std::uint32_t threads : {1u, 3u}) {
    farm::Farm farm(world, host_device(), {.threads = threads});
    farm.subscribe(0, base::only(sensors::kLidar));
    base::Report state{0, 0, {}, {1.0, 0.0, 2.0}};
    for (int tick = 0; tick <= 30; ++tick, state.time += 10'000'000) {
      farm.tick(state.time, std::span(&state, 1));
      state.X_WM = robots::advance(state.X_WM, state.velocity, 0.01);
    }
    hashes.push_back(farm.hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// --- Tables of directions

/// Livox's heading, with zenith angles from above; CRLF and blanks.
TEST(BeamTable, ReadsBothHeadings) {
  const world::BeamTable table =
      world::parse_beam_table("t.csv", "Time/s,Azimuth/deg,Zenith/deg\r\n0,90, 80\r\n0.5,-10,100\r\n");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_TRUE(table.timed);
  EXPECT_NEAR(table.rows[0].elevation, 10 * kDegree, 1e-12);
  EXPECT_NEAR(table.rows[1].azimuth, -10 * kDegree, 1e-12);
  EXPECT_EQ(table.duration(), 0.5);
  EXPECT_FALSE(world::parse_beam_table("t.csv", "elevation_deg,azimuth_deg\n1,2").timed);
}

TEST(BeamTable, SaysWhatIsWrong) {
  const auto refused = [](const std::string& text) {
    return refusal_of([&] { world::parse_beam_table("t.csv", text); });
  };
  const std::string heading = "azimuth_deg,elevation_deg,time_s\n";
  expect_in("t.csv:1: the columns are 'x,y'; expected azimuth_deg", refused("x,y\n1,2\n"));
  expect_in("expected azimuth_deg and either", refused("azimuth_deg,elevation_deg,zenith_deg\n1,2,3\n"));  // which one?
  expect_in("t.csv:3: 'a' in field 2; expected a number from -90 to 90", refused(heading + "1,2,3\n1,a,3\n"));
  expect_in("t.csv:2: has 2 fields; expected 3", refused(heading + "1,2\n"));
  expect_in("'nan'", refused(heading + "nan,2,3\n"));
  expect_in("'91' in field 2", refused(heading + "1,91,3\n"));
  expect_in("'-1' in field 3", refused(heading + "1,2,-1\n"));
  expect_in("has no beams", refused(heading));
  expect_in("has no beams", refused("\n\n"));
}

/// The scan has the table's beams in its order, and rolls by its times.
TEST(BeamTable, IsAPattern) {
  const std::string path = testing::TempDir() + "beams.csv";
  std::ofstream(path) << "azimuth_deg,elevation_deg,time_s\n0,0,0\n10,5,0.02\n-20,1,0.1\n";
  const world::World world = world_of("position( lidar( directions \"" + path + "\" rolling 1 ) )");
  const sensors::SensorSet sensor_set(world);
  const auto& beams = *sensor_set.settings_of<sensors::LidarSettings>(sensors::kLidar)[0].beams;
  ASSERT_EQ(beams.directions.size(), 3u);
  EXPECT_NEAR(std::asin(beams.directions[1].z) / kDegree, 5.0, 1e-9);
  EXPECT_EQ(beams.times, (std::vector<double>{-0.1, -0.08, 0.0}));
}

// --- Refusals and packets

TEST(LidarEchoes, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& lidar) {
    return refusal_of([&] {
      const world::World world = world_of("position( \nlidar( " + lidar + " ) )");
      const sensors::SensorSet sensor_set(world);
    });
  };
  expect_in("trial.world:2: a beam without a width", refused("returns 2"));
  expect_in("expected 'intensity 1' with it", refused("intensity_range 10"));
  expect_in("expected 'divergence' with it", refused("beam_parts 5"));
  expect_in("'divergence'", refused("divergence 90"));
  expect_in("28800 beams of 64 parts are 1843200; expected at most 1000000", refused("divergence 0.1 beam_parts 64"));
  expect_in("just detected", refused("detects [0 0.1]"));
  expect_in("'dropout'", refused("dropout 1.5"));
  expect_in("'scan_time'", refused("rolling 1 scan_time 0"));
  expect_in("20000 different times; expected at most 10000", refused("channels 1 columns 20000 rolling 1"));
  expect_in("trial.world:2: no such file: 'none.csv'", refused("directions \"none.csv\""));
  const std::string path = testing::TempDir() + "one_beam.csv";
  std::ofstream(path) << "azimuth_deg,elevation_deg\n0,0\n";
  expect_in("'channels' and 'directions'", refused("directions \"" + path + "\" channels 3"));
  expect_in("'preset' and 'directions'", refused("preset \"OS1-64\" directions \"" + path + "\""));
  expect_in("the world has no table ''; expected the name of a CSV file", refused("directions 3"));
  expect_in("'reflectance' is -1", refusal_of([] { world_of("model( reflectance -1 )"); }));
}

/// Packets carry all numbers of each beam in turn, within half a step.
TEST(LidarEchoes, Packets) {
  const world::World world =
      boards("channels 8 fov_v [-20 10] columns 60 divergence 1 beam_parts 5 returns 2 range [0 80]");
  const Read r = echoes_of(world);
  const sensors::SensorSpec spec = sensors::SensorSet(world).of(sensors::kLidar, 0)[0];
  const sensors::SensorType& type = sensors::lidar_type;
  const base::ReadingBlock block{.type = sensors::kLidar, .values = r.values};
  std::vector<double> received(r.values.size());
  EXPECT_EQ(type.parts(spec, sensors::WireFormat::farm), 6u);  // of 88 beams
  for (std::uint32_t part = 0; part < 6; ++part) {
    base::Bytes bytes;
    const std::uint8_t id = type.encode(spec, block, sensors::WireFormat::farm, part, bytes);
    ASSERT_EQ(type.decode(spec, bytes, id, sensors::WireFormat::farm).fault, sensors::PayloadError::none);
    EXPECT_EQ(type.decode({.elements = 0}, bytes, id, sensors::WireFormat::farm).elements, part < 5 ? 88u : 40u);
    type.read(spec, bytes, id, sensors::WireFormat::farm, received);
    for (std::size_t size = 0; size < bytes.size(); size += 5)
      EXPECT_NE(type.decode(spec, std::span(bytes).first(size), id, sensors::WireFormat::farm).fault,
                sensors::PayloadError::none);
    bytes[14] = 3;  // four numbers per beam do not exist
    EXPECT_EQ(type.decode(spec, bytes, id, sensors::WireFormat::farm).fault, sensors::PayloadError::out_of_range);
  }
  const double steps[] = {1e-4, 1e-3, 1e-4, 1e-4, 1e-3};
  for (std::size_t i = 0; i < received.size(); ++i) EXPECT_NEAR(received[i], r.values[i], 0.501 * steps[i % 5]) << i;
  EXPECT_LE(type.wire_error(spec, block), 1e-4);
}

/// Decoding accepts or refuses any bytes without reading beyond them.
RC_GTEST_PROP(LidarEchoes, AnyPayloadIsDecodedOrRefused, (const base::Bytes& bytes)) {
  sensors::LidarPart part;
  if (sensors::read_lidar(bytes, true, part) == sensors::PayloadError::none)
    RC_ASSERT(part.values.size() == std::size_t{part.count} * part.width);
}

}  // namespace
}  // namespace sf::trial
