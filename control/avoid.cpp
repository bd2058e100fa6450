#include "control/avoid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/sonar.h"

namespace sf::control {

namespace {

double least(std::span<const double> ranges) {
  double range = HUGE_VAL;
  for (const double r : ranges)
    if (r < range) range = r;
  return range;
}

constexpr double kFront = M_PI / 6 + 1e-9;  // [rad] axes on the border belong to the front, as beams do
constexpr double kSide = M_PI / 2 + 1e-9;   // [rad]

double bearing_of(const sensors::ConeArray& sonar, std::size_t transducer) {
  return base::wrap_angle(sonar.row.X_MS.yaw + sonar.X_SC[transducer].yaw);
}

bool looks_ahead(const Sonars& sonars) {
  for (const sensors::ConeArray& sonar : sonars.all())
    for (std::size_t i = 0; i < sonar.X_SC.size(); ++i)
      if (std::abs(bearing_of(sonar, i)) <= kFront) return true;
  return false;
}

void add_sonar(const sensors::ConeArray& sonar, std::span<const double> ranges, std::optional<Thirds>& thirds) {
  if (!thirds) thirds = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (std::size_t i = 0; i < std::min(ranges.size(), sonar.X_SC.size()); ++i) {
    const double bearing = bearing_of(sonar, i);
    if (!(std::abs(bearing) <= kSide)) continue;
    double& third = std::abs(bearing) <= kFront ? thirds->front : bearing > 0.0 ? thirds->left : thirds->right;
    if (ranges[i] < third) third = ranges[i];
  }
}

}  // namespace

// Beams on the border between two thirds belong to the front.
Thirds thirds_of(std::span<const double> ranges) {
  if (ranges.size() < 3) return {least(ranges), least(ranges), least(ranges)};
  const std::size_t side = (ranges.size() - 1) / 3;
  return {least(ranges.first(side)), least(ranges.subspan(side, ranges.size() - 2 * side)), least(ranges.last(side))};
}

std::uint64_t Avoid::needs() const { return sonars_.empty() ? kNeedsFarm : 1ull << sensors::kSonar; }

std::optional<Thirds> Avoid::nearest(const ControllerInput& input) const {
  const base::ReadingBlock* laser = newest(input, sensors::kLaser);
  if (laser != nullptr && !laser->values.empty()) return thirds_of(laser->values);
  std::optional<Thirds> thirds;
  for (const base::ReadingBlock& reading : input.readings)
    if (const auto source = sonars_.source_of(reading)) add_sonar(source->sonar, reading.values, thirds);
  return thirds;
}

base::Twist Avoid::step(const ControllerInput& input) {
  const base::Twist wanted = drive(input);
  if (!swept_area_) return wanted;
  swept_area_->update(input);
  const double turn = state_ == State::turn_right ? -settings_.turn_speed : settings_.turn_speed;
  return swept_area_->limit(input.state, wanted, turn, settings_.slow_speed);
}

base::Twist Avoid::drive(const ControllerInput& input) {
  const std::optional<Thirds> seen = nearest(input);
  if (!seen) return {};
  const bool turning = state_ == State::turn_left || state_ == State::turn_right;
  if (turning && seen->front < settings_.clear)
    return {0.0, 0.0, state_ == State::turn_left ? settings_.turn_speed : -settings_.turn_speed};
  if (seen->front < settings_.turn) {
    state_ = seen->left > seen->right ? State::turn_left : State::turn_right;
    return {0.0, 0.0, state_ == State::turn_left ? settings_.turn_speed : -settings_.turn_speed};
  }
  state_ = seen->front < settings_.slow ? State::slow : State::drive;
  return {state_ == State::slow ? settings_.slow_speed : settings_.speed, 0.0, 0.0};
}

namespace {

std::unique_ptr<Controller> make_avoid(const ControllerContext& context, Settings& settings) {
  const world::Mover& mover = context.world.movers[context.mover];
  Sonars sonars(context);
  if (!sensors::has_laser(mover) && !looks_ahead(sonars))
    throw base::InputError(
        fmt::format("controller 'avoid': '{}' has no laser, and no sonar within 30 degrees of its heading; give it one "
                    "in the world "
                    "file",
                    mover.name));
  AvoidSettings avoid;
  avoid.speed = settings.number("speed", std::min(avoid.speed, mover.max_forward), 0.0, mover.max_forward);
  avoid.slow_speed = settings.number("slow_speed", std::min(avoid.slow_speed, avoid.speed), 0.0, mover.max_forward);
  avoid.slow = settings.number("slow", avoid.slow, 0.0, 1e3);
  avoid.turn = settings.number("turn", avoid.turn, 0.0, 1e3);
  avoid.clear = settings.number("clear", avoid.turn, avoid.turn, 1e3);
  avoid.turn_speed = settings.number("turn_speed", std::min(avoid.turn_speed, mover.max_turn), 1e-3, mover.max_turn);
  return std::make_unique<Avoid>(avoid, read_swept_area(context, settings), std::move(sonars));
}

}  // namespace

constinit const ControllerType avoid_controller{
    .name = "avoid",
    .summary = "the thesis' obstacle avoidance: drives straight, slows down near obstacles, turns away before contact",
    .rate = 10.0,
    .stops_on_bumper = true,
    .make = make_avoid,
};

}  // namespace sf::control
