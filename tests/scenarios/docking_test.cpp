// Docking in SimVille as shipped: its dock, and a Create with the receiver at its real position, from places all over
// the car park.

#include <gtest/gtest.h>

#include <cmath>

#include "control/stop_reason.h"
#include "scenarios/simulation.h"
#include "sensors/battery.h"
#include "sensors/sensor_type.h"
#include "tests/device.h"
#include "tests/sensors/edit_laser.h"
#include "tests/world/read_world.h"
#include "world/wall_tree.h"

namespace sf::scenarios {
namespace {

/// SimVille with only roomba5, which carries only its receiver and a battery.
world::World car_park() {
  world::World world =
      world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world", {.sensors = sensors::world_file_words()});
  const auto robot = std::find_if(world.movers.begin(), world.movers.end(),
                                  [](const world::Mover& mover) { return mover.name == "roomba5"; });
  const base::Pose at[] = {robot->X_WM};
  world::copy_robots(world, static_cast<std::uint32_t>(robot - world.movers.begin()), at, {});
  world::Mover& mover = world.movers.front();
  scenes::remove_lasers(mover);
  std::erase_if(mover.sensors, [](const world::Sensor& sensor) { return sensor.type != "irreceiver"; });
  mover.sensors.push_back({.type = "battery", .name = "battery"});
  world.road_files.clear();
  world.magnets.clear();
  world::update_extent_and_hash(world);
  return world;
}

bool is_free(const world::World& world, glm::dvec2 p) {
  return std::all_of(world.walls.begin(), world.walls.end(), [&](const world::Segment& wall) {
    return wall.z_min > 0.1 || world::distance(p, wall.a, wall.b) > world.movers.front().radius + 0.01;
  });
}

struct Docked {
  double seconds = HUGE_VAL;
  glm::dvec2 p;      ///< [m] in the dock's frame
  double off = 0.0;  ///< [rad] from facing it
  bool charges = false;
  std::string reason;
};

Docked dock(world::World world, const base::Pose& from) {
  world.movers.front().X_WM = from;
  SimulationOptions options;
  options.actor.controller = {.name = "docking"};
  Simulation simulation(world, device(), std::move(options));
  Docked docked;
  for (int tick = 0; tick < 2000; ++tick) {
    const base::TickRecord record = simulation.step();
    if (!simulation.all_done()) continue;
    const base::Pose& X_WD = world.emitters.front().X_WE;
    const base::Pose& X_WM = record.reports[0].X_WM;
    docked.seconds = 0.1 * tick;
    docked.p = base::rotate(-X_WD.yaw, {X_WM.x - X_WD.x, X_WM.y - X_WD.y});
    docked.off = base::wrap_angle(X_WM.yaw - X_WD.yaw - M_PI);
    for (const base::ReadingBlock& r : record.readings)
      if (r.type == sensors::kBattery) docked.charges = r.values[3] == 1.0;
    return docked;
  }
  docked.reason = control::stop_reason_of(*simulation.controller(0));
  return docked;
}

TEST(DockingInSimVille, SucceedsFromAllOverTheCarPark) {
  const world::World world = car_park();
  ASSERT_EQ(world.emitters.front().kind, world::Emitter::Kind::dock);
  int starts = 0;
  double longest = 0.0;
  for (const double x : {1.6, 2.0, 2.65, 3.0, 3.5, 4.3, 5.5})
    for (const double y : {1.5, 1.8, 2.05, 2.35})
      for (const double yaw : {0.0, 1.7, M_PI, -1.4}) {
        if (!is_free(world, {x, y})) continue;
        const Docked docked = dock(world, {x, y, 0.0, yaw});
        ++starts;
        longest = std::max(longest, std::isfinite(docked.seconds) ? docked.seconds : 0.0);
        EXPECT_LT(docked.seconds, 150.0) << x << ", " << y << ", " << yaw << " " << docked.reason;
        if (!std::isfinite(docked.seconds)) continue;
        EXPECT_TRUE(docked.charges) << x << ", " << y << ", " << yaw;
        EXPECT_LT(std::abs(docked.p.y), 0.07) << x << ", " << y << ", " << yaw;
        EXPECT_LT(std::abs(docked.off), 0.5) << x << ", " << y << ", " << yaw;
        EXPECT_NEAR(docked.p.x, 0.215, 0.005) << "its front at the dock's face: " << x << ", " << y << ", " << yaw;
      }
  EXPECT_GE(starts, 80);
  RecordProperty("longest_s", static_cast<int>(longest));
}

/// A Create with bumper and receiver in a room of 4 m x 3 m, its dock at the western wall, and a box.
world::World room(const std::string& box) {
  std::string text = "include \"" SF_SOURCE_DIR "/worlds/robots.inc\"\n";
  text += "model( name \"room\" size [4 3 1] boundary 1 noblocks 0 )\n";
  text += "model( name \"dock\" pose [-1.85 0 0 0] size [0.1 0.2 0.09] ir_emitter \"dock\" )\n";
  if (!box.empty()) text += "model( name \"box\" " + box + " )\n";
  text += "create( name \"roomba\" pose [1 1 0 0] create_irreceiver( ) )\n";
  return world::read_world(text, {.sensors = sensors::world_file_words()});
}

// Boxes on the axis, at its side, turned, long, and between the dock and the staging point. The robot detects them by
// contact only.
TEST(DockingInARoom, SucceedsAroundABox) {
  for (const char* box : {"", "pose [-0.4 0 0 0] size [0.4 0.4 0.4]", "pose [-0.4 0.4 0 0] size [0.4 0.4 0.4]",
                          "pose [-0.9 0 0 30] size [0.25 0.6 0.4]", "pose [0.3 -0.3 0 45] size [0.7 0.5 0.4]"}) {
    const world::World world = room(box);
    int starts = 0;
    for (const double x : {-1.2, -0.2, 0.8, 1.6})
      for (const double y : {-1.1, 0.0, 1.1})
        for (const double yaw : {0.0, 0.5 * M_PI, M_PI, -0.5 * M_PI}) {
          if (!is_free(world, {x, y})) continue;
          ++starts;
          EXPECT_LT(dock(world, {x, y, 0.0, yaw}).seconds, 200.0) << box << ": " << x << ", " << y << ", " << yaw;
        }
    EXPECT_GE(starts, 40) << box;
  }
}

}  // namespace
}  // namespace sf::scenarios
