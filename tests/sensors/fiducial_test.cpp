// Fiducial finders: range, field of view, line of sight, keys, order and noise.

#include "sensors/fiducial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/host_trial.h"
#include "tests/sensors/scenes.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using base::Pose;
using world::Fiducial;

/// A finder at `X_WM`, 0.1 m above the ground.
world::World with_finder(std::vector<world::Setting> settings = {}, const Pose& X_WM = {}) {
  world::World world = carriers(fitted("fiducial", std::move(settings)), {X_WM});
  world.movers[0].sensors[0].X_MS.z = 0.1;
  return world;
}

void add_mark(world::World& world, const Pose& X_WF, std::uint32_t id, Fiducial::Type type = Fiducial::Type::marker) {
  world.fiducials.push_back(
      {.model = static_cast<std::uint32_t>(world.models.size()), .X_BF = X_WF, .id = id, .type = type});
  world.models.push_back({.name = "mark" + std::to_string(id), .type = "model"});
}

std::vector<double> read_finder(const world::World& world) {
  const Glance glance(world);
  for (const base::ReadingBlock& reading : glance.readings)
    if (reading.type == sensors::kFiducial) return values_of(reading);
  return {};
}

/// Returns the ids of a reading, nearest first.
std::vector<double> ids_in(const world::World& world) {
  std::vector<double> ids;
  const std::vector<double> values = read_finder(world);
  for (std::size_t i = 0; i < values.size(); i += sensors::kFiducialNumbers)
    if (!std::isnan(values[i])) ids.push_back(values[i]);
  return ids;
}

using Ids = std::vector<double>;

TEST(FiducialFinder, MeasuresRangeBearingAndOrientation) {
  world::World world = with_finder({}, {1.0, 2.0, 0.0, M_PI / 2});
  add_mark(world, {1.0, 5.0, 0.1, M_PI}, 7, Fiducial::Type::threat);
  const std::vector<double> values = read_finder(world);
  ASSERT_EQ(values.size(), 8u * 5u);
  EXPECT_EQ(values[0], 7.0);
  EXPECT_EQ(values[1], 2.0) << "a threat";
  EXPECT_DOUBLE_EQ(values[2], 3.0);
  EXPECT_NEAR(values[3], 0.0, 1e-12) << "straight ahead";
  EXPECT_NEAR(values[4], M_PI / 2, 1e-12);
  for (std::size_t i = 5; i < values.size(); ++i) EXPECT_TRUE(std::isnan(values[i])) << "no further detections";
}

TEST(FiducialFinder, NearestFirstUpToTheNumberOfRows) {
  world::World world = with_finder({setting("detections", {2})});
  add_mark(world, {3, 0, 0.1, 0}, 3);
  add_mark(world, {0, 2, 0.1, 0}, 2);
  add_mark(world, {-4, 0, 0.1, 0}, 4);
  EXPECT_EQ(ids_in(world), (Ids{2, 3}));
  world.fiducials.clear();
  EXPECT_EQ(ids_in(world), Ids{});
}

TEST(FiducialFinder, LimitsOfRange) {
  for (const auto& [at, ids] :
       {std::pair{0.999, Ids{}}, {1.0, Ids{5}}, {3.0, Ids{5}}, {3.001, Ids{0}}, {4.0, Ids{0}}, {4.001, Ids{}}}) {
    world::World world =
        with_finder({setting("range_min", {1}), setting("range_max", {4}), setting("range_max_id", {3})});
    add_mark(world, {at, 0, 0.1, 0}, 5);
    EXPECT_EQ(ids_in(world), ids) << at << " m; beyond range_max_id the id is 0";
  }
}

TEST(FiducialFinder, LimitsOfTheFieldOfView) {
  for (const auto& [degrees, seen] :
       {std::pair{44.9, true}, {-44.9, true}, {45.1, false}, {-45.1, false}, {180.0, false}}) {
    world::World world = with_finder({setting("fov", {90})});
    const glm::dvec2 p = base::rotate(degrees * kDegree, {2.0, 0.0});
    add_mark(world, {p.x, p.y, 0.1, 0}, 5);
    EXPECT_EQ(!ids_in(world).empty(), seen) << degrees;
  }
}

