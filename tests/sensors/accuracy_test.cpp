// Accuracy modes: choice per sensor, error, and stated bound.

#include "sensors/accuracy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"
#include "sensors/magnetometer_modes.h"
#include "tests/refusal.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/sensors/magnet_scenes.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

using base::QualityFlag;

/// A robot with a laser, a magnetometer and a bumper, each with the given settings.
world::World load(const std::string& of_all, const std::string& laser = "", const std::string& magnetometer = "",
                  const std::string& order = "", const std::string& bumper = "") {
  const auto file = std::filesystem::temp_directory_path() / "sf_accuracy.world";
  std::ofstream(file) << of_all << "\nposition( size [0.3 0.3 0.3]\nlaser( samples 11 " << laser << " )\nmagnetometer( "
                      << magnetometer << " )\nbumper( " << bumper
                      << " ) )\nmodel( pose [0.5 0 0 0] size [0.02 0.02 0.02] magnetic_moment 1 )\n";
  return world::load_world(file.string(), {.accuracy = order, .sensors = sensors::world_file_words()});
}

std::string modes(const world::World& world) { return sensors::modes_of(sensors::SensorSet(world)); }

std::string refusal(const world::World& world) {
  return refusal_of([&] { sensors::SensorSet sensor_set(world); });
}

TEST(Accuracy, IsExactByDefault) { EXPECT_EQ(modes(load("")), "exact"); }

TEST(Accuracy, WorldWordAppliesToTypesThatHaveIt) {
  EXPECT_EQ(modes(load("accuracy \"skip2\"")), "laser:skip2");
  EXPECT_EQ(modes(load("accuracy \"near3\"")), "magnetometer:near3");
  EXPECT_EQ(modes(load("accuracy \"near3 single\"")), "laser:single magnetometer:near3");
  EXPECT_EQ(modes(load("accuracy \"laser:skip4\"")), "laser:skip4");
}

TEST(Accuracy, SensorWordOverridesWorldWord) {
  EXPECT_EQ(modes(load("accuracy \"skip2\"", "accuracy \"single\"")), "laser:single");
  EXPECT_EQ(modes(load("accuracy \"skip2\"", "accuracy \"exact\"")), "exact");
  EXPECT_EQ(modes(load("", "", "accuracy \"near1\"")), "magnetometer:near1");
}

TEST(Accuracy, CommandLineOverridesBoth) {
  EXPECT_EQ(modes(load("accuracy \"skip2\"", "accuracy \"single\"", "accuracy \"near1\"", "skip8")), "laser:skip8");
  EXPECT_EQ(modes(load("accuracy \"skip2\"", "", "", "exact")), "exact");
}

TEST(Accuracy, RejectsUnknownModesWithTheirLine) {
  expect_in("sf_accuracy.world:2: there is no accuracy \"skip3\"; expected one of \"exact\", \"single\"",
            refusal(load("\naccuracy \"skip3\"")));
  expect_in(":3: 'accuracy' is \"near3\"; this sensor supports \"exact\", \"single\"",
            refusal(load("", "accuracy \"near3\"")));
  expect_in("there is no accuracy \"nonsense\"", refusal(load("", "", "", "nonsense")));
  EXPECT_THROW(load("accuracy 3"), base::InputError) << "a word, not a number";
  expect_in("expects a word", refusal(load("", "", "accuracy 3")));
}

TEST(Accuracy, TypesWithoutModesAreExact) {
  EXPECT_EQ(modes(load("", "", "", "", "accuracy \"exact\"")), "exact");
  expect_in(":5: 'accuracy' is \"skip2\"; this sensor supports \"exact\"",
            refusal(load("", "", "", "", "accuracy \"skip2\"")));
}

TEST(Accuracy, RejectsWordsOfAbsentTypes) {
  world::World world = scenes::boxes(5, 8.0, 1);
  scenes::add_robots(world, 1, scenes::laser(11), 1);
  sensors::set_accuracy(world, "near3");
  expect_in("is for magnetometer, and the world has no such sensor", refusal(world));
  sensors::set_accuracy(world, "magnetometer:near3 single");
  EXPECT_NE(refusal(world), "") << "one of several too";
}

