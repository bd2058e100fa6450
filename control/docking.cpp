#include "control/docking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "control/drive_to_point.h"
#include "sensors/battery.h"
#include "sensors/irreceiver.h"

namespace sf::control {

namespace {

using sensors::kDockByte, sensors::kNoIrByte, sensors::kRedBuoy, sensors::kGreenBuoy, sensors::kForceField;

constexpr std::int64_t kBlind = 2'000'000'000;    // [ns] duration for which the last received beams are used
constexpr std::int64_t kBackOff = 1'000'000'000;  // [ns] from an obstacle

/// Returns the signals of all receivers: of the virtual one, and of a real robot's own.
std::uint32_t light_in(std::span<const base::ReadingBlock> readings) {
  std::uint32_t light = 0;
  for (const base::ReadingBlock& reading : readings) {
    if (reading.type != sensors::kIrReceiver || reading.values.size() < 2) continue;
    const double byte = reading.values[1];
    if (byte > kDockByte && byte < kNoIrByte) light |= static_cast<std::uint32_t>(byte) - kDockByte;
  }
  return light;
}

}  // namespace

std::uint64_t Docking::needs() const { return 1ull << sensors::kIrReceiver; }

base::Twist Docking::step(const ControllerInput& input) {
  const base::Pose& X_WM = input.state.X_WM;
  const std::uint32_t light = light_in(input.readings);
  const bool hits = input.contact && (!contact_ || input.time >= back_until_);
  contact_ = input.contact;
  done_ = done_ || docked(X_WM);
  if (done_) return {};
  // Contact with an obstacle or with the dock's corner: retreat and approach again.
  if (contact_) retreats_ = true;
  if (hits) take_contact(X_WM, input.time);
  if (input.time < back_until_) return {-back_ * settings_.speed, 0.0, 0.0};

  const std::uint32_t buoys = light & (kRedBuoy | kGreenBuoy);
  if (buoys != 0) {
    light_ = light;
    seen_ = input.time;
  }
  const bool both = buoys == (kRedBuoy | kGreenBuoy);
  if (both && (light & kForceField) == 0 && !obstacles_) retreats_ = false;
  follows_ = !retreats_ && (both || (follows_ && input.time - seen_ <= kBlind));
  back_ = 1.0;
  return follows_ ? follow_beams(X_WM) : obstacles_ ? drive_around(X_WM) : approach(X_WM);
}

/// An obstacle is taken to be where the robot drove to. A robot that is not at its dock backs off.
void Docking::take_contact(const base::Pose& X_WM, std::int64_t time) {
  const glm::dvec2 p = from_dock(X_WM);
  const bool backing = time < back_until_;
  onto_dock_ = false;
  if (glm::length(p) < 1.6 * settings_.reach) {
    ++retries_;
  } else {
    if (!obstacles_) {
      obstacles_.emplace(settings_.radius);
      for (const double y : {-1.0, 0.0, 1.0}) obstacles_->add({0.0, 0.5 * y * settings_.reach});  // the dock
    }
    const double yaw = X_WM.yaw - settings_.X_WD.yaw + (backing && back_ > 0.0 ? M_PI : 0.0);
    const auto at = [&](double bearing) { return p + base::rotate(yaw + bearing, {settings_.radius, 0.0}); };
    // A second contact at the same place is with something to its left or right.
    constexpr double kSame = 0.03;
    const bool repeated = obstacles_->is_near(at(0.0), kSame);
    for (const double bearing : {0.0, -0.25 * M_PI, 0.25 * M_PI})
      if (bearing == 0.0 || repeated) obstacles_->add(at(bearing));
    back_ = backing ? -back_ : 1.0;
    back_until_ = time + kBackOff;
  }
  if (obstacles_) plan(p);
}

/// Goals are the points on the dock's axis from which nothing is in the way to the dock. After misses, the nearest ones
/// are left out.
void Docking::plan(const glm::dvec2& p) {
  constexpr double kStep = 0.05;
  std::vector<glm::dvec2> goals;
  for (double x = 1.6 * settings_.reach; x <= std::max(settings_.stage, 1.6 * settings_.reach); x += kStep) {
    if (!goals.empty() && !obstacles_->is_free({x, 0.0})) break;
    goals.push_back({x, 0.0});
  }
  const auto left_out = std::min<std::size_t>(std::size_t{4} * retries_, goals.size() - 1);
  goals.erase(goals.begin(), goals.begin() + static_cast<std::ptrdiff_t>(left_out));
  obstacles_->plan(p, goals);
  goals_ = {goals.front().x, goals.back().x};
}

/// Drives to the dock's axis around obstacles, and then along it until the beams are received.
base::Twist Docking::drive_around(const base::Pose& X_WM) {
  const glm::dvec2 p = from_dock(X_WM);
  constexpr double kNear = 0.04;
  if (std::abs(p.y) < kNear && p.x > goals_[0] - kNear && p.x < goals_[1] + kNear) {
    retreats_ = false;
    onto_dock_ = true;
  }
  const glm::dvec2 goal = onto_dock_ ? glm::dvec2{} : obstacles_->next(p);
  return drive_to_point(X_WM, base::transform(settings_.X_WD, goal), {settings_.speed, settings_.turn});
}

glm::dvec2 Docking::from_dock(const base::Pose& X_WM) const {
  return base::rotate(-settings_.X_WD.yaw, {X_WM.x - settings_.X_WD.x, X_WM.y - settings_.X_WD.y});
}

bool Docking::docked(const base::Pose& X_WM) const {
  return sensors::is_docked(settings_.X_WD, X_WM, settings_.reach, contact_);
}

// Drives to the staging point on the axis. The route leads around the dock if the dock is in between.
base::Twist Docking::approach(const base::Pose& X_WM) {
  const glm::dvec2 p = from_dock(X_WM);
  const double wide = 1.6 * settings_.reach;
  glm::dvec2 goal{settings_.stage, 0.0};
  if (p.x < settings_.reach)
    goal = {std::abs(p.y) < 0.95 * wide ? p.x : 2.0 * settings_.reach, std::copysign(wide, p.y)};
  if (std::abs(p.x - goal.x) + std::abs(p.y - goal.y) < 0.02) {
    retreats_ = false;
    onto_dock_ = onto_dock_ || goal.y == 0.0;
  }
  // At the staging point without beams, something hides them.
  if (onto_dock_) goal = {};
  return drive_to_point(X_WM, base::transform(settings_.X_WD, goal), {settings_.speed, settings_.turn});
}

// The red buoy's beam is on the left of the dock's x axis, and therefore on the right of a robot that faces the dock.
// The receiver is off the robot's centre, so a turn in place carries it from one beam into the other. The robot
// therefore drives while it turns, and keeps the direction of a turn in place once begun.
base::Twist Docking::follow_beams(const base::Pose& X_WM) {
  const bool red = (light_ & kRedBuoy) != 0, green = (light_ & kGreenBuoy) != 0;
  const double lean = red && green ? 0.0 : red ? settings_.lean : -settings_.lean;
  double off = base::wrap_angle(settings_.X_WD.yaw + M_PI + lean - X_WM.yaw);
  if (std::abs(off) < 0.5 * M_PI) {
    side_ = 0.0;
  } else if (side_ == 0.0) {
    side_ = std::copysign(1.0, off);
  } else if (side_ * off < 0.0) {
    off += 2.0 * M_PI * side_;
  }
  const double speed = (light_ & kForceField) != 0 ? settings_.slow_speed : settings_.speed;
  return {speed * std::max(base::cos(off), 0.0), 0.0, turn_to(off, {speed, settings_.turn})};
}

std::string Docking::stop_reason() const {
  return contact_ && !done_ ? "it touches something other than the dock's face" : "";
}

namespace {

const world::Emitter& find_dock(const ControllerContext& context, Settings& settings) {
  const std::string name = settings.text("dock", "");
  const base::Pose& X_WM = context.world.movers[context.mover].X_WM;
  const world::Emitter* found = nullptr;
  double least = HUGE_VAL;
  for (const world::Emitter& emitter : context.world.emitters) {
    if (emitter.kind != world::Emitter::Kind::dock) continue;
    if (!name.empty() && context.world.models[emitter.model].name != name) continue;
    const double far = base::hypot(emitter.X_WE.x - X_WM.x, emitter.X_WE.y - X_WM.y);
    if (!(far < least)) continue;
    least = far;
    found = &emitter;
  }
  if (found == nullptr)
    settings.refuse("dock", name.empty() ? "'docking' requires a dock, but the world has none"
                                         : fmt::format("the world has no dock '{}'", name));
  return *found;
}

std::unique_ptr<Controller> make_docking(const ControllerContext& context, Settings& settings) {
  const world::Mover& mover = context.world.movers[context.mover];
  if (std::none_of(mover.sensors.begin(), mover.sensors.end(),
                   [](const world::Sensor& sensor) { return sensor.type == "irreceiver"; }))
    throw base::InputError(fmt::format(
        "controller 'docking': '{}' has no infrared receiver; give it an irreceiver( ) in the world file", mover.name));
  const world::Emitter& dock = find_dock(context, settings);
  DockingSettings docking;
  docking.X_WD = dock.X_WE;
  docking.stage = settings.number("stage", 0.7 * dock.range, 0.0, 1e3);
  docking.radius = mover.radius;
  docking.reach = settings.number("reach", sensors::dock_reach_of(mover), 0.0, 1e3);
  docking.speed = settings.number("speed", std::min(docking.speed, mover.max_forward), 1e-4, mover.max_forward);
  docking.slow_speed =
      settings.number("slow_speed", std::min(docking.slow_speed, docking.speed), 1e-4, mover.max_forward);
  docking.turn = std::min(docking.turn, mover.max_turn);
  return std::make_unique<Docking>(docking);
}

}  // namespace

constinit const ControllerType docking_controller{
    .name = "docking",
    .summary = "drives onto a dock, guided by its infrared beams",
    .rate = 10.0,
    .stops_on_bumper = false,
    .make = make_docking,
};

}  // namespace sf::control
