// Satellite positioning: visibility, dilution of precision, and loss of fix.

#include "sensors/gps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/files.h"
#include "sensors/gnss_visibility.h"
#include "tests/sensors/host_trial.h"
#include "tests/sensors/statistics.h"

namespace sf::trial {
namespace {

using sensors::constellation;
using sensors::dilution;
using sensors::GnssVisibility;
using sensors::Satellite;

constexpr std::uint64_t kAll = 0xFF;

/// Due east, 45 degrees up.
constexpr Satellite kEast{{1, 0}, 1.0};

bool is_visible(const world::World& world, glm::dvec2 p, double z, const Satellite& satellite) {
  return GnssVisibility(world).is_visible(p, z, satellite);
}

// --- The constellation.

/// Azimuths and elevations listed in docs/sensors.md.
TEST(Gps, SatellitePositionsMatchTheDocument) {
  const std::string text = base::read_text(SF_SOURCE_DIR "/docs/sensors.md"), phrase = "that is i · ";
  ASSERT_NE(text.find(phrase), std::string::npos);
  const double degrees = std::strtod(text.c_str() + text.find(phrase) + phrase.size(), nullptr);
  const double lowest = std::sin(15.0 * M_PI / 180.0);
  for (const std::uint32_t count : {4u, 8u, 64u})
    for (std::uint32_t i = 0; i < count; ++i) {
      const Satellite satellite = constellation(count)[i];
      const double turned = std::atan2(satellite.horizontal.y, satellite.horizontal.x) - i * degrees * M_PI / 180.0;
      EXPECT_NEAR(std::remainder(turned, 2.0 * M_PI), 0.0, 1e-3) << i << ": 0.0005 degrees a satellite";
      EXPECT_NEAR(glm::length(satellite.horizontal), 1.0, 1e-12);
      EXPECT_NEAR(std::sin(std::atan(satellite.tan_elevation)), lowest + (1.0 - lowest) * (i + 0.5) / count, 1e-12);
    }
}

/// Inverse of the normal matrix by Gauss-Jordan elimination, in long double.
std::array<std::array<long double, 4>, 4> covariance(const std::vector<Satellite>& satellites, std::uint64_t seen) {
  long double m[4][8]{};
  for (std::size_t i = 0; i < satellites.size(); ++i) {
    if ((seen >> i & 1) == 0) continue;
    const long double elevation = std::atan(static_cast<long double>(satellites[i].tan_elevation));
    const long double row[] = {satellites[i].horizontal.x * std::cos(elevation),
                               satellites[i].horizontal.y * std::cos(elevation), std::sin(elevation), 1};
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) m[r][c] += row[r] * row[c];
  }
  for (int r = 0; r < 4; ++r) m[r][4 + r] = 1;
  for (int p = 0; p < 4; ++p) {
    int best = p;
    for (int r = p; r < 4; ++r)
      if (std::abs(m[r][p]) > std::abs(m[best][p])) best = r;
    std::swap(m[p], m[best]);
    const long double pivot = m[p][p];
    for (int c = 0; c < 8; ++c) m[p][c] /= pivot;
    for (int r = 0; r < 4; ++r) {
      const long double factor = m[r][p];
      for (int c = 0; c < 8 && r != p; ++c) m[r][c] -= factor * m[p][c];
    }
  }
  std::array<std::array<long double, 4>, 4> q{};
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c) q[r][c] = m[r][4 + c];
  return q;
}