TEST(Accuracy, ChangesTheWorldsHashAndSurvivesASnapshot) {
  const world::World exact = load("");
  const world::World coarse = load("accuracy \"skip2\"", "", "accuracy \"near1\"");
  EXPECT_NE(exact.hash, coarse.hash);
  const world::World again = world::from_snapshot(world::snapshot(coarse));
  EXPECT_EQ(modes(again), "laser:skip2 magnetometer:near1");
  EXPECT_EQ(load("", "accuracy \"single\"").hash, load("", "accuracy \"single\"").hash);
  EXPECT_NE(load("", "accuracy \"single\"").hash, exact.hash);
}

// --- Lasers.

/// Readings of all lasers of a world in a mode, robots at their poses at load.
struct Read {
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  std::vector<QualityFlag> quality;
  double bound = 0.0;
  std::uint8_t mode = 0;
};

Read read_in(world::World world, const std::string& mode) {
  sensors::set_accuracy(world, mode);
  const Glance glance(world, {.noise = false});
  Read read;
  for (const base::ReadingBlock& r : glance.readings) {
    read.values.insert(read.values.end(), r.values.begin(), r.values.end());
    read.hits.insert(read.hits.end(), r.hits.begin(), r.hits.end());
    const std::size_t columns = r.quality.empty() ? 1 : r.values.size() / r.quality.size();
    for (std::size_t i = 0; i < r.values.size(); ++i)
      read.quality.push_back(r.quality.empty() ? QualityFlag::none : r.quality[i / columns]);
    read.bound = std::max(read.bound, r.bound);
    read.mode = r.mode;
  }
  return read;
}

world::World crowd(std::uint32_t samples, double fov = M_PI) {
  world::World world = scenes::boxes(60, 16.0, 1);
  scenes::add_robots(world, 20, scenes::laser(samples, fov, 8.0), 1);
  world::update_extent_and_hash(world);
  return world;
}

/// Samples cast: every n-th from the first, and the last one.
TEST(Accuracy, SkipModesCastBitIdenticalBeams) {
  for (const std::uint32_t samples : {361u, 360u, 3u, 2u, 1u})
    for (const auto& [mode, skip] : {std::pair{"skip2", 2u}, std::pair{"skip4", 4u}, std::pair{"skip8", 8u}}) {
      const Read exact = read_in(crowd(samples), "exact"), some = read_in(crowd(samples), mode);
      const std::uint32_t every = std::min(skip, std::max(1u, samples - 1));
      for (std::size_t i = 0; i < exact.values.size(); ++i) {
        const auto sample = static_cast<std::uint32_t>(i % samples);
        const bool cast = sample % every == 0 || sample == samples - 1;
        ASSERT_EQ(some.quality[i] == QualityFlag::not_cast, !cast)
            << mode << ", sample " << sample << " of " << samples;
        if (!cast) continue;
        ASSERT_EQ(some.values[i], exact.values[i]);
        ASSERT_EQ(some.hits[i], exact.hits[i]);
      }
      EXPECT_EQ(some.bound, exact.bound) << "that of the beams that are cast";
    }
}

/// In an empty square room, interpolated samples between two hits on one wall lie on it.
TEST(Accuracy, SkipModesAreExactOnFlatWalls) {
  world::World world;
  scenes::add_room(world, {0.0, 0.0}, 4.0);
  scenes::add_robot(world, {0.3, -0.7, 0.0, 0.4}, scenes::laser(361, 2.0 * M_PI, 8.0));
  world::update_extent_and_hash(world);
  const Read exact = read_in(world, "exact"), some = read_in(world, "skip4");
  std::size_t near_corners = 0;
  for (std::size_t i = 0; i < exact.values.size(); ++i) {
    const double error = std::abs(some.values[i] - exact.values[i]);
    near_corners += error > 1e-12 ? 1 : 0;
    EXPECT_LT(error, 0.12) << "a chord of 4 degrees at 3.3 m is 0.23 m long, and cuts a corner by half of that";
  }
  EXPECT_LE(near_corners, 4u * 3u) << "four corners, three beams between two that are cast";
}

