#include "control/magnet_keeping.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "sensors/magnetometer.h"

namespace sf::control {

MagnetKeeping::MagnetKeeping(const MagnetSettings& settings, const PathTask& task)
    : PathFollower(sensors::kMagnetometer, "magnetometers", settings.gains, settings.speed, settings.hold, task) {}

double MagnetKeeping::error_of(const base::ReadingBlock& reading, const base::Pose&) const {
  constexpr std::size_t kColumns = sensors::kMagnetometerColumns;
  if (reading.values.size() < 2 * kColumns) return Controller::error();
  const std::size_t last = reading.values.size() / kColumns - 1;
  return (reading.values[last * kColumns] - reading.values[0]) / sensors::kGauss;
}

namespace {

/// @throws base::InputError for a robot without an array of at least two magnetometers
void require_array(const ControllerContext& context) {
  const world::Mover& mover = context.world.movers[context.mover];
  const std::vector<sensors::SensorSpec> arrays = context.sensors_of(sensors::kMagnetometer);
  if (arrays.empty())
    throw base::InputError(fmt::format(
        "controller 'magnet-keeping': '{}' has no magnetometers; give it a magnetometer( ) in the world file",
        mover.name));
  if (arrays.front().elements < 2)
    throw base::InputError(
        fmt::format("controller 'magnet-keeping': '{}' has an array of one magnetometer; give it two or more (scount)",
                    mover.name));
}

std::unique_ptr<Controller> make_magnet_keeping(const ControllerContext& context, Settings& settings) {
  require_array(context);
  MagnetSettings magnet;
  magnet.gains = read_gains(settings, magnet.gains);
  magnet.speed = settings.number("speed", magnet.speed, 0.0, context.world.movers[context.mover].max_forward);
  magnet.hold = settings.number("hold", magnet.hold, 0.0, 1e6);
  return std::make_unique<MagnetKeeping>(magnet, PathTask(context, settings));
}

}  // namespace

constinit const ControllerType magnet_keeping_controller{
    .name = "magnet-keeping",
    .summary = "follows a line of magnets with an array of magnetometers, with P or PI steering",
    .rate = 10.0,
    .stops_on_bumper = true,
    .make = make_magnet_keeping,
};

}  // namespace sf::control
