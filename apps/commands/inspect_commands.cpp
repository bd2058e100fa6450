// Commands that inspect without running: devices, check, draw, sense.

#include <algorithm>
#include <set>

#include "apps/commands/commands.h"
#include "apps/commands/road_commands.h"
#include "apps/options/default_robot.h"
#include "apps/options/open_device.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/rate_warnings.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/box.h"
#include "base/error.h"
#include "base/installation.h"
#include "robots/fleet.h"
#include "sensors/camera.h"
#include "sensors/laser_noise.h"
#include "viz/png.h"
#include "viz/world_figure.h"
#include "world/free_space.h"
#include "world/ground.h"

namespace sf::apps {

namespace {

constexpr double kArea = 2.0;  ///< smallest width and height of walls that count as an enclosure

/// True if the mover has a sensor of that type; type 0 matches any.
bool has_type(const sensors::SensorSet& sensor_set, std::uint8_t type, std::uint32_t mover) {
  return type == 0 ? sensor_set.count_of(mover) > 0 : !sensor_set.of(type, mover).empty();
}

[[noreturn]] void refuse_blind_world(const world::World& world, std::uint8_t type) {
  std::vector<std::string> words;
  for (const sensors::SensorType* known : sensors::sensor_types())
    if (type == 0 || known->id == type)
      words.push_back((std::string_view("aeio").find(known->name.front()) != std::string_view::npos ? "an " : "a ") +
                      std::string(known->name) + "( )");
  throw base::InputError(world.file, 0, "no robot has such a sensor; give one " + join_or(words));
}

std::uint32_t find_robot(const world::World& world, const sensors::SensorSet& sensor_set, const SenseOptions& options) {
  std::vector<std::string_view> names;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) {
    const bool senses = has_type(sensor_set, options.type, i);
    if (options.robot.empty() ? senses : world.movers[i].name == options.robot) return i;
    if (senses) names.push_back(world.movers[i].name);
  }
  if (options.robot.empty()) refuse_blind_world(world, options.type);
  throw base::InputError(world.file, 0,
                         "has no robot '" + options.robot + "'; robots with sensors: " + list_names(names));
}

/// "laser 0 to 2, magnetometer 0".
std::string all_sensors_of(const sensors::SensorSet& sensor_set, std::uint32_t mover) {
  std::string text;
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    const std::size_t count = sensor_set.of(group.type->id, mover).size();
    if (count == 0) continue;
    text += (text.empty() ? "" : ", ") + std::string(group.type->name) + " 0";
    if (count > 1) text += " to " + std::to_string(count - 1);
  }
  return text;
}

/// A sensor, given by its type and its index among the mover's sensors of that type.
struct Chosen {
  const sensors::SensorType* type = nullptr;
  std::uint32_t sensor = 0;
};

/// If a type was given, the number counts sensors of that type; otherwise it counts all sensors of the mover, type by
/// type.
Chosen find_sensor(const sensors::SensorSet& sensor_set, const SenseOptions& options, std::uint32_t mover) {
  std::uint32_t number = options.sensor;
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    if (options.type != 0 && group.type->id != options.type) continue;
    const auto count = static_cast<std::uint32_t>(sensor_set.of(group.type->id, mover).size());
    if (number < count) return {group.type, number};
    number -= count;
  }
  return {};
}

/// Returns the requested sensor. Ends with an error if it does not exist.
Chosen require_sensor(const world::World& world, const sensors::SensorSet& sensor_set, const SenseOptions& options,
                      std::uint32_t mover) {
  const Chosen chosen = find_sensor(sensor_set, options, mover);
  if (chosen.type != nullptr) return chosen;
  const std::string has = all_sensors_of(sensor_set, mover);
  const std::string& robot = world.movers[mover].name;
  if (has.empty()) throw base::InputError(world.file, 0, robot + " has no sensor");
  const sensors::SensorType* type = sensors::find_sensor_type(options.type);
  throw base::InputError(world.file, 0,
                         robot + " has no " + std::string(type != nullptr ? type->name : "sensor") + " " +
                             std::to_string(options.sensor) + "; it has " + has + " (--type, --sensor)");
}

/// Describes a position outside of enclosing walls, for example one given in millimetres; "" if there is no problem.
std::string beyond_walls(const world::World& world, const base::Pose& X) {
  base::Box walls = base::empty_box();
  for (const world::Segment& wall : world.walls) walls = base::united(walls, base::box_of(wall.a, wall.b));
  const glm::dvec2 p{X.x, X.y}, size = walls.max - walls.min;
  if (!(std::min(size.x, size.y) >= kArea) || base::meet(walls, base::box_of(p, p))) return "";
  return fmt::format("outside all walls (x {:g} to {:g} m, y {:g} to {:g} m)", walls.min.x, walls.max.x, walls.min.y,
                     walls.max.y);
}

void warn_of_pose(const world::World& world, const world::Mover& robot, const base::Pose& X_WM) {
  std::string where = world::PlaceCheck(world).problem(robot, X_WM);
  if (where.empty()) where = beyond_walls(world, X_WM);
  if (!where.empty()) print_message("warning: at ({:g}, {:g}) '{}' is {}", X_WM.x, X_WM.y, robot.name, where);
}