TEST(Accuracy, UsesTheNearerBeamBetweenTwoSurfaces) {
  world::World world;
  scenes::add_room(world, {0.0, 0.0}, 8.0);
  scenes::add_outline(world, {{1.0, 0.02}, {1.2, 0.02}, {1.2, 1.0}, {1.0, 1.0}}, "box");
  scenes::add_robot(world, {0.0, 0.0, 0.0, 0.0}, scenes::laser(5, 0.08, 9.0));  // bearings -0.04, -0.02, 0, 0.02, 0.04
  world::update_extent_and_hash(world);
  const Read some = read_in(world, "skip4");
  EXPECT_EQ(some.values[1], some.values[0]);
  EXPECT_EQ(some.values[2], some.values[4]) << "half way: the later one";
  EXPECT_EQ(some.values[3], some.values[4]);
  EXPECT_EQ(some.hits[2], base::kNoHit) << "unknown between two surfaces";
}

TEST(Accuracy, SingleModeKeepsHitsAndRangesWithinTheBound) {
  const Read exact = read_in(crowd(361), "exact"), single = read_in(crowd(361), "single");
  EXPECT_EQ(single.hits, exact.hits);
  EXPECT_NE(single.values, exact.values) << "32 bits were used";
  EXPECT_EQ(single.mode, 1);
  EXPECT_GT(single.bound, exact.bound);
  EXPECT_LT(single.bound, 1.1e-3) << "a millimetre at 8 m";
  for (std::size_t i = 0; i < exact.values.size(); ++i)
    ASSERT_LE(std::abs(single.values[i] - exact.values[i]), single.bound) << i;
}

TEST(Accuracy, ModesInOneWorldAreIndependent) {
  world::World mixed = crowd(61);
  for (std::size_t m = 0; m < mixed.movers.size(); ++m)
    scenes::edit_laser(mixed.movers[m])->accuracy.word = m % 3 == 0 ? "single" : m % 3 == 1 ? "skip2" : "exact";
  const Glance glance(mixed, {.noise = false});
  for (const char* mode : {"exact", "single", "skip2"}) {
    world::World world = crowd(61);
    sensors::set_accuracy(world, mode);
    const Glance alone(world, {.noise = false});
    for (std::size_t m = 0; m < mixed.movers.size(); ++m) {
      if (sensors::lasers_of(mixed.movers[m])[0].accuracy.word != mode) continue;
      EXPECT_TRUE(std::ranges::equal(glance.readings[m].values, alone.readings[m].values)) << mode << ", mover " << m;
    }
  }
}

/// A wall seen at less than a milliradian magnifies rounding errors a thousandfold; the reading is flagged.
TEST(Accuracy, GrazingBeamsAreFlagged) {
  world::World world;
  scenes::add_outline(world, {{0.0, -1.0}, {10.0, -1.0}, {10.0, -1e-4}, {0.0, -1e-4}}, "floor");
  const sensors::LaserSettings laser = eye(5, 8e-4, 8.0);  // bearings -4e-4, -2e-4, 0, 2e-4, 4e-4
  add_eye(world, {0.0, 0.0, 0.0, -0.0}, laser);
  add_eye(world, {0.0, 0.0, 0.0, -0.1}, laser);
  world::update_extent_and_hash(world);
  const Glance glance(world);
  ASSERT_EQ(glance.readings[0].quality.size(), 5u);
  EXPECT_EQ(glance.readings[0].quality[0], QualityFlag::grazing) << "4e-4 rad";
  EXPECT_EQ(glance.readings[0].quality[1], QualityFlag::grazing) << "2e-4 rad, cast in one go with the one before";
  EXPECT_EQ(glance.readings[0].quality[2], QualityFlag::none) << "parallel: it meets nothing";
  EXPECT_EQ(glance.readings[0].quality[3], QualityFlag::none);
  EXPECT_TRUE(glance.readings[1].quality.empty()) << "at 0.1 rad";
}

TEST(Accuracy, BoundsGrowWithTheWorld) {
  const auto stated = [](const world::World& world) {
    return sensors::accuracy_statements(world, sensors::SensorSet(world)).at(0).bound.error;
  };
  world::World near = crowd(61), far = crowd(61);
  world::translate(far, 1e7, 1e7);
  world::update_extent_and_hash(far);
  EXPECT_LT(stated(near), 2e-9);
  EXPECT_GT(stated(far), 1e-6);
  EXPECT_LT(stated(far), 1e-5) << "10 000 km away";
  EXPECT_LE(read_in(near, "exact").bound, stated(near)) << "no reading states more than its world";
  EXPECT_LE(read_in(far, "exact").bound, stated(far));
}

// --- Magnets.

