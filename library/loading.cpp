#include "library/loading.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <span>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/installation.h"
#include "base/shape_state.h"
#include "control/own_controllers.h"
#include "raycast/casters.h"
#include "scenarios/default_robot.h"
#include "sensors/sensor_type.h"
#include "world/free_space.h"
#include "world/stage/build_world.h"

namespace sf::library {

std::string found(const std::string& file) { return base::installed_file(file); }

Starts::Starts(const world::World& world, std::optional<world::FreeSpace> space) : space_(std::move(space)) {
  originals_ = world::originals_of(world);
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (space_ && !world.movers[row].is_tag) clones_.push_back(row);
}

void Starts::place(world::World& world, std::uint32_t copy, std::uint64_t seed, const sensorfarm::WorldStarts& given,
                   std::size_t first_given, std::vector<std::uint32_t>& resized) {
  const auto first = static_cast<std::uint32_t>(copy * originals_.size());
  const std::span<world::Mover> movers = std::span(world.movers).subspan(first, originals_.size());
  world::draw_poses(world, first, originals_, seed, !space_);
  world::draw_variations(world, first, originals_.size(), seed);
  std::vector<glm::dvec3> sizes = world::draw_sizes(originals_, seed);
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (!given.sizes.empty() && !std::isnan(given.sizes[first_given + i][0])) {
      const auto& [x, y, z] = given.sizes[first_given + i];
      sizes[i] = {x, y, z};
    }
  for (std::size_t row = sizes_.size(); row < first + sizes.size(); ++row)
    sizes_.push_back(originals_[row % originals_.size()].size);
  for (std::uint32_t i = 0; i < sizes.size(); ++i)
    if (std::exchange(sizes_[first + i], sizes[i]) != sizes[i]) {
      world::set_size(world, first + i, originals_[i], sizes[i]);
      resized.push_back(first + i);
    }
  if (space_) {
    const auto poses =
        space_->poses(world, static_cast<std::uint32_t>(clones_.size()), seed, world::places_of_tags(movers));
    for (std::size_t i = 0; i < poses.size(); ++i) world.movers[first + clones_[i]].X_WM = poses[i];
  }
  for (std::uint32_t i = 0; i < originals_.size(); ++i) place_given(world, first + i, given, first_given + i);
}

void Starts::check_row(const world::World& world, const sensorfarm::WorldStarts& given, std::size_t i) const {
  const world::Mover& mover = originals_[i % originals_.size()].mover;
  const auto refuse = [&](const std::string& what) {
    throw base::InputError(fmt::format(fmt::runtime(what), mover.name));
  };
  const auto in_range = [&](std::span<const double> values, const char* what, double least, double most) {
    if (values.empty() || std::isnan(values[i])) return;
    if (mover.is_tag) refuse(fmt::format("'{{}}' is not a robot, and has no {}", what));
    if (!(values[i] >= least && values[i] <= most))
      refuse(
          fmt::format("the {} of '{{}}' is {:g}; expected a number from {:g} to {:g}", what, values[i], least, most));
  };
  in_range(given.slip, "slip", 0.0, world::kMostSlip);
  in_range(given.acceleration, "acceleration", world::kLeastAcceleration, 1.0);
  in_range(given.noise, "noise", 0.0, 1.0);
  if (!given.acceleration.empty() && given.acceleration[i] < 1.0 && mover.max_acceleration == HUGE_VAL &&
      mover.max_turn_acceleration == HUGE_VAL)
    refuse("'{}' has no acceleration_bounds, which 'acceleration' lowers; expected them in its world file");
  if (!given.present.empty() && !std::isnan(given.present[i])) {
    if (given.present[i] != 0.0 && given.present[i] != 1.0)
      refuse(fmt::format("'present' of '{{}}' is {:g}; expected 0 or 1", given.present[i]));
    if (!mover.is_tag && given.present[i] == 0.0) refuse("'{}' is a robot, and cannot be missing");
  }
  if (given.sizes.empty() || std::isnan(given.sizes[i][0])) return;
  const auto& [x, y, z] = given.sizes[i];
  if (!base::is_shape_length(x) || !base::is_shape_length(y) || !base::is_shape_length(z))
    refuse(fmt::format("the size of '{{}}' is ({:g}, {:g}, {:g}); expected lengths above 0 and at most {:g} m", x, y, z,
                       base::kMostShapeSize));
  if (!mover.is_tag) refuse("the size of '{}' cannot change: it is a robot, whose controllers use that of the file");
  if (mover.body.empty()) refuse("the size of '{}' cannot change: it has no outline");
  const bool marked = std::ranges::find(world.fiducials, mover.model, &world::Fiducial::model) != world.fiducials.end();
  if (!mover.magnets.empty() || marked)
    refuse("the size of '{}' cannot change: its magnet, or its mark for fiducial finders, is at half of its height");
}

bool is_placeable(const sensorfarm::Pose& pose) {
  const double most = std::max({std::abs(pose.x), std::abs(pose.y), std::abs(pose.z), std::abs(pose.yaw)});
  return most <= 1e7 && !std::isnan(pose.x + pose.y + pose.z + pose.yaw);
}

void Starts::check(const world::World& world, const sensorfarm::WorldStarts& given, std::size_t rows) const {
  const auto check_size = [&](std::size_t size, const char* what) {
    if (size != 0 && size != rows)
      throw base::InputError(fmt::format("{} {} for {} rows; expected one per row, or none", size, what, rows));
  };
  check_size(given.poses.size(), "starts");
  check_size(given.present.size(), "entries of 'present'");
  check_size(given.sizes.size(), "sizes");
  check_size(given.slip.size(), "slips");
  check_size(given.acceleration.size(), "accelerations");
  check_size(given.noise.size(), "entries of 'noise'");
  for (const sensorfarm::Pose& start : given.poses)
    if (!std::isnan(start.x) && !is_placeable(start))
      throw base::InputError(
          "a start is not finite, or beyond 1e7; expected finite poses, or NaN for the start that the seed chooses");
  for (std::size_t i = 0; i < rows; ++i) check_row(world, given, i);
}

/// Replaces what the seed chose for a mover, except its size. @param i its entry in `given`
void Starts::place_given(world::World& world, std::uint32_t row, const sensorfarm::WorldStarts& given, std::size_t i) {
  const auto said = [&](std::span<const double> values) { return !values.empty() && !std::isnan(values[i]); };
  world::Mover& mover = world.movers[row];
  if (!given.poses.empty() && !std::isnan(given.poses[i].x)) {
    const auto& [x, y, z, yaw] = given.poses[i];
    mover.X_WM = {x, y, z, yaw};
  }
  if (said(given.present)) mover.absent = given.present[i] == 0.0;
  if (!said(given.slip) && !said(given.acceleration) && !said(given.noise)) return;
  world.variations.resize(world.movers.size());
  world::Variation& variation = world.variations[row];
  if (said(given.slip)) variation.slip = given.slip[i];
  if (said(given.acceleration)) variation.acceleration = given.acceleration[i];
  if (said(given.noise)) variation.noise = given.noise[i];
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
  std::vector<std::uint32_t> resized;
  for (std::uint32_t copy = 0; copy < world.copies; ++copy)
    starts.place(world, copy, options.seed + copy, {}, 0, resized);
  world::update_extent_and_hash(world);
  return {std::move(world), std::move(starts)};
}

void check_restart(const world::World& world, std::span<const std::uint32_t> worlds,
                   std::span<const std::uint64_t> seeds) {
  if (seeds.size() != worlds.size())
    throw base::InputError(fmt::format("{} seeds for {} worlds; expected as many", seeds.size(), worlds.size()));
  std::vector<bool> taken(world.copies);
  for (const std::uint32_t k : worlds) {
    if (k >= world.copies)
      throw base::InputError(fmt::format("there is no world {}; expected less than {}", k, world.copies));
    if (taken[k]) throw base::InputError(fmt::format("world {} is given twice; expected each once", k));
    taken[k] = true;
  }
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
