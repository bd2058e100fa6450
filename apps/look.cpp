// Commands that look without running: devices, check, draw, sense.

#include <algorithm>
#include <cstdio>
#include <limits>

#include "apps/commands.h"
#include "apps/facts.h"
#include "apps/lend.h"
#include "base/error.h"
#include "viz/world_figure.h"

namespace sf::apps {

namespace {

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

std::uint32_t find_robot(const world::World& world, const std::string& name) {
  std::string known;
  std::size_t others = 0;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) {
    const world::Mover& mover = world.movers[i];
    if (name.empty() ? !mover.lasers.empty() : mover.name == name) return i;
    if (mover.lasers.empty()) continue;
    if (++others <= 10) known += (known.empty() ? "" : ", ") + mover.name;
  }
  if (name.empty()) throw base::InputError(world.file, 0, "no robot has a sensor; give one a laser( ) or a ranger( )");
  if (others > 10) known += ", ... (" + std::to_string(others) + " in all)";
  throw base::InputError(world.file, 0,
                         "has no robot '" + name + "'; with sensors it has " + (known.empty() ? "none" : known));
}

void require_sensor(const world::World& world, const world::Mover& robot, std::uint32_t sensor) {
  const std::size_t count = robot.lasers.size();
  if (sensor < count) return;
  const std::string has = count == 0   ? "no sensor"
                          : count == 1 ? "one sensor, --sensor 0"
                                       : "sensors 0 to " + std::to_string(count - 1);
  throw base::InputError(world.file, 0,
                         robot.name + " has " + has + ", but --sensor " + std::to_string(sensor) + " was asked for");
}

}  // namespace

int devices(const Options& options) {
  const gpu::Survey survey = gpu::survey_devices(options.device);
  const bool any = std::any_of(survey.devices.begin(), survey.devices.end(), [](const auto& d) { return d.chosen; });
  print(options.json ? json_of(survey) : text_of(survey));
  // Opening it runs the self-check, and says in one line why there is none.
  const gpu::Device device(options.device);
  return any ? 0 : 3;
}

int check(const Options& options) {
  const world::World world = world::load_world(options.world, options.load);
  print(options.json ? json_of(world) : text_of(world));
  return 0;
}

int draw(const Options& options) {
  const world::World world = world::load_world(options.world, options.load);
  viz::draw_world(world, options.out);
  std::fprintf(stderr, "sensorfarm: wrote %s\n", options.out.c_str());
  return 0;
}

int sense(const Options& options) {
  const world::World world = load_with_robots(options.world, options.load, 0, options.seed);
  const std::uint32_t mover = find_robot(world, options.robot);
  const world::Mover& robot = world.movers[mover];
  require_sensor(world, robot, options.sensor);
  base::Pose X_WM = robot.X_WM;
  if (options.pose) X_WM = {options.pose->x, options.pose->y, X_WM.z, options.pose->yaw};

  gpu::Device device(options.device);
  farm::FarmOptions quiet;
  quiet.noise = false;
  farm::Farm farm(world, device, quiet);
  base::ReadingBlock reading = farm.sense(mover, options.sensor, X_WM);
  std::vector<double> ranges(reading.values.begin(), reading.values.end());
  for (std::size_t i = 0; i < ranges.size(); ++i)
    if (options.no_return_inf && reading.hits[i] == base::kNoHit && ranges[i] >= robot.lasers[options.sensor].range_max)
      ranges[i] = std::numeric_limits<double>::infinity();
  reading.values = ranges;
  if (!options.json) std::fprintf(stderr, "sensorfarm: %s\n", place_of(world, reading).c_str());
  print(options.json ? json_of(world, reading) : text_of(world, reading));
  return 0;
}

}  // namespace sf::apps
