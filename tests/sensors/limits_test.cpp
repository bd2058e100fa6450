// Limits of the farm: errors above them, and success just below them.

#include <gtest/gtest.h>

#include <array>
#include <tuple>

#include "raycast/casters.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/host_trial.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

const farm::FarmOptions kLimitsOnDevice{.scene = {.caster = &raycast::device_caster}};

void add_thin(std::vector<world::Segment>& out, glm::dvec2 a, glm::dvec2 b, std::uint32_t model) {
  world::Segment s;
  s.a = a;
  s.b = b;
  s.z_max = 1.0;
  s.model = model;
  s.solid_left = false;
  out.push_back(s);
}

/// `count` rails along the x axis, 4 um from it, all within one direction sector, with a wall behind them. A beam along
/// the axis passes between all rails, and each is edge-on.
world::World rails(int count) {
  world::World world;
  world.models.push_back({"rails", "model"});
  for (int i = 0; i < count; ++i) {
    const double x = 1.0 + 5.0 * i / count;
    const double y = (i % 2 ? 1.0 : -1.0) * 4e-6;
    add_thin(world.walls, {x, y}, {x + 2e-4, y}, 0);
  }
  world.models.push_back({"behind", "model"});
  add_thin(world.walls, {7, -0.2}, {7, 0.2}, 1);
  add_eye(world, {0.0, 0.0, 0.0, 0.05}, eye(5, 0.1, 8.0));
  return world;
}

