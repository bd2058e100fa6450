#include "library/loading.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/installation.h"
#include "control/own_controllers.h"
#include "raycast/casters.h"
#include "scenarios/default_robot.h"
#include "sensors/sensor_type.h"
#include "world/free_space.h"
#include "world/stage/build_world.h"

namespace sf::library {

std::string found(const std::string& file) { return base::installed_file(file); }

world::World load(const WorldSource& source, const sensorfarm::Options& options) {
  world::LoadOptions load;
  load.accuracy = options.accuracy;
  load.sensors = sensors::world_file_words();
  load.controllers = control::controller_names;
  load.model_controllers = control::model_controller_names;
  world::World world =
      source.text.empty() ? world::load_world(source.file, load) : world::build_world(source.file, source.text, load);
  if (!options.robot_from.empty() && !options.of.empty())
    throw base::InputError("of and robot_from both name the robot to copy; expected one of them");
  using scenarios::OwnRobot;
  const std::string lent = scenarios::lend_robot(
      world, options.robot_from, options.robots > 0 ? OwnRobot::for_copies : OwnRobot::needs_room, load);
  if (options.robots > 0 || !lent.empty())
    world::clone_robots(world, std::max(1u, options.robots), options.seed, lent.empty() ? options.of : lent);
  return world;
}

std::shared_ptr<gpu::Device> shared_device(const sensorfarm::Options& options) {
  static std::mutex lock;
  // A forked process inherits its parent's devices without their threads, so it opens its own devices.
  static std::map<std::tuple<pid_t, std::string, bool>, std::weak_ptr<gpu::Device>> open;
  const bool require_vulkan =
      options.require_vulkan || raycast::choose_caster(true, raycast::caster_named(options.caster)).on_device;
  const std::scoped_lock guard(lock);
  std::weak_ptr<gpu::Device>& known = open[{getpid(), options.device, require_vulkan}];
  if (auto device = known.lock()) return device;
  auto device = std::make_shared<gpu::Device>(gpu::Device::or_host(options.device, require_vulkan));
  known = device;
  return device;
}

control::ControllerConfig controller_of(const std::string& name, const SettingTexts& texts) {
  std::vector<control::Setting> settings;
  for (const auto& [key, value] : texts)
    settings.push_back({key, control::RawText{value}, fmt::format("setting {}: ", key)});
  return {name, 0.0, control::Settings(fmt::format("controller '{}'", name), std::move(settings))};
}

}  // namespace sf::library