TEST(Gps, DilutionIsTheInverseOfTheGeometry) {
  Chance chance(1);
  const auto all = constellation(16);
  for (int i = 0; i < 300; ++i) {
    const std::uint64_t seen = chance.below(1u << 16);
    const auto d = dilution(all, seen);
    ASSERT_EQ(d.has_value(), std::popcount(seen) >= 4) << seen;
    if (!d) continue;
    const auto q = covariance(all, seen);
    const double scale = static_cast<double>(q[0][0] + q[1][1]);
    EXPECT_NEAR(d->hdop * d->hdop, scale, 1e-9 * scale);
    EXPECT_NEAR(d->xx * d->xx, static_cast<double>(q[0][0]), 1e-9 * scale);
    EXPECT_NEAR(d->xx * d->yx, static_cast<double>(q[0][1]), 1e-9 * scale);
    EXPECT_NEAR(d->yx * d->yx + d->yy * d->yy, static_cast<double>(q[1][1]), 1e-9 * scale);
    const double high = static_cast<double>(q[2][2]);
    EXPECT_NEAR(d->vdop * d->vdop, high, 1e-9 * (scale + high));
    for (std::size_t k = 0; k < 2; ++k)  // cov(z, x) and cov(z, y) from those of x and y
      EXPECT_NEAR(d->zx * static_cast<double>(q[0][k]) + d->zy * static_cast<double>(q[1][k]),
                  static_cast<double>(q[2][k]), 1e-9 * (scale + high));
  }
}

TEST(Gps, NoFixWithFewSatellitesOrAllOnOneCone) {
  const auto all = constellation(8);
  EXPECT_FALSE(dilution(all, 0));
  EXPECT_FALSE(dilution(all, 0b111)) << "three";
  EXPECT_TRUE(dilution(all, 0b1111)) << "four";
  std::vector<Satellite> cone;
  for (int i = 0; i < 6; ++i) cone.push_back({base::rotate(i, {1, 0}), 0.7});
  EXPECT_FALSE(dilution(cone, 0b111111)) << "height and clock are one unknown";
}

// --- Obstacles.

TEST(Gps, WallBlocksLinesWithinItsHeights) {
  world::World world;
  const auto wall = [&](double x, double z_min, double z_max) {
    world.walls = {{.a = {x, -1}, .b = {x, 1}, .z_min = z_min, .z_max = z_max, .solid_left = false}};
  };
  EXPECT_TRUE(is_visible(world, {0, 0}, 0, kEast)) << "no walls";
  wall(1, 0, 2);
  EXPECT_FALSE(is_visible(world, {0, 0}, 0, kEast));
  EXPECT_TRUE(is_visible(world, {2, 0}, 0, kEast)) << "behind";
  EXPECT_TRUE(is_visible(world, {0, 2}, 0, kEast)) << "past its end";
  EXPECT_FALSE(is_visible(world, {0, 1}, 0, kEast)) << "its very end";
  EXPECT_TRUE(is_visible(world, {0, 0}, 1.5, kEast)) << "the antenna is high enough";
  EXPECT_TRUE(is_visible(world, {0, 0}, 1.0, kEast)) << "just over the top";
  EXPECT_TRUE(is_visible(world, {-1.5, 0}, 0, kEast)) << "far enough";
  wall(1, 1.0, 2);
  EXPECT_FALSE(is_visible(world, {0, 0}, 0, kEast)) << "at its foot";
  wall(1, 1.01, 2);
  EXPECT_TRUE(is_visible(world, {0, 0}, 0, kEast)) << "below its foot: it hangs";
  wall(1, 0, 1);
  EXPECT_TRUE(is_visible(world, {0, 0}, 0, kEast)) << "its top is open";
  world.walls = {{.a = {1, 0}, .b = {2, 0}, .z_min = 0, .z_max = 9, .solid_left = false}};
  EXPECT_TRUE(is_visible(world, {0, 0}, 0, kEast)) << "edge on";
}

TEST(Gps, SegmentWithoutEchoOrCollisionBlocksNothing) {
  world::World world;
  world.walls = {{.a = {1, -1}, .b = {1, 1}, .z_min = 0, .z_max = 9}};
  world.walls[0].seen_by_laser = false;
  EXPECT_FALSE(is_visible(world, {0, 0}, 0, kEast));
  world.walls[0].stops_robots = false;
  EXPECT_TRUE(is_visible(world, {0, 0}, 0, kEast));
}