/// Thin rails are listed twice, once per side visible from the cell: 5 500 of them are 11 000 entries.
TEST(Limits, ReadsListsJustBelowTheLimitToTheEnd) {
  const world::World world = rails(5'500);
  const Glance glance(world, kLimitsOnDevice);
  EXPECT_NEAR(glance.readings[0].values[0], 7.0, 1e-12) << "the last of the list is what the first beam meets";
  EXPECT_EQ(glance.readings[0].hits[0], 1u);
  EXPECT_GT(glance.farm.stats().work.uncertain, 0u) << "the test is meant to send every entry to the 64-bit decision";
  expect_exact("5 500 rails", sweep(world));
}

/// A mover with nearly as many segments as its limit, next to walls with nearly as many as theirs.
TEST(Limits, WallsAndMoversTogetherStayWithinTheLoopLimit) {
  world::World world = rails(5'500);
  const std::uint32_t m = add_eye(world, {6.0, 0.0, 0.0, 0.0}, eye(1, 0.0, 8.0));
  world::Mover& mover = world.movers[m];
  scenes::remove_lasers(mover);
  for (int i = 0; i < 1'950; ++i) {
    const double y = (i % 2 ? 1.0 : -1.0) * 4e-6;
    add_thin(mover.body, {1.5e-4 * i, y}, {1.5e-4 * i + 1e-5, y}, mover.model);
  }
  add_thin(mover.body, {0.5, -0.01}, {0.5, 0.01}, mover.model);
  mover.radius = 0.51;
  const Glance glance(world);
  EXPECT_NEAR(glance.readings[0].values[0], 6.5, 1e-12) << "the last of the mover's list";
  EXPECT_EQ(glance.readings[0].hits[0], mover.model);
}

/// One more than the limit, and many more: scans run on the host and are counted.
TEST(Limits, CastsTooManyWallsInOneSectorOnTheHost) {
  for (const int count : {5'601, 12'500}) {
    const world::World world = rails(count);
    const Glance glance(world, kLimitsOnDevice);
    EXPECT_NEAR(glance.readings[0].values[0], 7.0, 1e-12);
    EXPECT_EQ(glance.readings[0].hits[0], 1u);
    EXPECT_EQ(glance.farm.stats().work.host_scans, 1u) << count;
    expect_exact("rails", sweep(world));
  }
  EXPECT_EQ(Glance(rails(5'500), kLimitsOnDevice).farm.stats().work.host_scans, 0u);
}

TEST(Limits, CastsTooManyMoverSegmentsInOneSectorOnTheHost) {
  world::World world;
  add_eye(world, {}, eye(1, 0.0, 8.0));
  const std::uint32_t m = add_eye(world, {7.0, 0.0, 0.0, 0.0}, eye(1, 0.0, 8.0));
  const auto at = [](int i) { return glm::dvec2{0.0, 1e-4 * i - 0.625}; };
  for (int i = 0; i < 12'500; ++i) add_thin(world.movers[m].body, at(i), at(i + 1), 0);
  world.movers[m].radius = 0.63;
  const Glance glance(world, kLimitsOnDevice);
  EXPECT_NEAR(glance.readings[0].values[0], 7.0, 1e-12);
  EXPECT_EQ(glance.farm.stats().work.host_scans, 1u);
}

/// Further device limits: a dispatch of several rows of groups, and one whose last lanes are padding.
TEST(Limits, MillionBeamsOfOneSensor) {
  world::World world = scenes::boxes(10, 8.0, 1);
  add_eye(world, {0.3, 0.2, 0, 0}, eye(1'000'000, 2.0 * M_PI, 12.0));
  expect_exact("a million beams", sweep(world));
}

/// Far away, cell indices exceed 32 bits: a short range makes small cells.
TEST(Limits, ShortRangesFarAway) {
  for (const double far : {1e5, 1e7}) {
    world::World world;
    scenes::add_outline(world, {{far + 0.01, -1}, {far + 1, -1}, {far + 1, 1}, {far + 0.01, 1}}, "wall");
    add_eye(world, {far, 0, 0, 0}, eye(5, 0.1, 0.02));
    add_eye(world, {far - 4.0, 0, 0, 0}, eye(5, 0.1, 0.02));
    const Tally tally = sweep(world);
    expect_exact("a range of 2 cm at " + std::to_string(far) + " m", tally);
    EXPECT_EQ(tally.met, 5u);
  }
}

/// Settings of world files at their limits, in metres and degrees, the next values beyond, and two numbers for one.
TEST(Limits, SettingsAreLimited) {
  const auto refused = [](const std::string& type, const std::string& key, std::vector<double> values) {
    const std::string error = refusal_of(
        [&] { const sensors::SensorSet sensor_set(carriers(fitted(type, {setting(key, std::move(values))}))); });
    EXPECT_TRUE(error.empty() || error.starts_with("park.world:8: ")) << error;
    return !error.empty();
  };
  struct Range {
    const char *type, *key;
    double below, first, last, above;
  };
  for (const Range& r : std::initializer_list<Range>{{"encoder", "per_count", 0.99e-7, 1e-7, 1e3, 1000.1},
                                                     {"encoder", "slip", -0.1, 0.0, 1.0, 1.001},
                                                     {"encoder", "scrub", 0.099, 0.1, 10.0, 10.01},
                                                     {"encoder", "track", 0.00099, 1e-3, 1e3, 1000.1},
                                                     {"gyro", "bias", -0.1, 0.0, 57295.7, 57295.9},
                                                     {"gyro", "noise", -0.1, 0.0, 57295.7, 57295.9},
                                                     {"gyro", "scale_error", -0.1, 0.0, 1.0, 1.001},
                                                     {"gyro", "range", 5.7e-5, 5.8e-5, 57295.7, 57295.9},
                                                     {"gps", "satellites", 3, 4, 64, 65},
                                                     {"gps", "noise", -0.1, 0.0, 1e6, 1.001e6},
                                                     {"gps", "rate", 0.99e-6, 1e-6, 1e6, 1.001e6},
                                                     {"gps", "update_interval", 0.00099, 1e-3, 1e9, 1.001e9},
                                                     {"gps", "phase", -0.1, 0.0, 1e6, 1.001e6},
                                                     {"gps", "latency", -0.1, 0.0, 1e6, 1.001e6},
                                                     {"infrared", "noise", -0.1, 0.0, 1e3, 1000.1},
                                                     {"infrared", "fov", -0.1, 0.0, 360.0, 360.1},
                                                     {"infrared", "rays", 0, 1, 1025, 1026},
                                                     {"sonar", "fov", -0.1, 0.0, 360.0, 360.1},
                                                     {"sonar", "rays", 0, 1, 1025, 1026},
                                                     {"sonar", "incidence", 0.00099, 0.00101, 90.0, 90.1},
                                                     {"laser", "samples", 0, 1, 1e6, 1'000'001},
                                                     {"laser", "fov", -0.1, 0.0, 360.0, 360.1},
                                                     {"laser", "range_max", 0.0, 1e-3, 1e7, 1.0001e7},
                                                     {"laser", "range_min", -0.1, 0.0, 1.0, 1e7},
                                                     {"laser", "resolution", 0, 1, 1e6, 1'000'001},
                                                     {"laneedge", "samples", 0, 1, 1024, 1025},
                                                     {"laneedge", "fov", -0.1, 30.0, 360.0, 360.1},
                                                     {"laneedge", "range_max", 0.99e-6, 1e-6, 1e4, 10000.1},
                                                     {"laneedge", "range_min", -0.1, 0.0, 1.0, 1.001},
                                                     {"laneedge", "perpendicular", -720.1, -720.0, 720.0, 720.1},
                                                     {"magnetometer", "noise", -0.1, 0.0, 1e9, 1.001e9}}) {
    EXPECT_FALSE(refused(r.type, r.key, {r.first})) << r.type << " " << r.key;
    EXPECT_FALSE(refused(r.type, r.key, {r.last})) << r.type << " " << r.key;
    EXPECT_TRUE(refused(r.type, r.key, {r.below})) << r.type << " " << r.key;
    EXPECT_TRUE(refused(r.type, r.key, {r.above})) << r.type << " " << r.key;
    EXPECT_TRUE(refused(r.type, r.key, {r.first, r.first})) << r.type << " " << r.key;
  }
  for (const auto& [left, right, out] : {std::tuple{0.1, 10.0, false},
                                         {10.0, 0.1, false},
                                         {0.099, 1.0, true},
                                         {1.0, 0.099, true},
                                         {10.01, 1.0, true},
                                         {1.0, 10.01, true}})
    EXPECT_EQ(refused("encoder", "scale", {left, right}), out) << left << " " << right;
  for (const std::size_t i : {0u, 1u, 2u})
    for (const auto& [values, out] : {std::pair{std::array{0.0, 0.0, 0.0}, false},
                                      {{1e7, 1e3, 359.9}, false},
                                      {{-1e-9, -1e-9, -1e-9}, true},
                                      {{1.001e7, 1.001e3, 360.1}, true}}) {
      std::vector<double> noise{0.01, 0.01, 0.01};
      noise[i] = values[i];
      EXPECT_EQ(refused("laser", "noise", noise), out) << i << ": " << noise[i];
    }
}

}  // namespace
}  // namespace sf::trial
