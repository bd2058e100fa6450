#include "apps/options/default_robot.h"

#include <algorithm>

#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "sensors/sensor_type.h"
#include "world/free_space.h"
#include "world/outlines.h"
#include "world/random_starts.h"

namespace sf::apps {

world::World load_with_robots(const WorldOptions& options, const CloneOptions& clones, scenarios::OwnRobot use) {
  world::World world = world::load_world(options.world, options.load);
  if (clones.robots > 0) use = scenarios::OwnRobot::for_copies;
  const std::string added = scenarios::lend_robot(world, options.robot_from, use, options.load);
  const bool copies = clones.robots > 0 || !added.empty();
  world::draw_starts(world, clones.seed, !copies);
  if (copies) world::read_unread(world);  // free positions must avoid all walls
  if (!added.empty() && options.robot_from.empty())
    print_message(
        "{} has no robot; using the default robot 'roomba1' (id 1), a Create with a laser of 361 rays, 180 degrees, 8 "
        "m; for another robot, give --robot-from FILE:NAME, or write a world that includes this file (docs/worlds.md)",
        options.world);
  if (copies) world::clone_robots(world, std::max(1u, clones.robots), clones.seed, added.empty() ? clones.of : added);
  world::draw_variations(world, clones.seed);
  print_warnings(options.world, world.warnings);
  return world;
}

world::World load_lights(const std::string& file) {
  world::World world = world::load_world(file, {.sensors = sensors::world_file_words()});
  if (world.lights.empty()) throw base::InputError(file, 0, "no traffic lights in this world; see docs/worlds.md");
  return world;
}

}  // namespace sf::apps