TEST(FiducialFinder, WallsHideAtTheirHeights) {
  const auto seen = [](double z_min, double z_max, double y) {
    world::World world = with_finder();
    add_mark(world, {4, 0, 0.5, 0}, 5);  // the line of sight is at 0.3 m half-way
    add_solid(world, square({2, y}, 0.1), z_min, z_max);
    return !ids_in(world).empty();
  };
  EXPECT_FALSE(seen(0.0, 1.0, 0.0));
  EXPECT_TRUE(seen(0.0, 0.25, 0.0)) << "it looks over the wall";
  EXPECT_TRUE(seen(0.35, 1.0, 0.0)) << "and under it";
  EXPECT_FALSE(seen(0.0, 1.0, 0.049)) << "the middle is hidden, half of the mark is in sight";
  EXPECT_TRUE(seen(0.0, 1.0, 0.051)) << "the middle is in sight";
}

TEST(FiducialFinder, OtherRobotsHideAndCarryFiducials) {
  world::World world = with_finder();
  add_mark(world, {4, 0, 0.1, 0}, 5);
  EXPECT_EQ(ids_in(world), Ids{5});
  const std::uint32_t other = scenes::add_robot(world, {2, 0, 0, M_PI}, scenes::laser(3));
  EXPECT_EQ(ids_in(world), Ids{}) << "a robot is between them";
  world.models[world.fiducials[0].model].mover = other;
  world.fiducials[0].X_BF = {0.1, 0, 0.1, 0};
  const std::vector<double> values = read_finder(world);
  EXPECT_EQ(values[0], 5.0) << "its carrier does not hide it";
  EXPECT_DOUBLE_EQ(values[2], 1.9) << "it moves with its carrier";
  EXPECT_NEAR(std::abs(values[4]), M_PI, 1e-12);
  world.models[world.fiducials[0].model].mover = 0;
  EXPECT_EQ(ids_in(world), Ids{}) << "finders do not detect fiducials of their own robot";
}

TEST(FiducialFinder, KeysSelectFiducials) {
  world::World world = with_finder({setting("fiducial_key", {3})});
  add_mark(world, {1, 0, 0.1, 0}, 1);
  add_mark(world, {2, 0, 0.1, 0}, 2);
  world.fiducials[1].key = 3;
  EXPECT_EQ(ids_in(world), Ids{2});
}

TEST(FiducialFinder, NoiseHasTheFilesDeviations) {
  std::vector<double> range, bearing, orientation;
  world::World world = with_finder({setting("noise", {0.1, 2, 3})});
  for (std::uint32_t i = 1; i <= 900; ++i) add_mark(world, {2, 0, 0.1, 0}, i);
  world.movers[0].sensors[0].settings.push_back(setting("detections", {62}));
  const std::vector<double> values = read_finder(world);
  for (std::size_t i = 0; i < values.size(); i += 5) {
    range.push_back(values[i + 2] - 2.0);
    bearing.push_back(values[i + 3] / kDegree);
    orientation.push_back(values[i + 4] / kDegree);
  }
  const auto deviation = [](const std::vector<double>& v) {
    double sum = 0.0;
    for (const double x : v) sum += x * x;
    return std::sqrt(sum / static_cast<double>(v.size()));
  };
  EXPECT_NEAR(deviation(range), 0.1, 0.03) << "of 62 draws";
  EXPECT_NEAR(deviation(bearing), 2.0, 0.6);
  EXPECT_NEAR(deviation(orientation), 3.0, 0.9);
}

TEST(FiducialFinder, InvalidSettingsAreRefused) {
  expect_refused("fiducial", {setting("detections", {63})}, 8, "62");
  expect_refused("fiducial", {setting("range_max", {0})}, 8, "range_max");
  expect_refused("fiducial", {setting("fov", {361})}, 8, "fov");
  expect_refused("fiducial", {setting("noise", {-1})}, 8, "negative");
}

}  // namespace
}  // namespace sf::trial
