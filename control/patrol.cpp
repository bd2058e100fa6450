#include "control/patrol.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "control/drive_to_point.h"

namespace sf::control {

Patrol::Patrol(PatrolSettings settings) : settings_(std::move(settings)) {
  SF_CHECK(!settings_.points.empty(), "a patrol without points");
}

// V2V states contain no footprint, so robots are considered up to a metre beyond the stopping distance.
double Patrol::v2v_range() const { return base::hypot(settings_.radius + settings_.keep, settings_.aside) + 1.0; }

base::Twist Patrol::step(const ControllerInput& input) {
  const base::Pose& X_WM = input.state.X_WM;
  const auto there = [&] {
    return glm::length(settings_.points[target_] - glm::dvec2{X_WM.x, X_WM.y}) <= settings_.reach;
  };
  if (there()) next(input.time);
  stop_reason_ = input.time < until_ ? "it pauses at an end of its path"
                 : there()           ? "it is at its only point"
                 : obstructed(input) ? "another robot blocks its way"
                                     : "";
  if (*stop_reason_ != '\0') return {};
  return drive_to_point(X_WM, settings_.points[target_],
                        {settings_.speed, settings_.turn_speed, settings_.turns_in_place ? 0.3 : M_PI});
}

void Patrol::next(std::int64_t time) {
  const std::size_t last = settings_.points.size() - 1;
  if (last == 0) return;
  if (target_ == (backwards_ ? 0 : last)) {
    backwards_ = !backwards_;
    until_ = time + static_cast<std::int64_t>(1e9 * settings_.pause);
  }
  target_ = backwards_ ? target_ - 1 : target_ + 1;
}

// V2V states contain no footprint, so the lane is wider than the robot's own body.
bool Patrol::obstructed(const ControllerInput& input) const {
  return std::any_of(input.others.begin(), input.others.end(), [&](const Neighbour& other) {
    const base::Pose& X_WM = input.state.X_WM;
    const glm::dvec2 p = base::rotate(-X_WM.yaw, {other.state.X_WM.x - X_WM.x, other.state.X_WM.y - X_WM.y});
    return p.x > 0.0 && p.x < settings_.radius + settings_.keep && std::abs(p.y) < settings_.aside;
  });
}

namespace {

std::vector<glm::dvec2> read_points(Settings& settings) {
  const std::vector<double> numbers = settings.numbers("points", {});
  const bool finite = std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); });
  if (numbers.size() < 2 || numbers.size() % 2 != 0 || !finite)
    settings.refuse("points",
                    "'points' of controller 'patrol' expects pairs [x0 y0 x1 y1 ...] in metres, at least one");
  std::vector<glm::dvec2> points;
  for (std::size_t i = 0; i < numbers.size(); i += 2) points.push_back({numbers[i], numbers[i + 1]});
  return points;
}

std::unique_ptr<Controller> make_patrol(const ControllerContext& context, Settings& settings) {
  const world::Mover& mover = context.world.movers[context.mover];
  PatrolSettings patrol;
  patrol.points = read_points(settings);
  patrol.speed = settings.number("speed", std::min(patrol.speed, mover.max_forward), 1e-4, mover.max_forward);
  patrol.turn_speed = settings.number("turn_speed", std::min(patrol.turn_speed, mover.max_turn), 1e-3, mover.max_turn);
  patrol.pause = settings.number("pause", patrol.pause, 0.0, 1e6);
  patrol.keep = settings.number("keep", patrol.keep, 0.0, 1e3);
  patrol.radius = mover.radius;
  patrol.aside = settings.number("aside", 2.0 * mover.radius, 0.0, 1e3);
  patrol.turns_in_place = mover.drive != world::Drive::car;
  return std::make_unique<Patrol>(patrol);
}

}  // namespace

constinit const ControllerType patrol_controller{
    .name = "patrol",
    .summary = "drives back and forth through given points; stops while another robot is in the way",
    .rate = 10.0,
    .stops_on_bumper = true,
    .make = make_patrol,
};

}  // namespace sf::control
