#include "scenarios/lane_camera_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"
#include "base/error.h"
#include "scenarios/scenario_events.h"
#include "scenarios/simulation.h"
#include "scenarios/trial.h"
#include "sensors/sensor_type.h"
#include "world/roads/roads.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {

namespace {

constexpr LaneVariant kVariants[] = {
    {.name = "lane edge sensor", .camera = false, .drawn = true},
    {.name = "camera", .drawn = true},
    {.name = "distorted lens, 110 degrees", .keys = "fov 110 distortion [-0.12 0.01 0.001 -0.001]"},
    {.name = "fisheye, 150 degrees", .keys = "fov 150 fisheye [0.02 -0.004 0 0]"},
    {.name = "160 x 120 pixels", .keys = "resolution [160 120]"},
    {.name = "80 x 60 pixels", .keys = "resolution [80 60]"},
    {.name = "exposure of 0.1 s", .keys = "exposure 0.1 samples 8"},
    {.name = "rolling shutter, 0.08 s", .keys = "rolling 1 scan_time 0.08"},
    {.name = "noise of 2 %, and photons", .keys = "noise [0.02 0.002]"},
    {.name = "noise of 10 %, and photons", .keys = "noise [0.1 0.01]"},
    {.name = "noise of 30 %, and photons", .keys = "noise [0.3 0.03]"},
    {.name = "30 Hz", .keys = "rate 30"},
    {.name = "5 Hz", .keys = "rate 5"},
    {.name = "2 Hz", .keys = "rate 2"},
    {.name = "1 Hz", .keys = "rate 1"},
    {.name = "all: lens, 160 x 120, 0.05 s, 5 %, 5 Hz",
     .keys = "fov 110 distortion [-0.12 0.01 0.001 -0.001] resolution [160 120] exposure 0.05 samples 8 "
             "noise [0.05 0.005] rate 5",
     .drawn = true},
    {.name = "0.5 m/s: lane edge sensor", .camera = false, .fast = true},
    {.name = "0.5 m/s: camera", .fast = true},
    {.name = "0.5 m/s: exposure of 0.1 s", .keys = "exposure 0.1 samples 8", .fast = true},
    {.name = "0.5 m/s: 2 Hz", .keys = "rate 2", .fast = true},
    {.name = "a lap with five crossings, 160 x 120", .keys = "resolution [160 120]", .lap = true},
};

constexpr double kFast = 0.5;  // [m/s] the largest speed of a Create
constexpr std::string_view kLanes[] = {"2.1", "3.1", "4.1", "5.1", "1.1"};
constexpr double kHalfLane = 0.25;  // [m]
constexpr double kNearFace =
    0.5 * 0.3048 / 7.0;             // [m] of a double line from the lane's edge: half of three 4-inch lines
constexpr double kBeforeEnd = 0.5;  // [m] where a run of one lane ends
constexpr double kTimeOfLap = 7.0;  // of that of one lane

/// Returns settings as the world file would have them.
std::vector<world::Setting> camera_settings_of(std::string_view keys) {
  const std::string text = fmt::format("position( camera( rgb 1 {} ) )", keys);
  return world::build_world("lane-camera", text, {.sensors = sensors::world_file_words()})
      .movers[0]
      .sensors[0]
      .settings;
}

void change_camera(world::Sensor& camera, std::string_view keys) {
  for (world::Setting& setting : camera_settings_of(keys)) {
    std::erase_if(camera.settings, [&](const world::Setting& old) { return old.key == setting.key; });
    camera.settings.push_back(std::move(setting));
  }
}

/// Projects a point onto the course. `left` of the result is the signed distance to the curve, positive on the left.
world::CurvePlace place_on(const world::Curve& curve, glm::dvec2 p) {
  world::CurvePlace place = world::place_beside(curve.points, curve.s, p);
  place.left = std::copysign(place.away, place.left);
  return place;
}

void drive_by(const LaneVariant& variant, control::ControllerConfig& controller) {
  control::Settings& given = controller.settings;
  const double speed = given.number("speed", 0.1, 0.0, 10.0), hold = given.number("hold", 1.0, 0.0, 60.0);
  std::vector<control::Setting> settings{{"speed", variant.fast ? kFast : speed, ""}};
  if (variant.lap) settings.push_back({"hold", hold, ""});
  if (!variant.camera) settings.push_back({"half_width", kHalfLane - kNearFace, ""});
  controller.name = variant.camera ? "lane-camera" : "lane-keeping";
  controller.settings = {"controller '" + controller.name + "'", std::move(settings)};
}

}  // namespace

