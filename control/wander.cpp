#include "control/wander.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "base/time.h"
#include "control/controllers.h"
#include "sensors/laser.h"

namespace sf::control {

namespace {

/// Bits of `Report::contact_mask` from 90 degrees to the left over the rear to 90 degrees to the right.
constexpr std::uint32_t kRear = 0x00FFFF00u;
static_assert(base::kContactSectors == 32);
constexpr double kLeastTurn = 0.2;  // [rad] after a command whose swept area is not free

}  // namespace

WanderSettings wander_settings(const world::Mover& mover, double range) {
  WanderSettings s;
  s.speed = 0.8 * mover.max_forward;
  s.turn = std::min(0.8 * mover.max_turn, 1.5);
  // A comfortable stopping distance, but well within sensor range.
  s.stop = std::min(std::max(0.5 * mover.radius, 0.4 * mover.max_forward), 0.3 * range);
  s.resume = std::min(2.0 * s.stop, 0.6 * range);
  s.slow = std::min(5.0 * s.stop, 0.95 * range);
  s.turns_in_place = mover.drive != world::Drive::car;
  return s;
}

Wander::Wander(const world::Mover& mover, std::span<const sensors::SensorSpec> lasers, std::uint32_t robot,
               std::uint64_t seed, std::optional<double> speed, std::optional<SweptArea> swept_area)
    : clearance_estimator_(mover, lasers),
      swept_area_(std::move(swept_area)),
      settings_(wander_settings(mover, clearance_estimator_.range())),
      robot_(robot),
      seed_(seed),
      contacts_suffice_(lasers.empty()) {
  if (speed) settings_.speed = *speed;
}

double Wander::random() {
  return base::random_uniform({.seed = seed_, .stream = base::RandomStream::wander, .a = robot_, .c = draws_++}, 0)[0];
}

base::Twist Wander::step(const ControllerInput& input) {
  const Clearance clearance = clearance_estimator_.estimate(input.readings);
  turned_ += std::abs(base::wrap_angle(input.state.X_WM.yaw - last_yaw_));
  last_yaw_ = input.state.X_WM.yaw;
  choose(input, clearance);
  if (!swept_area_) return drive(clearance, input.time);
  swept_area_->update(input);
  return checked(drive(clearance, input.time), input.state, clearance);
}

base::Twist Wander::drive(const Clearance& clearance, std::int64_t time) {
  if (mode_ == Mode::turn) return turn();
  if (mode_ == Mode::back)
    return {-0.5 * settings_.speed, 0.0, settings_.turns_in_place ? 0.0 : -side_ * settings_.turn};
  return cruise(clearance, time);
}

/// Turns away, as before any other obstacle, if the swept area of driving on is not free.
base::Twist Wander::checked(const base::Twist& wanted, const base::Report& state, const Clearance& clearance) {
  const double turn = settings_.turns_in_place ? 0.5 * side_ * settings_.turn : 0.0;
  const base::Twist twist = swept_area_->limit(state, wanted, turn, 0.25 * settings_.speed);
  if (mode_ == Mode::cruise && twist.forward <= 0.0) start_turn(clearance, kLeastTurn);
  if (mode_ == Mode::turn && twist.turn != 0.0) side_ = std::copysign(1.0, twist.turn);
  return twist;
}

void Wander::choose(const ControllerInput& input, const Clearance& clearance) {
  // If the robot is touched only from behind, backing off would keep the contact.
  const bool from_behind = input.state.contact_mask != 0 && (input.state.contact_mask & ~kRear) == 0;
  if (input.contact && from_behind) return drive_away(clearance);
  // After any other contact: back off, then turn by a random angle.
  if (input.contact) {
    if (mode_ == Mode::back) return start_turn(clearance, 0.5 + 2.0 * random());
    start_turn(clearance, 0.5 + 2.0 * random());
    return start_back(input.time);
  }
  const bool blocked = clearance_estimator_.range() > 0.0 && clearance.ahead < settings_.stop;
  switch (mode_) {
    case Mode::cruise:
      if (blocked) start_turn(clearance, 0.0);
      return;
    case Mode::back:
      if (input.time < until_) return;
      mode_ = Mode::turn;
      turned_ = 0.0;
      return;
    case Mode::turn: {
      // After a full turn without a gap, a smaller free distance suffices.
      const double enough = turned_ > 2.0 * M_PI ? settings_.stop : settings_.resume;
      const bool free = clearance_estimator_.range() <= 0.0 || clearance.ahead >= enough;
      if (turned_ >= least_ && free) mode_ = Mode::cruise;
      if (turned_ > 4.0 * M_PI) start_back(input.time);
      return;
    }
  }
}

/// Drives forward if there is some room, otherwise turns in place.
void Wander::drive_away(const Clearance& clearance) {
  const bool room = clearance_estimator_.range() <= 0.0 || clearance.ahead > 0.25 * settings_.stop;
  if (room)
    mode_ = Mode::cruise;
  else if (mode_ != Mode::turn)
    start_turn(clearance, 0.0);
}

void Wander::start_turn(const Clearance& clearance, double least) {
  const double difference = clearance.left - clearance.right;
  const bool alike = std::abs(difference) <= 0.1 * std::max(clearance.left, clearance.right);
  side_ = alike ? (random() < 0.5 ? -1.0 : 1.0) : (difference > 0.0 ? 1.0 : -1.0);
  mode_ = Mode::turn;
  least_ = least;
  turned_ = 0.0;
}

void Wander::start_back(std::int64_t time) {
  mode_ = Mode::back;
  until_ = time + base::kSecond * 3 / 10 + static_cast<std::int64_t>(0.5 * base::kSecond * random());
}

base::Twist Wander::turn() const {
  // A car turns in a curve as tight as contacts allow.
  return {settings_.turns_in_place ? 0.0 : 0.3 * settings_.speed, 0.0, side_ * settings_.turn};
}

base::Twist Wander::cruise(const Clearance& clearance, std::int64_t time) {
  if (time >= drift_until_) {
    drift_ = 0.25 * settings_.turn * (2.0 * random() - 1.0);
    drift_until_ = time + static_cast<std::int64_t>((2.0 + 4.0 * random()) * base::kSecond);
  }
  if (clearance_estimator_.range() <= 0.0) return {settings_.speed, 0.0, drift_};

  // 1 at the stop distance, 0 on free ground: slower, and more towards the freer side.
  const double near =
      std::clamp((settings_.slow - clearance.ahead) / std::max(settings_.slow - settings_.stop, 1e-9), 0.0, 1.0);
  const double sides = clearance.left + clearance.right;
  const double freer = sides > 0.0 ? (clearance.left - clearance.right) / sides : 0.0;
  const double steer = settings_.turn * (0.3 + 0.7 * near) * std::clamp(2.0 * freer, -1.0, 1.0);
  return {settings_.speed * (1.0 - 0.75 * near), 0.0, std::clamp(steer + drift_, -settings_.turn, settings_.turn)};
}

namespace {

std::unique_ptr<Controller> make_wander(const ControllerContext& context, Settings& settings) {
  const world::Mover& mover = context.world.movers[context.mover];
  const double speed = settings.number("speed", 0.8 * mover.max_forward, 0.0, mover.max_forward);
  return std::make_unique<Wander>(mover, context.sensors_of(sensors::kLaser), context.row_in_copy(), context.seed,
                                  speed, read_swept_area(context, settings));
}

}  // namespace

constinit const ControllerType wander_controller{
    .name = "wander",
    .summary = "wanders without a map: drives where there is room, turns away from obstacles",
    .rate = 10.0,
    .stops_on_bumper = false,
    .on_scans = true,
    .make = make_wander,
};

}  // namespace sf::control
