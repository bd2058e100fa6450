#include "control/lane_keeping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "sensors/laneedge.h"

namespace sf::control {

LaneKeeping::LaneKeeping(const LaneSettings& settings, const PathTask& task)
    : PathFollower(sensors::kLaneEdge, "lane edge sensor", settings.gains, settings.speed, settings.hold, task),
      settings_(settings) {
  SF_CHECK(settings.half_width || task.known(), "a lane of unknown width");
}

double LaneKeeping::error_of(const base::ReadingBlock& reading, const base::Pose& X_WM) const {
  if (reading.values.empty() || !std::isfinite(reading.values[0])) return Controller::error();
  const glm::dvec2 p_WS = base::transform(X_WM, settings_.p_MS);
  const double half = settings_.half_width ? *settings_.half_width : 0.5 * task().width_at(p_WS);
  const double edge = reading.values[0] + settings_.side * settings_.p_MS.y;  // measured from the robot's axis
  return settings_.side * (edge - half);
}

namespace {

constexpr double kLeastAhead = 0.1;  // [m] lower bound of the sensor's distance ahead
constexpr double kMostAhead = 2.0;   // [rad/s] upper bound of gain times distance ahead, for stability at 10 Hz

}  // namespace

// A unicycle at speed v whose error is measured l ahead of it obeys e'' + kp l e' + kp v e = 0. The damping ratio is 1
// / sqrt(2) for kp = 2 v / l^2. Player's driver for the Create turns twice as much as commanded.
double damped_gain(const world::Mover& mover, double ahead, double speed) {
  const double l = std::max(ahead, kLeastAhead);
  const double gain = std::min(2.0 * speed / (l * l), kMostAhead / l);
  return mover.actuator_model == world::ActuatorModel::player_create ? 0.5 * gain : gain;
}

namespace {

const world::Sensor* find_sensor(const world::Mover& mover) {
  const auto found = std::find_if(mover.sensors.begin(), mover.sensors.end(),
                                  [](const world::Sensor& sensor) { return sensor.type == "laneedge"; });
  return found == mover.sensors.end() ? nullptr : &*found;
}

std::unique_ptr<Controller> make_lane_keeping(const ControllerContext& context, Settings& settings) {
  const world::Mover& mover = context.world.movers[context.mover];
  const world::Sensor* sensor = find_sensor(mover);
  if (sensor == nullptr)
    throw base::InputError(
        fmt::format("controller 'lane-keeping': '{}' has no lane edge sensor; give it a laneedge( ) in the world file",
                    mover.name));
  const PathTask task(context, settings);
  LaneSettings lane;
  lane.speed = settings.number("speed", std::min(lane.speed, mover.max_forward), 0.0, mover.max_forward);
  lane.p_MS = {sensor->X_MS.x, sensor->X_MS.y};
  lane.gains = read_gains(settings, {.kp = damped_gain(mover, lane.p_MS.x, lane.speed)});
  lane.hold = settings.number("hold", lane.hold, 0.0, 1e6);
  if (settings.has("half_width")) lane.half_width = settings.number("half_width", 0.0, 1e-3, 1e3);
  if (!lane.half_width && !task.known())
    settings.refuse("half_width",
                    "'lane-keeping' requires the lane's width, but the world has no path; expected a path( ... ) in "
                    "the world file, or the setting 'half_width' [m]");
  lane.side = base::sin(sensor->X_MS.yaw) < 0.0 ? -1.0 : 1.0;
  const std::string side = settings.choice("side", lane.side > 0.0 ? "left" : "right", {"left", "right"});
  lane.side = side == "left" ? 1.0 : -1.0;
  return std::make_unique<LaneKeeping>(lane, task);
}

}  // namespace

constinit const ControllerType lane_keeping_controller{
    .name = "lane-keeping",
    .summary = "follows a lane by its painted edge, with P or PI steering",
    .rate = 10.0,
    .stops_on_bumper = true,
    .make = make_lane_keeping,
};

}  // namespace sf::control
