#include "control/docking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "control/go.h"
#include "sensors/irreceiver.h"

namespace sf::control {

namespace {

using sensors::kDockByte, sensors::kNoIrByte, sensors::kRedBuoy, sensors::kGreenBuoy, sensors::kForceField;

std::uint32_t light_in(const base::ReadingBlock* reading) {
  if (reading == nullptr || reading->values.size() < 2) return 0;
  const double byte = reading->values[1];
  return byte > kDockByte && byte < kNoIrByte ? static_cast<std::uint32_t>(byte) - kDockByte : 0;
}

}  // namespace

base::Twist Docking::step(const Input& input) {
  const base::Pose& X_WM = input.state.X_WM;
  const std::uint32_t light = light_in(newest(input, sensors::kIrReceiver));
  const double far = std::hypot(X_WM.x - settings_.X_WD.x, X_WM.y - settings_.X_WD.y);
  const bool touches = input.contact && ((light & kForceField) != 0 || far < 2.0 * settings_.reach);
  if (done_ || (done_ = touches || far <= settings_.reach)) return {};
  const std::uint32_t buoys = light & (kRedBuoy | kGreenBuoy);
  // One buoy alone, and already near: too late to come onto the axis from here.
  const bool astray = !lined_up_ && buoys != (kRedBuoy | kGreenBuoy) && (light & kForceField) != 0;
  lined_up_ = buoys == (kRedBuoy | kGreenBuoy) || (lined_up_ && buoys != 0);
  if (buoys != 0 && !astray) return follow_beams(light, X_WM);
  const base::Vec2 stage = base::transform(settings_.X_WD, {settings_.stage, 0.0});
  return go_to(X_WM, stage, {settings_.speed, settings_.turn});
}

// Seen from the dock the red buoy's beam is on the left, so for a robot that faces the dock on its right.
base::Twist Docking::follow_beams(std::uint32_t light, const base::Pose& X_WM) const {
  const bool red = (light & kRedBuoy) != 0, green = (light & kGreenBuoy) != 0;
  const double lean = red && green ? 0.0 : red ? settings_.lean : -settings_.lean;
  const double off = base::wrap_angle(settings_.X_WD.yaw + M_PI + lean - X_WM.yaw);
  const Pace pace{(light & kForceField) != 0 ? settings_.slow_speed : settings_.speed, settings_.turn};
  return {std::abs(off) <= pace.aim ? pace.speed : 0.0, 0.0, turn_to(off, pace)};
}

namespace {

const world::Emitter& find_dock(const Site& site, Settings& settings) {
  const std::string name = settings.text("dock", "");
  const base::Pose& X_WM = site.world.movers[site.mover].X_WM;
  const world::Emitter* found = nullptr;
  double least = HUGE_VAL;
  for (const world::Emitter& emitter : site.world.emitters) {
    if (emitter.kind != world::Emitter::Kind::dock) continue;
    if (!name.empty() && site.world.models[emitter.model].name != name) continue;
    const double far = std::hypot(emitter.X_WE.x - X_WM.x, emitter.X_WE.y - X_WM.y);
    if (!(far < least)) continue;
    least = far;
    found = &emitter;
  }
  if (found == nullptr)
    settings.refuse("dock", name.empty() ? "'docking' needs a dock; the world has none"
                                         : fmt::format("the world has no dock '{}'", name));
  return *found;
}

std::unique_ptr<Controller> make_docking(const Site& site, Settings& settings) {
  const world::Mover& mover = site.world.movers[site.mover];
  if (std::none_of(mover.sensors.begin(), mover.sensors.end(),
                   [](const world::Sensor& sensor) { return sensor.type == "irreceiver"; }))
    throw base::InputError(fmt::format(
        "controller 'docking': '{}' has no infrared receiver; give it an irreceiver( ) in the world file", mover.name));
  const world::Emitter& dock = find_dock(site, settings);
  DockingSettings docking;
  docking.X_WD = dock.X_WE;
  docking.stage = settings.number("stage", 0.7 * dock.range, 0.0, 1e3);
  docking.reach = settings.number("reach", mover.radius + 0.03, 0.0, 1e3);
  docking.speed = settings.number("speed", std::min(docking.speed, mover.max_forward), 1e-4, mover.max_forward);
  docking.slow_speed =
      settings.number("slow_speed", std::min(docking.slow_speed, docking.speed), 1e-4, mover.max_forward);
  docking.turn = std::min(docking.turn, mover.max_turn);
  return std::make_unique<Docking>(docking);
}

}  // namespace

constinit const ControllerKind docking_controller{
    .name = "docking",
    .summary = "onto a dock by its infrared beams",
    .rate = 10.0,
    .waits = false,
    .make = make_docking,
};

}  // namespace sf::control