TEST(Gps, DeckBlocksLinesToItsUnderside) {
  world::World world;
  add_solid(world, square({0, 0}, 4), 1.0, 1.1);
  EXPECT_FALSE(is_visible(world, {0, 0}, 0, kEast)) << "under its middle";
  EXPECT_FALSE(is_visible(world, {0.99, 0}, 0, kEast)) << "the line meets it at x = 1.99";
  EXPECT_TRUE(is_visible(world, {1.01, 0}, 0, kEast)) << "it is through before";
  EXPECT_FALSE(is_visible(world, {-2.99, 0}, 0, kEast)) << "from outside, in under the edge";
  EXPECT_FALSE(is_visible(world, {-3.05, 0}, 0, kEast)) << "its side";
  EXPECT_TRUE(is_visible(world, {-3.2, 0}, 0, kEast)) << "over it";
  EXPECT_TRUE(is_visible(world, {0, 0}, 1.2, kEast)) << "on top of it";
}

TEST(Gps, DecksWithHolesAndOverlaps) {
  world::World world;
  add_solid(world, square({0, 0}, 4), 1.0, 1.1);
  // A hole around (0.5, 0), clockwise, of the same model.
  const auto ring = square({0.5, 0}, 0.6);
  for (std::size_t i = 4; i > 0; --i)
    world.walls.push_back({.a = ring[i % 4], .b = ring[i - 1], .z_min = 1.0, .z_max = 1.1});
  EXPECT_TRUE(is_visible(world, {-0.55, 0}, 0, kEast)) << "through the hole";
  EXPECT_FALSE(is_visible(world, {-0.25, 0}, 0, kEast)) << "in, but against its side";
  EXPECT_FALSE(is_visible(world, {0, 0}, 0, kEast));
  world::World twice;
  add_solid(twice, square({0, 0}, 4), 1.0, 1.1);
  for (world::Segment wall : std::vector(twice.walls)) {
    wall.a.x += 1;
    wall.b.x += 1;
    twice.walls.push_back(wall);
  }
  EXPECT_FALSE(is_visible(twice, {0.5, 0}, 0, kEast)) << "where both parts lie";
}

/// Compares random boxes, some of them overhead, with small steps along the line of sight.
TEST(Gps, VisibilityMatchesStepsAlongTheLine) {
  Chance chance(2);
  const auto satellites = constellation(8);
  std::size_t blocked = 0, clear = 0, differ = 0;
  for (int round = 0; round < 20; ++round) {
    world::World world;
    struct Solid {
      glm::dvec2 middle;
      double half, z_min, z_max;
    };
    std::vector<Solid> solids;
    for (int i = 0; i < 25; ++i) {
      const double foot = i % 3 == 0 ? chance.between(0.5, 2.0) : 0.0;
      solids.push_back({chance.in_square(6), chance.between(0.1, 0.8), foot, foot + chance.between(0.1, 2.0)});
      add_solid(world, square(solids.back().middle, 2 * solids.back().half), foot, solids.back().z_max);
    }
    const GnssVisibility sky(world);
    for (int i = 0; i < 40; ++i) {
      const glm::dvec2 p = chance.in_square(6);
      const auto inside = [&](glm::dvec2 q, double z) {
        return std::any_of(solids.begin(), solids.end(), [&](const Solid& s) {
          return std::max(std::abs(q.x - s.middle.x), std::abs(q.y - s.middle.y)) < s.half && z >= s.z_min &&
                 z < s.z_max;
        });
      };
      if (inside(p, 0.2)) continue;
      for (const Satellite& s : satellites) {
        bool met = false;
        for (double way = 0; 0.2 + way * s.tan_elevation < 4.1 && !met; way += 2e-3)
          met = inside(p + way * s.horizontal, 0.2 + way * s.tan_elevation);
        (met ? blocked : clear) += 1;
        differ += sky.is_visible(p, 0.2, s) == met;
      }
    }
  }
  EXPECT_GT(blocked, 1000u);
  EXPECT_GT(clear, 1000u);
  EXPECT_LE(differ, (blocked + clear) / 500) << "except corners cut by less than a step";
}

// --- Readings.

