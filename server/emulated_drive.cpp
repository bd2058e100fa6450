#include "server/emulated_drive.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "base/elementary.h"
#include "base/error.h"
#include "control/own_dynamics.h"
#include "netio/own_readings.h"

namespace sf::server {

namespace {

constexpr double kSamePlace = 1e-6;  // [m], [rad]

std::uint32_t robot_in(const std::shared_ptr<const world::World>& given, const std::string& name) {
  SF_CHECK(given != nullptr, "no world of the emulated robot '" + name + "'");
  const world::World& world = *given;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (world.movers[row].name == name) return row;
  throw base::InputError(
      fmt::format("{}: the real world has no robot '{}'; expected it there, with its own sensors", world.file, name));
}

std::string pose_text(const base::Pose& X) {
  return fmt::format("[{:g} {:g} {:g} {:g}]", X.x, X.y, X.z, X.yaw * 180.0 / M_PI);
}

}  // namespace

EmulatedDrive::EmulatedDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM, double)
    : RealRobot(type, options, X_WM),
      world_(options.world),
      mover_(robot_in(world_, options.device)),
      device_(std::string(gpu::kHostDevice)),
      farm_(*world_, device_, {.seed = options.seed, .threads = 1}),
      body_(*world_, mover_) {
  if (auto dynamics = control::make_own_dynamics(*world_, mover_)) body_.set_dynamics(std::move(dynamics));
  const base::Pose& X = world_->movers[mover_].X_WM;
  if (base::hypot(X.x - X_WM.x, X.y - X_WM.y, base::wrap_angle(X.yaw - X_WM.yaw)) > kSamePlace)
    throw base::InputError(
        fmt::format("{}: '{}' starts at {} in the real world, and at {} in the farm's; expected the "
                    "same pose",
                    world_->file, options.device, pose_text(X), pose_text(X_WM)));
  farm_.subscribe(mover_, base::only(netio::kOwnLaser) | base::only(netio::kOwnSonar) |
                              base::only(netio::kOwnInfrared) | base::only(netio::kOwnBumper));
}

/// Its odometry is exact.
void EmulatedDrive::run(std::int64_t now) {
  heard(now);
  const base::Pose before = body_.state().X_WM;
  body_.move(command_, now);
  const base::Pose& after = body_.state().X_WM;
  const double turn = base::wrap_angle(after.yaw - before.yaw), middle = before.yaw + 0.5 * turn;
  advance((after.x - before.x) * base::cos(middle) + (after.y - before.y) * base::sin(middle), turn);
  touch(body_.contact());
  if (farm_.next_due() <= now) measure(now);
}

void EmulatedDrive::measure(std::int64_t now) {
  for (const base::ReadingBlock& reading : farm_.tick(now, {&body_.state(), 1})) {
    const sensors::SensorSpec& row = farm_.sensor_set().row(reading);
    measured({.type = reading.type,
              .time = reading.time,
              .values = {reading.values.begin(), reading.values.end()},
              .limit = reading.type == netio::kOwnBumper ? HUGE_VAL : row.limit,
              .fov = row.fov,
              .sensor = static_cast<std::uint16_t>(reading.sensor)});
  }
}

}  // namespace sf::server