/// Warns of labels that 16 bits cannot state.
void warn_of_labels(const base::ReadingBlock& reading) {
  const std::uint64_t beyond = labels_beyond(reading);
  if (beyond > 0)
    print_message("warning: {} show models whose number exceeds {}, so their label is {} too; --json names them",
                  counted(beyond, "pixel"), kLargestLabel - 2, kLargestLabel);
}

void write_image(const world::World& world, const sensors::SensorSet& sensor_set, const base::ReadingBlock& reading,
                 const SenseOptions& options) {
  const std::string& name = sensor_set.row(reading).name;
  if (reading.type != sensors::kCamera)
    throw base::InputError(world.file, 0,
                           fmt::format("'{}' is no camera; expected one for --image (--type camera)", name));
  const auto cameras = sensor_set.settings_of<sensors::CameraSettings>(sensors::kCamera, reading.mover);
  const sensors::CameraSettings& camera = cameras[reading.sensor];
  if (options.image == ImageKind::normals && !camera.normals)
    throw base::InputError(world.file, 0, fmt::format("'{}' has no normals; expected 'normals 1' in the camera", name));
  if (options.image == ImageKind::colour && (!camera.rgb || camera.mono))
    throw base::InputError(world.file, 0, fmt::format("'{}' has no colours; expected 'rgb 1' in the camera", name));
  if (options.image == ImageKind::mono && !camera.mono)
    throw base::InputError(world.file, 0, fmt::format("'{}' is not grey; expected 'mono 1' in the camera", name));
  viz::write_picture(options.out, camera_file(camera, reading, *options.image, is_jpeg(options.out)));
  print_message("wrote {}", options.out);
  if (options.image == ImageKind::labels) warn_of_labels(reading);
}

/// A fleet reads the settings of its cars.
void check_dynamics(const world::World& world) {
  std::set<std::string> plugins;
  for (const world::Mover& mover : world.movers)
    if (base::names_a_plugin(mover.dynamics.name) && plugins.insert(mover.dynamics.name).second)
      print_message("warning: {}the plug-in '{}' is not checked; `run` loads it", mover.dynamics.at,
                    mover.dynamics.name);
  const auto is_car = [](const world::Mover& mover) { return mover.dynamics.name == "car"; };
  if (std::ranges::any_of(world.movers, is_car)) robots::Fleet{world};
}

}  // namespace

int devices(const DevicesOptions& options) {
  const gpu::DeviceList list = gpu::list_devices(options.device, options.require_vulkan);
  const bool any = std::any_of(list.devices.begin(), list.devices.end(), [](const auto& d) { return d.chosen; });
  print(options.json ? device_list_json(list) : device_list_text(list));
  // Prints one line if there is no device, or if the host is used.
  const gpu::Device device = open_device(options);
  return any ? 0 : 3;
}

int check(const CheckOptions& options) {
  if (const auto code = check_roads(options)) return *code;
  const world::World world = world::load_world(options.world, options.load);
  const sensors::SensorSet sensor_set(world);
  check_dynamics(world);
  warn_of_many_times(sensor_set);
  if (options.rate > 0.0) warn_of_fast_sensors(sensor_set, options.rate);
  print(options.json ? world_report_json(world, sensor_set) : world_report_text(world, sensor_set));
  return 0;
}

int draw(const DrawOptions& options) {
  install_stop_handlers();
  if (const auto code = draw_roads(options)) return *code;
  const world::World world = world::load_world(options.world, options.load);
  print_warnings(options.world, world.warnings);
  heed_stop("interrupted: nothing was written");
  viz::draw_world(world, options.out, options.page);
  print_message("wrote {}", options.out);
  return 0;
}

int sense(const SenseOptions& options) {
  world::World world = load_with_robots(options);
  const sensors::SensorSet sensor_set(world);
  const std::uint32_t mover = find_robot(world, sensor_set, options);
  const Chosen chosen = require_sensor(world, sensor_set, options, mover);
  base::Pose& X_WM = world.movers[mover].X_WM;
  const bool stands = !options.pose || !options.pose->has_height;
  if (options.pose)
    X_WM = stands ? world::Ground(world.ramps, world.terrain).stand(X_WM, options.pose->X) : options.pose->X;
  const base::Tilt tilt = stands ? robots::states_at_load(world)[mover].tilt : options.pose->tilt;
  if (options.pose) warn_of_pose(world, world.movers[mover], X_WM);

  gpu::Device device = open_device(options);
  farm::FarmOptions quiet;
  quiet.noise = false;
  farm::Farm farm(world, device, quiet);
  base::ReadingBlock reading = farm.sense(mover, chosen.type->id, chosen.sensor, X_WM, tilt);
  std::vector<double> values(reading.values.begin(), reading.values.end());
  if (options.no_return_inf) sensors::mark_no_return(reading, sensor_set.row(reading).limit, values);
  if (!options.json && !options.too_near_min) base::mark_too_near(reading.quality, values);
  reading.values = values;
  if (options.image) write_image(world, sensor_set, reading, options);
  if (options.image && !options.json) return 0;
  if (!options.json) print_message(place_of(world, sensor_set, reading));
  print(options.json ? with_warnings(reading_json(world, sensor_set, reading), world.warnings)
                     : reading_csv(world, sensor_set, reading));
  return 0;
}

}  // namespace sf::apps
