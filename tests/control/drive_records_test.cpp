// Whole drives of every controller, compared with golden records. A line is a time, a pose and a command, rounded to a
// tenth of a millimetre and of a milliradian.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "sensors/laneedge.h"
#include "sensors/magnetometer.h"
#include "tests/control/closed_loop.h"
#include "tests/control/traffic.h"
#include "tests/golden.h"
#include "tests/instrumented.h"
#include "world/path_geometry.h"

namespace sf::control::drives {
namespace {

using base::Pose;
using base::ReadingBlock;
using base::Twist;

double rounded(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }

std::string line_of(const base::Report& at, const Twist& command) {
  const Pose& X = at.X_WM;
  return fmt::format("{} at {} {} {} drives {} {} {}", rounded(1e-9 * static_cast<double>(at.time)), rounded(X.x),
                     rounded(X.y), rounded(X.yaw), rounded(command.forward), rounded(command.left),
                     rounded(command.turn));
}

void expect_drive(const std::string& name, const std::string& drive) {
  sf::golden::expect(drive, "control", name, 1.5e-4);
}

/// Returns the readings of the robot at a pose.
using Sense = std::function<std::vector<double>(const Pose&)>;

/// Drives a single robot for some ticks with one sensor, and writes a line for every 25th step.
std::string drive_of(const world::World& world, const std::string& name, std::vector<Setting> given, std::uint8_t type,
                     const Sense& sense, int ticks) {
  Settings settings("controller '" + name + "'", std::move(given));
  const auto controller = find_controller(name)->make({.world = world, .seed = 7}, settings);
  robots::Fleet fleet(world);
  const Pose eye = type == sensors::kLaser ? sensors::lasers_of(world.movers[0])[0].X_MS : Pose{};
  std::string text;
  for (int i = 0; i < ticks && !controller->done(); ++i) {
    const base::Report state = fleet.reports()[0];
    const std::vector<double> values = sense ? sense(state.X_WM) : std::vector<double>{};
    const ReadingBlock block{.type = type,
                             .sequence = static_cast<std::uint32_t>(i),
                             .time = state.time,
                             .X_WM = state.X_WM,
                             .X_WS = compose(state.X_WM, eye),
                             .values = values};
    const Twist command[] = {controller->step({.time = state.time,
                                               .state = state,
                                               .readings = {&block, sense ? 1u : 0u},
                                               .contact = fleet.contacts()[0] != 0})};
    if (i % 25 == 0) text += line_of(state, command[0]) + fmt::format(" error {}\n", rounded(controller->error()));
    fleet.move(command, kTick);
  }
  return text + fmt::format("{} done {}\n", line_of(fleet.reports()[0], {}), controller->done());
}

/// Starts next to the path, at an angle to it.
world::World path_world() {
  world::World world = loop::path_world();
  world.movers[0].X_WM = {0, 0.03, 0, 0.1};
  return world;
}

TEST(DriveRecords, LaneKeeping) {
  const world::World world = path_world();
  const auto edge = [&](const Pose& X_WM) { return loop::edge_from(world, X_WM); };
  expect_drive("lane_keeping", drive_of(world, "lane-keeping", {}, sensors::kLaneEdge, edge, 400));
}

TEST(DriveRecords, MagnetKeeping) {
  const world::World world = path_world();
  const auto field = [&](const Pose& X_WM) { return loop::field_over(world, X_WM); };
  expect_drive("magnet_keeping", drive_of(world, "magnet-keeping", {}, sensors::kMagnetometer, field, 400));
}

/// A room with two pillars, and a robot with a laser of 181 beams.
world::World room() {
  world::World world = scenes::boxed_world(4.0, 3.0);
  scenes::add_outline(world.walls, scenes::rectangle({1.5, 1.2}, 0.4, 0.3));
  scenes::add_outline(world.walls, scenes::rectangle({2.8, 2.0}, 0.2, 0.7));
  scenes::add_create(world, {0.6, 0.7, 0, 0.4})
      .sensors.push_back(
          {.type = "laser",
           .X_MS = {0.19, 0, 0, 0},
           .settings = {{"samples", {181}, "", 1, ""}, {"fov", {3.0}, "", 1, ""}, {"range_max", {1.5}, "", 1, ""}}});
  update_extent_and_hash(world);
  return world;
}

Sense laser_in(const world::World& world) {
  return [&world](const Pose& X_WM) {
    const sensors::LaserSettings laser = sensors::lasers_of(world.movers[0])[0];
    return loop::scan(world, laser, compose(X_WM, laser.X_MS));
  };
}

TEST(DriveRecords, Wander) {
  const world::World world = room();
  expect_drive("wander", drive_of(world, "wander", {}, sensors::kLaser, laser_in(world), 500));
}

TEST(DriveRecords, Explore) {
  const world::World world = room();
  expect_drive("explore", drive_of(world, "explore", {}, sensors::kLaser, laser_in(world), 250));
}

TEST(DriveRecords, Patrol) {
  const std::vector<Setting> points{{"points", std::vector<double>{0, 0, 1, 0.5, 1, 1.2}, ""}, {"pause", 1.5, ""}};
  world::World world = scenes::empty_world();
  scenes::add_create(world, {0.2, -0.3, 0, 2.5});
  expect_drive("patrol", drive_of(world, "patrol", points, 0, nullptr, 500));
}

TEST(DriveRecords, Docking) {
  world::World world = scenes::empty_world();
  const Pose X_WD{3.0, -2.0, 0.0, 0.8};
  scenes::add_create(world, base::compose(X_WD, {1.9, -1.1, 0.0, 0.3})).sensors.push_back({.type = "irreceiver"});
  world.emitters.push_back({.kind = world::Emitter::Kind::dock, .X_WE = X_WD, .range = 1.8, .fov = 0.7, .halo = 0.6});
  const auto light = [&](const Pose& X_WM) -> std::vector<double> {
    const glm::dvec2 from = base::rotate(-X_WD.yaw, glm::dvec2{X_WM.x - X_WD.x, X_WM.y - X_WD.y});
    const double bearing = std::atan2(from.y, from.x), far = glm::length(from);
    int byte = far <= 0.6 ? 2 : 0;
    if (far <= 1.8 && std::abs(bearing - 0.2625) <= 0.35) byte += 8;
    if (far <= 1.8 && std::abs(bearing + 0.2625) <= 0.35) byte += 4;
    return {0.0, byte == 0 ? 255.0 : 240.0 + byte};
  };
  expect_drive("docking", drive_of(world, "docking", {}, 11, light, 600));
}

/// SimVille's streets with lights: a convoy of three, one robot that parks, and eight that tour.
TEST(DriveRecords, Streets) {
  traffic::Streets t;
  t.add_lights();
  const Setting gap{"gap", 0.1, ""};
  t.add({5.4, 0.75, 0, 0}, "route", traffic::go({6, 7, 8, 2}, {{"loop", true, ""}, {"speed", 0.18, ""}, gap}));
  for (int k = 1; k < 3; ++k) t.add({5.4 - 0.6 * k, 0.75, 0, 0}, "convoy", {{"leader", double(k), ""}});
  t.add({3.15, 5.0, 0, -M_PI / 2}, "route", {{"park", std::string("13.4"), ""}, gap});
  std::uint32_t tours = 0;
  for (const Pose& X : start_poses(t.roads, 12, 3, 0.8))
    if (std::hypot(X.x - 4.8, X.y - 0.75) > 1.2 && std::hypot(X.x - 3.15, X.y - 5.0) > 0.6 && tours++ < 8)
      t.add(X, "route", {{"tour", true, ""}, gap});
  t.begin(3);
  std::string text;
  for (int i = 0; i <= (instrumented() ? 0 : 1800); ++i) {
    if (i % 300 == 299)
      for (std::uint32_t row = 0; row < t.controllers.size(); ++row)
        text += fmt::format(
            "{} {} for {} after {}\n", row, line_of(t.fleet->reports()[row], t.fleet->reports()[row].velocity),
            static_cast<std::int32_t>(t.intents[row].checkpoint), static_cast<std::int32_t>(t.intents[row].follows));
    t.tick();
  }
  if (instrumented()) GTEST_SKIP() << "minutes under sanitizers; the tests of routes run the same code";
  expect_drive("streets", text + fmt::format("contacts {}\n", t.contacts));
}

}  // namespace
}  // namespace sf::control::drives
