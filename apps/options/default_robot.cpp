#include "apps/options/default_robot.h"

#include <algorithm>

#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "scenarios/default_robot.h"
#include "sensors/sensor_type.h"
#include "world/free_space.h"
#include "world/outlines.h"

namespace sf::apps {

world::World load_with_robots(const std::string& file, const world::LoadOptions& options, std::uint32_t count,
                              std::uint64_t seed, const std::string& of) {
  world::World world = world::load_world(file, options);
  const bool added = scenarios::add_default_robot(world);
  if (count > 0 || added) world::read_unread(world);  // free places are looked for among all walls
  if (added)
    print_message(
        "{} has no robot; it is lent 'roomba1' (id 1), a Create with a laser of 361 rays, 180 "
        "degrees, 8 m; for a robot of yours, write a world that includes this file (docs/worlds.md)",
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
