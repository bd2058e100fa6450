#include "robots/robot_body.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "robots/kinematics.h"

namespace sf::robots {

namespace {

world::World with_free_others(world::World world, std::uint32_t mover) {
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    if (m == mover) continue;
    world.movers[m].actuator_model = world::ActuatorModel::direct;
    world.movers[m].dynamics = {};
    world.movers[m].max_acceleration = world.movers[m].max_turn_acceleration = HUGE_VAL;
  }
  return world;
}

}  // namespace

RobotBody::RobotBody(const world::World& world, std::uint32_t mover, std::int64_t forget)
    : world_(with_free_others(world, mover)),
      fleet_(world_),
      mover_(mover),
      forget_(forget),
      others_(world.movers.size()),
      commands_(world.movers.size()),
      trail_({state().X_WM, state().tilt}) {}

void RobotBody::update_other(std::uint32_t mover, const base::Pose& X_WM, const base::Twist& velocity,
                             std::int64_t now) {
  // The fleet's time is the sum of its steps, slightly behind `now`. The report gets this time, so it is accepted as
  // newest.
  const base::Report report{mover, fleet_.reports()[mover].time, X_WM, velocity};
  fleet_.apply({&report, 1});
  fleet_.set_absent(mover, false);
  others_[mover] = {velocity, now + kMaxExtrapolation, forget_ > 0 ? now + forget_ : kNever};
}

void RobotBody::move(const base::Twist& command, std::int64_t now) { advance(command, nullptr, now); }

void RobotBody::follow(const base::Pose& X_WM, const base::Twist& velocity, bool contact, std::int64_t now) {
  followed_contact_ = contact;
  const base::Report followed{mover_, 0, X_WM, velocity};
  advance({}, &followed, now);
}

void RobotBody::advance(const base::Twist& command, const base::Report* followed, std::int64_t now) {
  const std::int64_t dt = std::min(now - time_, kMaxExtrapolation);
  time_ = now;
  if (dt <= 0) return;
  for (std::uint32_t m = 0; m < others_.size(); ++m) {
    commands_[m] = now < others_[m].until ? others_[m].velocity : base::Twist{};
    if (now >= others_[m].gone) fleet_.set_absent(m, true);
  }
  commands_[mover_] = command;
  const base::Pose before = state().X_WM;
  fleet_.move(commands_, dt);
  if (followed != nullptr) {
    base::Report report = *followed;
    report.X_WM.z = fleet_.height_at(mover_, {report.X_WM.x, report.X_WM.y});
    report.time = fleet_.reports()[mover_].time;
    fleet_.apply({&report, 1});
  }
  const base::Pose after = state().X_WM;
  distance_ += base::hypot(after.x - before.x, after.y - before.y);
  trail_.add(now, {after, state().tilt});
}

}  // namespace sf::robots
