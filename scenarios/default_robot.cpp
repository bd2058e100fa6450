#include "scenarios/default_robot.h"

#include <algorithm>

#include "base/error.h"
#include "base/installation.h"
#include "sensors/laser_settings.h"
#include "world/append_robot.h"

namespace sf::scenarios {

namespace {

world::Mover create_robot(std::uint32_t model) {
  world::Mover robot;
  robot.name = "roomba1";
  robot.model = model;
  robot.id = 1;
  robot.radius = 0.165;
  constexpr int kSides = 16;
  for (int i = 0; i < kSides; ++i) {
    world::Segment side;
    side.a = base::rotate(2.0 * M_PI * i / kSides, {robot.radius, 0.0});
    side.b = base::rotate(2.0 * M_PI * ((i + 1) % kSides) / kSides, {robot.radius, 0.0});
    side.z_max = 0.1;
    side.model = model;
    robot.body.push_back(side);
  }
  sensors::LaserSettings laser;
  laser.name = "laser";
  laser.X_MS = {0.0, 0.0, 0.05, 0.0};
  laser.samples = 361;
  robot.sensors.push_back(sensors::laser_sensor(laser));
  return robot;
}

bool has_robot(const world::World& world) {
  return std::any_of(world.movers.begin(), world.movers.end(), [](const world::Mover& m) { return !m.is_tag; });
}

}  // namespace

bool add_default_robot(world::World& world) {
  if (has_robot(world)) return false;
  const auto model = static_cast<std::uint32_t>(world.models.size());
  world::Model row;
  row.name = "roomba1";
  row.type = "position";
  row.mover = static_cast<std::uint32_t>(world.movers.size());
  row.size = {0.33, 0.33};
  world.models.push_back(row);
  world.movers.push_back(create_robot(model));
  world::update_extent_and_hash(world);
  return true;
}

std::string lend_robot(world::World& world, const std::string& from, OwnRobot use, const world::LoadOptions& options) {
  if (from.empty()) return add_default_robot(world) ? world.movers.back().name : "";
  if (has_robot(world) && use == OwnRobot::where_needed) return "";
  if (has_robot(world) && use == OwnRobot::needs_room)
    throw base::InputError(world.file, 0,
                           "has its own robots; --robot-from is for worlds without robots, such as ROS maps, and for "
                           "copies: expected --robots N, too");
  const std::size_t colon = std::min(from.rfind(':'), from.size());
  const std::string name = colon == from.size() ? "" : from.substr(colon + 1);
  const std::string file = base::installed_file(from.substr(0, colon));
  return world.movers[world::append_robot_of(world, file, name, options)].name;
}

}  // namespace sf::scenarios