TEST(Accuracy, NearModesStayWithinTheBound) {
  Chance chance(3);
  world::World world;
  for (int i = 0; i < 400; ++i)
    world.magnets.push_back({chance.in_square(15.0), -0.04, chance.between(-1.0, 1.0), 0.01, 0});
  world.models.push_back({.name = "magnets"});
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 p = chance.in_square(15.0);
    const std::uint32_t m = scenes::add_robot(world, {p.x, p.y, 0.0, chance.between(-3.0, 3.0)}, scenes::laser(3));
    scenes::remove_lasers(world.movers[m]);
    world.movers[m].sensors.push_back({"magnetometer", "m", {0.1, 0.0, 0.0, 0.0}, 0.1, 1.0, 1.0, {}, 0, ""});
  }
  world::update_extent_and_hash(world);
  const Read exact = read_in(world, "exact");
  EXPECT_LT(exact.bound, 1e-7) << "moments are kept in 32 bits";
  double last = 0.0;
  for (const char* mode : {"near10", "near3", "near1"}) {
    const Read near = read_in(world, mode);
    double worst = 0.0;
    for (std::size_t i = 0; i < near.values.size(); ++i)
      worst = std::max(worst, std::abs(near.values[i] - exact.values[i]));
    std::printf("[ measured ] %s: worst %.3g T of at most %.3g T\n", mode, worst, near.bound);
    EXPECT_LE(worst, near.bound) << mode;
    EXPECT_GT(worst, last) << "nearer leaves out more";
    last = worst;
  }
}

