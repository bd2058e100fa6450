// The magnetometer array as a sensor of the farm: poses and frames, saturation, moving magnets.

#include "sensors/magnetometer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "sensors/magnetic_field/truncation.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::trial {
namespace {

using base::Pose;
using scenes::Element;
using scenes::element;
using scenes::magnet;

constexpr double kHigh = 0.125;  // [m] height of the thesis' sensors above the magnets' centres

/// Adds a robot at `X_WM` with `sensor` over one magnet of 1 A m^2 at (1, 0).
Glance over_one(const Pose& X_WM, const world::Sensor& sensor, world::World& world) {
  world.magnets.push_back(magnet({1, 0}));
  scenes::add_carrier(world, X_WM, sensor);
  return Glance(world);
}

TEST(Magnetometer, ReadsOneGaussStraightAboveAMagnet) {
  world::World world;
  const Glance run = over_one({0.8, 0, 0, 0}, scenes::five(kHigh), world);
  ASSERT_EQ(run.readings.size(), 1u);
  const base::ReadingBlock& r = run.readings[0];
  EXPECT_EQ(r.type, sensors::kMagnetometer);
  ASSERT_EQ(r.values.size(), 20u);
  const Element middle = element(r, 2);
  EXPECT_NEAR(middle.field / sensors::kGauss, 1.024, 1e-6);
  EXPECT_NEAR(middle.z / sensors::kGauss, 1.024, 1e-6);
  EXPECT_NEAR(std::hypot(middle.x, middle.y), 0.0, 1e-17);
}

/// The vector is in the element's frame: rotated back by mover, model and element.
TEST(Magnetometer, VectorsAreInTheElementsOwnFrame) {
  Chance chance(1);
  for (int i = 0; i < 10; ++i) {
    const Pose X_WM{chance.between(0, 2), chance.between(-1, 1), 0.03, chance.between(-4, 4)};
    const Pose X_SE{chance.between(-0.2, 0.2), chance.between(-0.2, 0.2), chance.between(0, 0.1),
                    chance.between(-4, 4)};
    world::Sensor sensor = scenes::array({X_SE}, 0.1);
    sensor.X_MS = {0.05, -0.02, 0.1, chance.between(-4, 4)};
    sensor.height = 0.06;
    world::World world;
    const Glance run = over_one(X_WM, sensor, world);
    const Pose X_WE = base::compose(X_WM, base::compose(sensor.X_MS, X_SE));
    // The origin of a sensor's frame is at half its model's height.
    const scenes::Exact truth = scenes::exact(world, {X_WE.x, X_WE.y, X_WE.z + 0.03});
    const glm::dvec2 flat = base::rotate(-X_WE.yaw, {static_cast<double>(truth.x), static_cast<double>(truth.y)});
    const Element e = element(run.readings[0], 0);
    EXPECT_NEAR(e.x, flat.x, 1e-7 * e.field);
    EXPECT_NEAR(e.y, flat.y, 1e-7 * e.field);
    EXPECT_NEAR(e.z, static_cast<double>(truth.z), 1e-7 * e.field);
    EXPECT_NEAR(e.field, scenes::magnitude(truth), 1e-7 * e.field);
  }
}

/// The thesis' robot faces -y and its array runs along x from its right to its left. The readings equal those of the
/// version that faces +x in a world rotated with it.
TEST(Magnetometer, ThesisMinusYFrameReadsTheSame) {
  std::vector<Pose> thesis, ours;
  for (int i = 0; i < 5; ++i) {
    thesis.push_back({0.075 * (i - 2), 0, 0, -M_PI / 2});
    ours.push_back({0, 0.075 * (i - 2), 0, 0});
  }
  world::Sensor theirs = scenes::array(thesis), own = scenes::array(ours);
  theirs.X_MS = {0, -0.2, 0.1, 0};
  own.X_MS = {0.2, 0, 0.1, 0};
  world::World a = scenes::sheet(50, 1.0, 3, true), b = a;
  scenes::add_carrier(a, {0.1, 0.05, 0, M_PI / 2}, theirs);  // its -y is the world's +x
  scenes::add_carrier(b, {0.1, 0.05, 0, 0}, own);
  const Glance first(a), second(b);
  for (std::size_t e = 0; e < 5; ++e)
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(first.readings[0].values[4 * e + k], second.readings[0].values[4 * e + k],
                  1e-12 * second.readings[0].values[4 * e]);
}

/// 1 to 16 elements: groups of five, filled or not.
TEST(Magnetometer, EveryNumberOfElements) {
  const world::World magnets = scenes::sheet(100, 2.0, 4);
  for (std::uint32_t count = 1; count <= sensors::kMostElements; ++count) {
    world::World world = magnets;
    std::vector<Pose> elements;
    for (std::uint32_t i = 0; i < count; ++i) elements.push_back({0.03 * i, 0.01 * i, 0.0, 0.1 * i});
    scenes::add_carrier(world, {0.1, 0, 0, 0}, scenes::array(elements));
    scenes::add_carrier(world, {-0.3, 0.2, 0, 1}, scenes::array(elements));
    const Glance run(world);
    for (const base::ReadingBlock& r : run.readings) {
      ASSERT_EQ(r.values.size(), 4 * count);
      for (std::uint32_t i = 0; i < count; ++i) {
        const Pose X_WE = base::compose(r.X_WS, elements[i]);
        EXPECT_NEAR(r.values[4 * i], scenes::magnitude(scenes::exact(world, {X_WE.x, X_WE.y, X_WE.z})), 1e-11) << i;
      }
    }
  }
}

// --- The Earth's field.

/// It is added to the magnets' field, in the element's frame; without it, no byte changes.
TEST(Magnetometer, AddsTheEarthsFieldInTheElementsFrame) {
  Chance chance(9);
  const glm::dvec3 earth{2.1e-5, -3e-6, -4.4e-5};
  for (int i = 0; i < 10; ++i) {
    const Pose X_WM{chance.between(0, 2), chance.between(-1, 1), 0.03, chance.between(-4, 4)};
    const double yaw = chance.between(-4, 4);
    world::World world, with;
    const Glance alone = over_one(X_WM, scenes::array({{0.1, 0.2, 0.0, yaw}}), world);
    with.earth_field = earth;
    const Glance both = over_one(X_WM, scenes::array({{0.1, 0.2, 0.0, yaw}}), with);
    const Element a = element(alone.readings[0], 0), b = element(both.readings[0], 0);
    const glm::dvec2 flat = base::rotate(-X_WM.yaw - yaw, {earth.x, earth.y});
    EXPECT_NEAR(b.x - a.x, flat.x, 1e-18);
    EXPECT_NEAR(b.y - a.y, flat.y, 1e-18);
    EXPECT_NEAR(b.z - a.z, earth.z, 1e-18);
    EXPECT_NEAR(b.field, std::hypot(b.x, b.y, b.z), 1e-18);
    EXPECT_GE(both.readings[0].bound, alone.readings[0].bound);
  }
}

TEST(Magnetometer, ReadsTheEarthsFieldWithoutMagnets) {
  world::World world;
  world.earth_field = {3e-5, 0, -4e-5};
  scenes::add_carrier(world, {1, 2, 0, M_PI / 2}, scenes::array({{0, 0, 0, 0}}));
  const Glance run(world);
  const Element e = element(run.readings[0], 0);
  EXPECT_NEAR(e.x, 0.0, 1e-20) << "facing +y";
  EXPECT_DOUBLE_EQ(e.y, -3e-5) << "along +x, on its right";
  EXPECT_EQ(e.z, -4e-5);
  EXPECT_DOUBLE_EQ(e.field, 5e-5);
}

/// With `sum "magnitude"`, the Earth is one more source.
TEST(Magnetometer, MagnitudesIncludeTheEarths) {
  world::Sensor sensor = scenes::array({{0, 0, 0, 0}}, kHigh);
  sensor.settings.push_back(scenes::text("sum", "magnitude"));
  world::World world, with;
  const double alone = element(over_one({0.7, 0, 0, 0}, sensor, world).readings[0], 0).field;
  with.earth_field = {3e-5, 0, -4e-5};
  EXPECT_NEAR(element(over_one({0.7, 0, 0, 0}, sensor, with).readings[0], 0).field, alone + 5e-5, 1e-18);
}

// --- Saturation.

TEST(Magnetometer, SaturatesAtBothEnds) {
  world::Sensor sensor = scenes::array({{0, 0, 0, 0}}, kHigh);
  sensor.settings.push_back(scenes::setting("ssensitivity", {-0.3, 0.8}));
  world::World high, low;
  const Element most = element(over_one({1, 0, 0, 0}, sensor, high).readings[0], 0);
  EXPECT_EQ(most.field, 0.8 * sensors::kGauss);
  EXPECT_EQ(most.z, 0.8 * sensors::kGauss);
  low.magnets.push_back(magnet({1, 0}, 0, -1.0));
  scenes::add_carrier(low, {1, 0, 0, 0}, sensor);
  const Glance run(low);
  const Element least = element(run.readings[0], 0);
  EXPECT_EQ(least.z, -0.3 * sensors::kGauss);
  EXPECT_EQ(least.field, 0.8 * sensors::kGauss) << "the field has no sign";
}

TEST(Magnetometer, DefaultSensitivityIsTheRangeOfTheWire) {
  const auto m = sensors::read_magnetometer(scenes::array({{0, 0, 0, 0}}));
  EXPECT_NEAR(m.most, 21.47483647, 1e-12);
  EXPECT_EQ(m.least, -m.most);
}

// --- Sums.

/// Arrays with both kinds of sum in one world.
TEST(Magnetometer, SumsMagnitudesOnRequest) {
  world::World world = scenes::sheet(200, 1.0, 5, true);
  world::Sensor magnitudes = scenes::five(), vectors = scenes::five();
  magnitudes.settings.push_back(scenes::text("sum", "magnitude"));
  vectors.settings.push_back(scenes::text("sum", "vector"));
  scenes::add_carrier(world, {0, 0, 0, 0.5}, magnitudes);
  scenes::add_carrier(world, {0, 0, 0, 0.5}, vectors);
  const Glance run(world);
  for (std::size_t e = 0; e < 5; ++e) {
    const Pose X_WE = base::compose({0, 0, 0.2, 0.5}, {0.2, 0.075 * (static_cast<double>(e) - 2), 0, 0});
    const scenes::Exact truth = scenes::exact(world, {X_WE.x, X_WE.y, X_WE.z});
    const Element m = element(run.readings[0], e), v = element(run.readings[1], e);
    EXPECT_NEAR(m.field, static_cast<double>(truth.magnitudes), 1e-7 * m.field);
    EXPECT_NEAR(v.field, scenes::magnitude(truth), 1e-7 * m.field);
    EXPECT_EQ(m.x, v.x) << "the vector is the vectors' sum in both";
    EXPECT_EQ(m.z, v.z);
  }
}

// --- Moving magnets.

/// Moving robots with magnets and arrays: each tick is compared with the sum over all magnets at their current poses. A
/// robot's own magnets count.
void expect_moving_magnets(double cutoff) {
  // An odd number: the last magnet of an iteration is a mover's first one, which must count once.
  world::World world = scenes::sheet(41, 4.0, 6, true);
  world.magnet_cutoff = cutoff;
  Chance chance(7);
  for (int i = 0; i < 9; ++i) {
    const auto m =
        scenes::add_carrier(world, {chance.between(-2, 2), chance.between(-2, 2), 0.01 * i, 0}, scenes::five());
    for (int k = 0; k < i % 4; ++k) world.movers[m].magnets.push_back(magnet(chance.in_square(0.2), 0.05, k + 1.0));
  }
  farm::Farm farm(world, device()), on_host(world, host_device());
  farm.subscribe_all(), on_host.subscribe_all();
  for (int tick = 0; tick < 5; ++tick) {
    std::vector<base::Report> reports;
    world::World now = world;
    for (std::uint32_t m = 0; m < 9; ++m) {
      const Pose X{chance.between(-2, 2), chance.between(-2, 2), 0.01 * m, chance.between(-4, 4)};
      reports.push_back({m, 0, X, {}});
      for (world::Magnet carried : world.movers[m].magnets) {
        carried.p = base::transform(X, carried.p);
        carried.z += X.z;
        now.magnets.push_back(carried);
      }
    }
    const auto readings = farm.tick(tick * 100'000'000ll, reports);
    ASSERT_EQ(readings.size(), 9u);
    expect_same_bits(on_host.tick(tick * 100'000'000ll, reports), readings);
    for (const base::ReadingBlock& r : readings)
      for (std::size_t e = 0; e < 5; ++e) {
        const Pose X_WE = base::compose(r.X_WS, {0.2, 0.075 * (static_cast<double>(e) - 2), 0, 0});
        const scenes::Exact truth = scenes::exact(now, {X_WE.x, X_WE.y, X_WE.z}, cutoff);
        ASSERT_NEAR(element(r, e).field, scenes::magnitude(truth), 1e-7 * static_cast<double>(truth.magnitudes))
            << "tick " << tick << ", mover " << r.mover;
      }
  }
}

TEST(Magnetometer, MagnetsMoveWithTheirMovers) { expect_moving_magnets(0.0); }
TEST(Magnetometer, MagnetsMoveWithTheirMoversWithACutoff) { expect_moving_magnets(1.0); }

// --- Properties.

/// Equal bits for any number of threads, with noise and a cut-off.
TEST(Magnetometer, DoesNotDependOnThreads) {
  world::World world = scenes::sheet(500, 5.0, 10, true);
  world.magnet_cutoff = 1.0;
  Chance chance(11);
  for (int i = 0; i < 100; ++i) {
    world::Sensor sensor = scenes::five();
    sensor.settings.push_back(scenes::setting("noise", {0.01}));
    scenes::add_carrier(world, {chance.between(-3, 3), chance.between(-3, 3), 0, 0}, sensor);
  }
  std::uint64_t hash = 0;
  for (const unsigned threads : {1u, 2u, 5u}) {
    farm::Farm farm(world, device(), {.seed = 3, .threads = threads});
    farm.subscribe_all();
    for (int k = 0; k < 3; ++k) farm.tick(k * 100'000'000ll, {});
    if (threads == 1) hash = farm.hash();
    EXPECT_EQ(farm.hash(), hash) << threads << " threads";
  }
}

/// A sensor's reading does not depend on other subscriptions.
TEST(Magnetometer, DoesNotDependOnOtherSubscriptions) {
  world::World world = scenes::sheet(500, 5.0, 12);
  world.magnet_cutoff = 0.8;
  for (int i = 0; i < 60; ++i) scenes::add_carrier(world, {0.05 * i - 1.5, 0.1, 0, 0}, scenes::five());
  const Glance all(world);
  farm::Farm one(world, device());
  one.subscribe(31, farm::kAllSensorTypes);
  const auto alone = one.tick(0, {});
  ASSERT_EQ(alone.size(), 1u);
  EXPECT_EQ(std::memcmp(alone[0].values.data(), all.readings[31].values.data(), alone[0].values.size_bytes()), 0);
}

TEST(Magnetometer, CountsItsWork) {
  world::World world = scenes::line(10, 0.5);
  for (int i = 0; i < 3; ++i) scenes::add_carrier(world, {0, 0, 0, 0}, scenes::five());
  Glance run(world);
  EXPECT_EQ(run.farm.stats().work.dipoles, 3u * 5u * 10u);
}

}  // namespace
}  // namespace sf::trial
