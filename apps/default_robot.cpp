#include "apps/default_robot.h"

#include <algorithm>

#include "apps/report.h"
#include "apps/text.h"
#include "base/error.h"
#include "sensors/laser_settings.h"
#include "world/free_space.h"

namespace sf::apps {

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

world::World load_with_robots(const std::string& file, const world::LoadOptions& options, std::uint32_t count,
                              std::uint64_t seed, const std::string& of) {
  world::World world = world::load_world(file, options);
  const bool added = add_default_robot(world);
  if (added)
    print_message(
        "{} has no robot; it is lent 'roomba1' (id 1), a Create with a laser of 361 rays, 180 "
        "degrees, 8 m",
        file);
  if (count > 0 || added) world::clone_robots(world, std::max(1u, count), seed, of);
  print_warnings(file, world.warnings);
  return world;
}

world::World load_lights(const std::string& file) {
  world::World world = world::load_world(file, {.sensors = sensors::world_file_words()});
  if (world.lights.empty()) throw base::InputError(file, 0, "no traffic lights in this world; see docs/worlds.md");
  return world;
}

}  // namespace sf::apps
