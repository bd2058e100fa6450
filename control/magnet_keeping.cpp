#include "control/magnet_keeping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sensors/magnetometer.h"

namespace sf::control {

namespace {

// [Gauss]; not a number where there are not two elements.
double difference(const base::ReadingBlock& reading) {
  constexpr std::size_t kColumns = sensors::kMagnetometerColumns;
  if (reading.values.size() < 2 * kColumns) return std::numeric_limits<double>::quiet_NaN();
  const std::size_t last = reading.values.size() / kColumns - 1;
  return (reading.values[last * kColumns] - reading.values[0]) / sensors::kGauss;
}

}  // namespace

MagnetKeeping::MagnetKeeping(const MagnetSettings& settings, const PathTask& task)
    : settings_(settings), task_(task), law_(settings.gains), hold_(settings.hold), error_(Controller::error()) {}

base::Twist MagnetKeeping::step(const Input& input) {
  error_ = Controller::error();
  if (done_ || (done_ = task_.ended(input.state.X_WM))) return {};
  const base::ReadingBlock* reading = newest(input, sensors::kMagnetometer);
  const bool speaks = hold_.speaks(reading, input.time);
  const double now = speaks && reading != nullptr ? difference(*reading) : Controller::error();
  error_ = hold_.keep(now, input.time);
  if (!std::isfinite(error_)) return {};
  return {settings_.speed, 0.0, std::isfinite(now) ? law_.steer(now, input.time) : law_.keep(error_)};
}

namespace {

/// @throws base::InputError where there are not two elements to compare.
void require_array(const world::Mover& mover) {
  const auto found = std::find_if(mover.sensors.begin(), mover.sensors.end(),
                                  [](const world::Sensor& sensor) { return sensor.type == "magnetometer"; });
  if (found == mover.sensors.end())
    throw base::InputError(fmt::format(
        "controller 'magnet-keeping': '{}' has no magnetometers; give it a magnetometer( ) in the world file",
        mover.name));
  if (sensors::read_magnetometer(*found).X_SE.size() < 2)
    throw base::InputError(
        fmt::format("controller 'magnet-keeping': '{}' has an array of one magnetometer; give it two or more (scount)",
                    mover.name));
}

std::unique_ptr<Controller> make_magnet_keeping(const Site& site, Settings& settings) {
  require_array(site.world.movers[site.mover]);
  MagnetSettings magnet;
  magnet.gains = read_gains(settings, magnet.gains);
  magnet.speed = settings.number("speed", magnet.speed, 0.0, site.world.movers[site.mover].max_forward);
  magnet.hold = settings.number("hold", magnet.hold, 0.0, 1e6);
  return std::make_unique<MagnetKeeping>(magnet, PathTask(site, settings));
}

}  // namespace

constinit const ControllerKind magnet_keeping_controller{
    .name = "magnet-keeping",
    .summary = "follows a line of magnets by an array of magnetometers, with P or PI steering",
    .rate = 10.0,
    .waits = true,
    .make = make_magnet_keeping,
};

}  // namespace sf::control
