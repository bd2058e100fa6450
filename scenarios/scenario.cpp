#include "scenarios/scenario.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/suggest.h"
#include "base/tilted_pose.h"
#include "control/own_controllers.h"
#include "scenarios/fleet_spawn.h"
#include "sensors/sensor_type.h"
#include "world/ground.h"
#include "world/random_starts.h"

namespace sf::scenarios {

std::uint32_t row_of(const Scenario& scenario, const world::World& world, const std::string& robot, int line) {
  std::vector<std::string_view> names;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) {
    if (world.movers[i].name == robot) return i;
    names.push_back(world.movers[i].name);
  }
  throw base::InputError(scenario.file, line,
                         fmt::format("{} has no mover '{}'{}", scenario.world, robot,
                                     base::suggest(robot, names, "expected one of its movers")));
}

namespace {

void set_plant(const Scenario& scenario, world::World& world) {
  for (world::Mover& mover : world.movers) {
    if (*scenario.plant == Plant::thesis && !mover.dynamics.name.empty())
      throw base::InputError(scenario.file, 0,
                             fmt::format("the plant \"thesis\" is the driver of the iRobot Create (0.5 m/s), but '{}' "
                                         "of {} has 'dynamics'; expected \"ideal\"",
                                         mover.name, scenario.world));
    mover.actuator_model =
        *scenario.plant == Plant::thesis ? world::ActuatorModel::player_create : world::ActuatorModel::direct;
  }
}

}  // namespace

world::World world_of(const Scenario& scenario) {
  return world_of(scenario, {.controllers = control::controller_names,
                             .model_controllers = control::model_controller_names,
                             .sensors = sensors::world_file_words()});
}

world::World world_of(const Scenario& scenario, const world::LoadOptions& load) {
  if (!std::filesystem::is_regular_file(scenario.world) && !scenario.file.empty())
    throw base::InputError(
        scenario.file, scenario.world_line,
        fmt::format("there is no world '{}'; expected a file, relative to this file's folder", scenario.world));
  world::World world = world::load_world(scenario.world, load);
  world::draw_starts(world, scenario.seed, scenario.fleet.robots == 0);
  if (scenario.fleet.robots > 0) spawn_fleet(scenario, world);
  world::draw_variations(world, scenario.seed);
  if (scenario.tick > 0.0) world.interval = scenario.tick;
  if (scenario.plant) set_plant(scenario, world);
  for (const RobotSetup& setup : scenario.robot_setups) {
    world::Mover& mover = world.movers[row_of(scenario, world, setup.name, setup.line)];
    if (mover.is_tag && setup.actor && setup.actor->controller.name.empty()) mover.controller.clear();
    if (!setup.pose) continue;
    const bool stands = std::isnan(setup.pose->z);
    mover.X_WM = stands ? world::Ground(world.ramps, world.terrain).stand(mover.X_WM, *setup.pose) : *setup.pose;
  }
  world::update_extent_and_hash(world);
  for (const ObjectEvent& event : scenario.events)
    if (event.at > scenario.duration - world.interval + 1e-9)
      world.warnings.push_back(
          {scenario.file, event.line,
           fmt::format("the event at {:g} s is after the last tick of the scenario, whose duration "
                       "is {:g} s: it has no effect unless a longer run is requested",
                       event.at, scenario.duration)});
  return world;
}

SimulationOptions simulation_of(const Scenario& scenario, const world::World& world) {
  SimulationOptions options{.seed = scenario.seed,
                            .start_at = scenario.start_at,
                            .states = scenario.states,
                            .positioning = scenario.positioning,
                            .v2v = scenario.v2v};
  options.faults = scenario.faults;
  if (options.states) options.states->link.seed = scenario.seed;
  if (options.positioning) options.positioning->link.seed = scenario.seed;
  if (options.v2v) options.v2v->link.seed = scenario.seed;
  // Tags remain at rest unless a [[robot]] names them. A robot's controller in the world file overrides the scenario's
  // default.
  for (const world::Mover& mover : world.movers)
    options.actors.push_back({control::controller_of(mover, scenario.actor.controller),
                              mover.is_tag ? netio::LinkModel{} : scenario.actor.link});
  for (const RobotSetup& setup : scenario.robot_setups)
    if (setup.actor) options.actors[row_of(scenario, world, setup.name, setup.line)] = *setup.actor;
  for (const RobotSetup& setup : scenario.robot_setups)
    if (!base::is_level(setup.tilt))
      options.tilts.push_back({row_of(scenario, world, setup.name, setup.line), setup.tilt});
  for (Actor& actor : options.actors) actor.link.seed = scenario.seed;
  return options;
}

}  // namespace sf::scenarios