std::span<const LaneVariant> lane_variants() { return kVariants; }

std::uint32_t probe_of(const world::World& world) {
  const auto found = std::ranges::find(world.movers, "probe", &world::Mover::name);
  if (found == world.movers.end()) throw base::InputError(world.file, 0, "has no car 'probe'; expected one");
  return static_cast<std::uint32_t>(found - world.movers.begin());
}

LaneCourse lane_course(const world::World& world) {
  const auto roads = world::roads_of(world);
  LaneCourse course;
  world::Curve& middle = course.middle;
  for (const std::string_view name : kLanes) {
    const world::RoadLane* lane = nullptr;
    if (roads)
      for (const world::RoadLane& each : roads->lanes)
        if (world::lane_name(*roads, each) == name) lane = &each;
    if (lane == nullptr)
      throw base::InputError(world.file, 0, fmt::format("has no lane {}; expected SimVille's roads", name));
    for (const glm::dvec2& p : lane->centre.points) {
      middle.s.push_back(middle.points.empty() ? 0.0 : middle.s.back() + glm::distance(middle.points.back(), p));
      middle.points.push_back(p);
    }
    if (course.first_lane == 0.0) course.first_lane = middle.s.back();
  }
  return course;
}

base::Pose pose_on(const LaneCourse& course, double s) {
  const world::Curve& middle = course.middle;
  const auto next = std::ranges::upper_bound(middle.s, s) - middle.s.begin();
  const std::size_t i = std::clamp<std::ptrdiff_t>(next, 1, std::ssize(middle.s) - 1);
  const glm::dvec2 a = middle.points[i - 1], along = middle.points[i] - a,
                   p = a + (s - middle.s[i - 1]) / glm::length(along) * along;
  return {p.x, p.y, 0.0, base::atan2(along.y, along.x)};
}

double lane_error(const LaneCourse& course, const base::Pose& X_WM, double ahead) {
  const world::CurvePlace at = place_on(course.middle, base::transform(X_WM, glm::dvec2{ahead, 0.0}));
  return -at.left / base::cos(base::wrap_angle(X_WM.yaw - at.yaw));
}

world::World lane_world(const Scenario& scenario, const LaneVariant& variant) {
  world::World world = disturbed_world(scenario, {});
  std::vector<world::Sensor>& sensors = world.movers[probe_of(world)].sensors;
  std::erase_if(sensors, [&](const world::Sensor& sensor) { return (sensor.type == "camera") != variant.camera; });
  if (variant.camera && sensors.empty())
    throw base::InputError(world.file, 0, "its 'probe' has no camera; expected one");
  if (variant.camera) change_camera(sensors.front(), variant.keys);
  world::update_extent_and_hash(world);
  return world;
}

LaneRun run_lane(const Scenario& scenario, const LaneVariant& variant, gpu::Device& device, unsigned threads,
                 const std::function<bool()>& stop) {
  world::World world = lane_world(scenario, variant);
  const std::uint32_t probe = probe_of(world);
  const LaneCourse course = lane_course(world);
  SimulationOptions options = simulation_of(scenario, world);
  options.threads = threads;
  drive_by(variant, options.actors[probe].controller);
  Simulation simulation(world, device, std::move(options));
  ScenarioEvents events(scenario);
  const double end = (variant.lap ? course.middle.s.back() : course.first_lane) - kBeforeEnd,
               most = (variant.lap ? kTimeOfLap : 1.0) * scenario.duration;
  LaneRun run;
  while (run.seconds < most && !run.arrived && !run.left_lane) {
    if (stop && stop()) throw Interrupted();
    events.apply(simulation, world, run.seconds, [](std::uint32_t) {});
    const base::TickRecord tick = simulation.step();
    run.seconds = 1e-9 * static_cast<double>(tick.time);
    if (!simulation.stepped(probe)) continue;
    const base::Pose& X_WM = tick.reports[probe].X_WM;
    const world::CurvePlace at = place_on(course.middle, {X_WM.x, X_WM.y});
    run.s.push_back(at.s), run.offsets.push_back(at.left);
    run.headings.push_back(base::wrap_angle(X_WM.yaw - at.yaw));
    run.errors.push_back(simulation.status(probe).error - lane_error(course, X_WM));
    run.left_lane = std::abs(at.left) > kHalfLane;
    run.arrived = at.s >= end;
  }
  return run;
}

}  // namespace sf::scenarios
