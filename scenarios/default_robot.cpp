#include "scenarios/default_robot.h"

#include <algorithm>

#include "sensors/laser_settings.h"

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

}  // namespace

bool add_default_robot(world::World& world) {
  if (std::any_of(world.movers.begin(), world.movers.end(), [](const world::Mover& m) { return !m.is_tag; }))
    return false;
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

}  // namespace sf::scenarios
