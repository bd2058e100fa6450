#include "library/loading.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <span>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/installation.h"
#include "control/own_controllers.h"
#include "raycast/casters.h"
#include "scenarios/default_robot.h"
#include "sensors/sensor_type.h"
#include "world/free_space.h"
#include "world/random_starts.h"
#include "world/stage/build_world.h"

namespace sf::library {

std::string found(const std::string& file) { return base::installed_file(file); }

Starts::Starts(const world::World& world, std::optional<world::FreeSpace> space) : space_(std::move(space)) {
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    X_WM_.push_back(world.movers[row].X_WM);
    if (space_ && !world.movers[row].is_tag) clones_.push_back(row);
  }
}

void Starts::place(world::World& world, std::uint32_t copy, std::uint64_t seed) const {
  const std::size_t first = copy * X_WM_.size();
  const std::span<world::Mover> movers = std::span(world.movers).subspan(first, X_WM_.size());
  world::draw_starts(movers, X_WM_, seed, !space_);
  if (!space_) return;
  const auto poses = space_->poses(static_cast<std::uint32_t>(clones_.size()), seed, world::places_of_tags(movers));
  for (std::size_t i = 0; i < poses.size(); ++i) world.movers[first + clones_[i]].X_WM = poses[i];
}

LoadedWorld load(const WorldSource& source, const sensorfarm::Options& options) {
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
  std::optional<world::FreeSpace> space;
  if (options.robots > 0 || !lent.empty()) {
    const std::uint32_t original = world::robot_to_copy(world, lent.empty() ? options.of : lent);
    space.emplace(world, world.movers[original]);
    const std::vector<base::Pose> anywhere(std::max(1u, options.robots), world.movers[original].X_WM);
    world::copy_robots(world, original, anywhere, {});
  }
  Starts starts(world, std::move(space));
  world::copy_movers(world, options.copies);
  for (std::uint32_t copy = 0; copy < world.copies; ++copy) starts.place(world, copy, options.seed + copy);
  world::update_extent_and_hash(world);
  return {std::move(world), std::move(starts)};
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