/// [T] |B| at an element of a robot's array at the given poses, in `long double`.
long double field_at(const world::World& world, const base::Pose& X_WM, const base::Pose& X_ME) {
  using Wide = long double;
  const Wide c = std::cos(static_cast<Wide>(X_WM.yaw)), s = std::sin(static_cast<Wide>(X_WM.yaw));
  Wide sum[3] = {0, 0, 0};
  for (const world::Magnet& m : world.magnets) {
    const Wide x = static_cast<Wide>(X_WM.x) - m.p.x + (c * X_ME.x - s * X_ME.y);
    const Wide y = static_cast<Wide>(X_WM.y) - m.p.y + (s * X_ME.x + c * X_ME.y);
    const Wide z = static_cast<Wide>(X_ME.z) - m.z;
    const Wide r = std::sqrt(x * x + y * y + z * z), near = std::max(r, static_cast<Wide>(m.radius));
    const Wide scale = static_cast<Wide>(sensors::kPermeability) * m.moment / (near * near * near);
    sum[0] += 3 * scale * z / r * x / r, sum[1] += 3 * scale * z / r * y / r, sum[2] += scale * (3 * z / r * z / r - 1);
  }
  return std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

/// Moments that 32 bits cannot represent, elements off the centre, sensors above magnets and within their radius, near
/// the origin and at coordinates where positions are rounded.
TEST(Accuracy, FieldsStayWithinTheirBoundAnywhere) {
  for (const double height : {0.05, 0.012})
    for (const double far : {0.0, 1e5, 1e7}) {
      Chance chance(21);
      world::World world;
      for (int i = 0; i < 20; ++i) {
        const glm::dvec2 p = glm::dvec2{far, -far} + chance.in_square(0.1);
        world.magnets.push_back({p, 0.0, chance.between(-1.0, 1.0), 0.0125, 0});
      }
      for (int i = 0; i < 300; ++i) {
        const glm::dvec2 p = glm::dvec2{far, -far} + chance.in_square(0.15);
        scenes::add_carrier(world, {p.x, p.y, 0.0, chance.between(-3.0, 3.0)},
                            scenes::array({{0.1, 0.0, 0.0, 0.0}, {-0.03, 0.07, 0.0, 0.0}}, height));
      }
      world::update_extent_and_hash(world);
      const Glance glance(world, {.noise = false});
      double worst = 0.0;
      for (const base::ReadingBlock& r : glance.readings)
        for (const std::size_t element : {0u, 1u}) {
          const base::Pose at = element == 0 ? base::Pose{0.1, 0.0, height, 0.0} : base::Pose{-0.03, 0.07, height, 0.0};
          const long double truth = field_at(world, world.movers[r.mover].X_WM, at);
          const double error = std::abs(static_cast<double>(r.values[4 * element] - truth));
          EXPECT_LE(error, r.bound) << far << " m away, mover " << r.mover;
          worst = std::max(worst, error / r.bound);
        }
      EXPECT_GT(worst, 1e-4) << "the bound is not far too large";
      EXPECT_LE(glance.readings[0].bound,
                sensors::accuracy_statements(world, sensors::SensorSet(world)).at(0).bound.error);
    }
}

/// A sensor that may reach a magnet's centre has no bound.
TEST(Accuracy, MagnetAtSensorHeightHasNoBound) {
  world::World world;
  world.magnets.push_back({{0.0, 0.0}, 0.05, 1.0, 0.01, 0});
  scenes::add_carrier(world, {0.3, 0.0, 0.0, 0.0}, scenes::array({{0.0, 0.0, 0.0, 0.0}}, 0.05));
  world::update_extent_and_hash(world);
  EXPECT_TRUE(std::isinf(Glance(world).readings[0].bound));
  EXPECT_TRUE(std::isinf(sensors::accuracy_statements(world, sensors::SensorSet(world)).at(0).bound.error));
}

/// Sensor types without a bound report none.
TEST(Accuracy, TypesWithoutABoundStateNone) {
  world::World world;
  scenes::add_room(world, {0.0, 0.0}, 4.0);
  const std::uint32_t m = scenes::add_robot(world, {}, scenes::laser(3));
  for (const char* type : {"sonar", "infrared", "bumper", "cliff", "encoder", "gyro", "gps", "irreceiver",
                           "lightsensor", "battery", "fiducial", "radar"})
    world.movers[m].sensors.push_back({type, type, {}, 0.1, 1.0, 1.0, {}, 0, ""});
  world::update_extent_and_hash(world);
  const Glance glance(world);
  EXPECT_EQ(glance.readings.size(), 13u);
  for (const base::ReadingBlock& r : glance.readings)
    EXPECT_EQ(std::isinf(r.bound), r.type != sensors::kLaser) << static_cast<int>(r.type);
}

/// One rule for all types: a noisy reading states sigma and the bound without noise, but no bound.
TEST(Accuracy, NoisyReadingsStateNoBound) {
  struct Case {
    const char* type;
    std::vector<std::pair<std::string, std::vector<double>>> settings;
    double sigma, bound_without_noise;
  };
  constexpr double kUnknown = HUGE_VAL;
  const Case cases[] = {
      {"laser", {{"noise", {0.2, 0, 0}}}, 0.2, 1.1e-9},
      {"laser", {{"noise", {0.03, 0.005, 0}}}, std::hypot(0.03, 0.005 * 8.0), 1.1e-9},
      {"laser", {{"noise", {0, 0, 1}}}, kUnknown, 1.1e-9},
      {"magnetometer", {{"noise", {0.01}}}, 1e-6, 1e-9},
      {"sonar", {{"noise", {0.01, 0.02}}}, std::hypot(0.01, 0.02 * 4.0), kUnknown},
      {"infrared", {{"noise", {0.1}}}, kUnknown, kUnknown},
      {"encoder", {{"slip", {0.01}}}, kUnknown, kUnknown},
      {"gyro", {{"noise", {1}}}, M_PI / 180.0, kUnknown},
      {"gyro", {{"noise", {1}}, {"bias", {1}}}, kUnknown, kUnknown},
      {"gps", {{"noise", {1.5}}}, kUnknown, kUnknown},
  };
  for (const Case& c : cases) {
    world::World world;
    scenes::add_room(world, {0.0, 0.0}, 4.0);
    world::Mover& mover = world.movers[scenes::add_robot(world, {}, scenes::laser(3))];
    mover.sensors = {{c.type, c.type, {}, 0.1, 1.0, M_PI / 180.0, {}, 0, ""}};
    for (const auto& [key, numbers] : c.settings) mover.sensors[0].settings.push_back(scenes::setting(key, numbers));
    world::update_extent_and_hash(world);
    const Glance with(world), without(world, {.noise = false});
    const base::ReadingBlock &noisy = with.readings[0], &quiet = without.readings[0];
    EXPECT_TRUE(std::isinf(noisy.bound)) << c.type;
    EXPECT_TRUE(is_unsure(noisy)) << c.type;
    EXPECT_DOUBLE_EQ(noisy.sigma, c.sigma) << c.type;
    EXPECT_LE(noisy.bound_without_noise, c.bound_without_noise) << c.type;
    EXPECT_EQ(noisy.bound_without_noise, quiet.bound) << c.type << ", that of the reading without noise";
    EXPECT_EQ(quiet.sigma, 0.0) << c.type;
    EXPECT_FALSE(is_unsure(quiet)) << c.type;
    const auto statements = sensors::accuracy_statements(world, sensors::SensorSet(world));
    ASSERT_EQ(statements.size(), std::isinf(c.bound_without_noise) ? 0u : 1u) << c.type;
    if (statements.empty()) continue;
    EXPECT_TRUE(std::isinf(statements[0].error())) << c.type << ", before a run";
    EXPECT_GE(statements[0].bound.error, quiet.bound) << c.type;
    EXPECT_EQ(statements[0].sigma, noisy.sigma) << c.type;
  }
}

/// The noise of lane edges affects the fitted line. A reading has its own sigma, and no bound without noise either,
/// because nothing shows whether the edge is straight.
TEST(Accuracy, NoisyLaneEdgesHaveTheirOwnSigma) {
  world::World world;
  world.lane_markings.push_back({{{-10.0, 0.4}, {10.0, 0.4}}, 0.1, 0xFFFFFFFFu});
  add_edge_eye(world, {0.0, 0.0, 0.0, 0.5 * M_PI}, {{"noise", {0.002, 0, 0}}});
  world::update_extent_and_hash(world);
  const Glance glance(world);
  const base::ReadingBlock& reading = glance.readings[0];
  EXPECT_EQ(reading.sigma, reading.values[3]);
  EXPECT_GT(reading.sigma, 1e-5);
  EXPECT_TRUE(std::isinf(reading.bound));
  EXPECT_TRUE(std::isinf(reading.bound_without_noise));
}

/// Boundary: the only beam of a scan grazes. No element has a bound, so the reading states none.
TEST(Accuracy, ReadingWithOnlyFlaggedElementsStatesNoBound) {
  world::World world;
  scenes::add_room(world, {0.0, 0.0}, 4.0);
  scenes::add_robot(world, {0.0, 2.0 - 1e-4, 0.0, 1e-4}, scenes::laser(1));
  world::update_extent_and_hash(world);
  const Glance glance(world);
  const base::ReadingBlock& reading = glance.readings[0];
  ASSERT_EQ(reading.quality.size(), 1u);
  EXPECT_EQ(reading.quality[0], QualityFlag::grazing);
  EXPECT_TRUE(std::isinf(reading.bound));
  EXPECT_TRUE(std::isinf(reading.bound_without_noise));
}

TEST(Accuracy, SmallerCutoffApplies) {
  world::World world;
  world.magnet_cutoff = 2.0;
  EXPECT_EQ(sensors::cutoff_of(world, 0), 2.0);
  EXPECT_EQ(sensors::cutoff_of(world, 1), 2.0);
  EXPECT_EQ(sensors::cutoff_of(world, 3), 1.0);
  world.magnet_cutoff = 0.0;
  EXPECT_EQ(sensors::cutoff_of(world, 0), 0.0);
  EXPECT_EQ(sensors::cutoff_of(world, 1), 10.0);
}

// --- Lane edges.

TEST(Accuracy, FewerRaysFindAStraightEdge) {
  world::World world;
  world.lane_markings.push_back({{{-10.0, 0.4}, {10.0, 0.4}}, 0.1, 0xFFFFFFFFu});
  add_edge_eye(world, {0.0, 0.0, 0.0, 0.5 * M_PI + 0.1});
  world::update_extent_and_hash(world);
  const Read exact = read_in(world, "exact");
  EXPECT_NEAR(exact.bound, 1e-8, 1e-9);
  for (const char* mode : {"skip2", "skip4"}) {
    const Read some = read_in(world, mode);
    EXPECT_NEAR(some.values[0], exact.values[0], 1e-9) << mode;
    EXPECT_LT(some.values[1], exact.values[1]) << "fewer points";
    EXPECT_EQ(some.quality, std::vector<QualityFlag>(4, QualityFlag::not_cast))
        << "rays left out may have met something else";
    EXPECT_TRUE(std::isinf(some.bound)) << mode;
    sensors::set_accuracy(world, mode);
    EXPECT_TRUE(std::isinf(sensors::accuracy_statements(world, sensors::SensorSet(world)).at(0).error())) << mode;
  }
}

}  // namespace
}  // namespace sf::trial