TEST(Gps, ReadsTheAntennaPositionInTheOpen) {
  world::Sensor sensor = fitted("gps");
  sensor.X_MS = {0.5, 0, 0.1, 0};
  const std::vector<double> r = read_once(carriers(sensor, {{10, 20, 0, M_PI / 2}}));
  ASSERT_EQ(r.size(), 4u);
  EXPECT_NEAR(r[0], 10.0, 1e-12);
  EXPECT_NEAR(r[1], 20.5, 1e-12);
  EXPECT_NEAR(r[2], dilution(constellation(8), kAll)->hdop, 1e-12);
  EXPECT_EQ(r[3], 8.0);
}

TEST(Gps, NoFixUnderABridge) {
  world::World world = carriers(fitted("gps"), {{0, 0, 0, 0}, {50, 0, 0, 0}});
  add_solid(world, square({0, 0}, 10), 1.0, 1.2);
  const Glance run(world);
  const auto lost = values_of(run.readings[0]), fixed = values_of(run.readings[1]);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(std::isnan(lost[k])) << k;
  EXPECT_LT(lost[3], 4.0);
  EXPECT_EQ(fixed[3], 8.0);
  EXPECT_EQ(fixed[0], 50.0);
}

/// A robot on the deck sees the sky, and loses it under the deck.
TEST(Gps, OnlyRobotsBelowABridgeLoseTheirFix) {
  world::World world = carriers(fitted("gps"), {{0, 0, 0, 0}});
  add_solid(world, square({0, 0}, 10), 1.0, 1.2);
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::int64_t now = 0;
  const auto satellites = [&](double z) {
    const base::Report report{0, now += 1'000'000'000, {0, 0, z, 0}, {}};
    return farm.tick(now, {&report, 1})[0].values[3];
  };
  EXPECT_LT(satellites(0.0), 4.0);
  EXPECT_EQ(satellites(1.2), 8.0);
  EXPECT_LT(satellites(0.5), 4.0);
}

/// In a street between tall walls, only satellites along it are visible, and errors across it grow.
TEST(Gps, ErrorsGrowInAStreet) {
  world::World world = carriers(fitted("gps", {setting("satellites", {32})}), {{0, 0, 0, 0}, {0, 500, 0, 0}});
  add_solid(world, {{-50, 1}, {50, 1}, {50, 2}, {-50, 2}}, 0, 3);
  add_solid(world, {{-50, -2}, {50, -2}, {50, -1}, {-50, -1}}, 0, 3);
  const Glance run(world);
  EXPECT_LT(run.readings[0].values[3], 20.0);
  EXPECT_GE(run.readings[0].values[3], 4.0);
  EXPECT_GT(run.readings[0].values[2], 1.5 * run.readings[1].values[2]);
}

TEST(Gps, DefaultRateIsOneHertz) {
  const auto rate = [](std::vector<world::Setting> settings) {
    const sensors::SensorSet sensor_set(carriers(fitted("gps", std::move(settings))));
    return sensor_set.of(sensors::kGps, 0)[0].rate;
  };
  EXPECT_EQ(rate({}), 1.0);
  EXPECT_EQ(rate({setting("rate", {5})}), 5.0);
  EXPECT_EQ(rate({setting("update_interval", {100})}), 10.0);
}

/// Errors are normal, with the covariance of the visible satellites, independent per reading.
TEST(Gps, ErrorsAreNoiseTimesTheDilution) {
  std::vector<base::Pose> poses;
  for (int i = 0; i < 100; ++i) poses.push_back({0.0, 0.0, 0.0, 0.0});
  world::World world = carriers(fitted("gps", {setting("noise", {2.0}), setting("rate", {10})}), poses);
  add_solid(world, {{-50, 1}, {50, 1}, {50, 2}, {-50, 2}}, 0, 2);  // on one side: anisotropic errors
  farm::Farm farm(world, device(), {.seed = 12});
  farm.subscribe_all();
  std::vector<double> n, m;
  double squares = 0.0, hdop = 0.0;
  std::uint64_t seen = 0;
  const auto all = constellation(8);
  for (std::size_t i = 0; i < 8; ++i) seen |= std::uint64_t{is_visible(world, {0, 0}, 0, all[i])} << i;
  ASSERT_LT(std::popcount(seen), 8);
  const auto d = dilution(all, seen);
  ASSERT_TRUE(d);
  for (int tick = 0; tick < 20; ++tick)
    for (const auto& r : farm.tick(tick * 100'000'000ll, {})) {
      n.push_back(r.values[0] / (2.0 * d->xx));
      m.push_back((r.values[1] / 2.0 - d->yx * n.back()) / d->yy);
      squares += r.values[0] * r.values[0] + r.values[1] * r.values[1];
      hdop = r.values[2];
    }
  ASSERT_EQ(n.size(), 2000u);
  const double some = 4.0 / std::sqrt(2000.0);
  EXPECT_LT(ks(n), 1.95);
  EXPECT_LT(ks(m), 1.95);
  EXPECT_LT(std::abs(correlation(n, m)), some);
  for (const std::size_t lag : {1u, 100u}) EXPECT_LT(std::abs(correlation(n, n, lag)), some) << lag;
  EXPECT_NEAR(std::sqrt(squares / 2000.0), 2.0 * hdop, 0.1 * hdop) << "root of the mean square distance";
}

/// The altitude is that of the antenna, which leans with its robot, with an error of its own.
TEST(Gps, MeasuresTheAltitudeIfAsked) {
  world::World world = carriers(fitted("gps", {setting("altitude", {1}), setting("noise", {2.0})}), {{1, 2, 3, 0}});
  scenes::add_carrier(world, {}, fitted("gps"));
  world.movers[0].sensors[0].X_MS = {0.5, 0.0, 0.0, 0.0};
  farm::Farm farm(world, device(), {.seed = 5});
  farm.subscribe_all();
  std::vector<double> errors;
  double vdop = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const auto readings = farm.tick(k * 1'000'000'000ll, {});
    ASSERT_EQ(readings[0].values.size(), 6u);
    vdop = readings[0].values[5];
    errors.push_back((readings[0].values[4] - 3.0) / (2.0 * vdop));
    EXPECT_TRUE(std::isnan(readings[1].values[4]) && std::isnan(readings[1].values[5])) << "not asked";
    EXPECT_GT(vdop, readings[0].values[2]) << "altitudes are worse than positions";
  }
  EXPECT_LT(ks(errors), 1.95);

  farm::Farm exact(world, device(), {.noise = false});
  const auto up = exact.sense(0, sensors::kGps, 0, {1, 2, 3, 0}, {0.0, -M_PI / 2}).values;
  EXPECT_NEAR(up[0], 1.0, 1e-12);
  EXPECT_NEAR(up[4], 3.5, 1e-12) << "half a metre ahead of a robot that looks up";
}

TEST(Gps, IsTheSameForAnyNumberOfThreads) {
  std::vector<base::Pose> poses;
  for (int i = 0; i < 300; ++i) poses.push_back({0.1 * i, 0, 0, 0});
  world::World world = carriers(fitted("gps", {setting("noise", {1})}), poses);
  add_solid(world, square({15, 0}, 10), 1.0, 1.2);
  const Glance one(world, {.threads = 1}), two(world, {.threads = 2});
  EXPECT_EQ(one.farm.hash(), two.farm.hash());
  EXPECT_NE(one.farm.hash(), Glance(world, {.seed = 2}).farm.hash());
}

TEST(Gps, RejectsInvalidSettings) {
  expect_refused("gps", {setting("satellites", {3})}, 8, "expected 4 to 64");
  expect_refused("gps", {setting("satellites", {65})}, 8, "expected 4 to 64");
  expect_refused("gps", {setting("rate", {1}), setting("noise", {-1})}, 9, "'noise' is -1");
  expect_refused("gps", {setting("latency", {-1})}, 8, "'latency' is -1");
}

}  // namespace
}  // namespace sf::trial
