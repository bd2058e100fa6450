#include "selftest/fixture.h"

#include <algorithm>
#include <cmath>

#include "raycast/casters.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"

namespace sf::selftest {

const sensors::LaserSettings& laser_of(const TestFarm& test, const base::ReadingBlock& scan) {
  return test.farm->sensor_set().settings_of<sensors::CastLaser>(sensors::kLaser, scan.mover)[scan.sensor].laser;
}

double allowed_from_plain_cpp(const Fixture& fixture, const TestFarm& test, const base::ReadingBlock& scan) {
  if (casts_any_world(fixture)) return 0.0;
  const double range_max = laser_of(test, scan).range_max;
  const double farthest = std::max(std::abs(scan.X_WS.x), std::abs(scan.X_WS.y)) + range_max;
  return scan.bound_without_noise +
         sensors::laser_bound(range_max, false, sensors::reaches_of(*test.world).longest, farthest);
}

void check_range(double got, double plain_cpp, double allowed, Checks& checks, std::string_view what, std::uint64_t i) {
  allowed > 0.0 ? checks.near(got, plain_cpp, allowed, what, i) : checks.same(got, plain_cpp, what, i);
}

bool casts_any_world(const Fixture& fixture) {
  return raycast::choose_caster(fixture.device().info().software).same_bytes;
}

TestFarm Fixture::measure(world::World world, farm::FarmOptions options) const {
  // Small pools are fast to create. They grow if a case needs more, and do not affect readings.
  options.scene = {.pool_chunks = 1u << 12, .pool_cells = 1u << 7};
  TestFarm test;
  test.world = std::make_unique<world::World>(std::move(world));
  test.farm = std::make_unique<farm::Farm>(*test.world, device_, options);
  test.farm->thread_pool().interrupt_on(stop_);
  test.farm->subscribe_all();
  test.readings = test.farm->tick(0, {});
  return test;
}

namespace {

std::uint32_t add_model(world::World& world, const std::string& type) {
  const auto row = static_cast<std::uint32_t>(world.models.size());
  world.models.push_back({type + std::to_string(row), type});
  return row;
}

world::Segment segment(glm::dvec2 a, glm::dvec2 b, std::uint32_t model) {
  world::Segment s;
  s.a = a;
  s.b = b;
  s.z_max = 1.0;
  s.model = model;
  return s;
}

}  // namespace

void add_wall(world::World& world, glm::dvec2 a, glm::dvec2 b) {
  world.walls.push_back(segment(a, b, add_model(world, "model")));
  world.walls.back().solid_left = false;
}

void add_outline(world::World& world, const std::vector<glm::dvec2>& corners) {
  const std::uint32_t model = add_model(world, "model");
  for (std::size_t i = 0; i < corners.size(); ++i)
    world.walls.push_back(segment(corners[i], corners[(i + 1) % corners.size()], model));
}

void add_room(world::World& world, glm::dvec2 low, double width) {
  const glm::dvec2 high = low + glm::dvec2{width, width};
  const glm::dvec2 thick{0.25 * width, 0.25 * width};
  add_block(world, low - thick, high + thick);
  add_outline(world, {low, {low.x, high.y}, high, {high.x, low.y}});
}

void add_block(world::World& world, glm::dvec2 low, glm::dvec2 high) {
  add_outline(world, {low, {high.x, low.y}, high, {low.x, high.y}});
}

sensors::LaserSettings laser(std::uint32_t samples, double fov, double range_max) {
  sensors::LaserSettings laser;
  laser.name = "eye";
  laser.X_MS.z = 0.1;
  laser.samples = samples;
  laser.fov = fov;
  laser.range_max = range_max;
  return laser;
}

std::uint32_t add_mover(world::World& world, const Pose& X_WM) {
  world::Mover mover;
  const auto row = static_cast<std::uint32_t>(world.movers.size());
  mover.name = "robot" + std::to_string(row);
  mover.id = row;
  mover.model = add_model(world, "position");
  mover.X_WM = X_WM;
  world.models.back().mover = row;
  world.movers.push_back(std::move(mover));
  return row;
}

std::uint32_t add_laser_mover(world::World& world, const Pose& X_WM, const sensors::LaserSettings& laser) {
  const std::uint32_t row = add_mover(world, X_WM);
  world.movers[row].sensors.push_back(sensors::laser_sensor(laser));
  return row;
}

void add_body(world::World& world, std::uint32_t mover, double half) {
  world::Mover& m = world.movers[mover];
  const glm::dvec2 corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  for (std::size_t i = 0; i < 4; ++i) m.body.push_back(segment(corners[i], corners[(i + 1) % 4], m.model));
  m.radius = std::hypot(half, half);
}

world::Sensor sensor(const std::string& type, const Settings& settings, double height) {
  world::Sensor sensor;
  sensor.type = type;
  sensor.name = type;
  sensor.X_MS.z = height;
  sensor.radians_per_unit = M_PI / 180.0;
  sensor.file = "extremes";
  sensor.line = 1;
  for (const auto& [key, numbers] : settings) sensor.settings.push_back({key, numbers, "", 1, sensor.file});
  return sensor;
}

}  // namespace sf::selftest
