#include "control/cruise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "control/robots_ahead.h"

namespace sf::control {

namespace {

constexpr double kApproach = 0.5;          // [1/s] change of the speed per error of the gap
constexpr double kBend = 4.0;              // [m] on either side, over which the curvature is a mean
constexpr double kFastTurn = 1.0;          // [rad/s]
constexpr double kStandstillSpeed = 0.05;  // [m/s]
constexpr double kStops = 1.0;             // [m] before the end of an open lane
constexpr double kFullTurn = 10.0;         // [rad] cars never turn in place

}  // namespace

Cruise::Cruise(const world::RoadLane& lane, bool closed, CruiseSettings settings)
    : points_(lane.centre.points),
      s_(lane.centre.s),
      closed_(closed),
      half_width_(0.5 * lane.width),
      settings_(settings) {
  if (!closed || glm::length(points_.front() - points_.back()) < 1e-6) return;
  s_.push_back(s_.back() + glm::length(points_.front() - points_.back()));
  points_.push_back(points_.front());
}

double Cruise::curvature_at(double s) const {
  const auto yaw_at = [&](double at) {
    at = closed_ ? at - s_.back() * std::floor(at / s_.back()) : std::clamp(at, 0.0, s_.back());
    const auto next = std::ranges::upper_bound(s_, at) - s_.begin();
    const std::size_t i = std::clamp<std::size_t>(static_cast<std::size_t>(next), 1, s_.size() - 1);
    return base::atan2(points_[i].y - points_[i - 1].y, points_[i].x - points_[i - 1].x);
  };
  return base::wrap_angle(yaw_at(s + kBend) - yaw_at(s - kBend)) / (2.0 * kBend);
}

/// [m] from `s` to `of`, in driving direction.
double Cruise::ahead(double s, double of) const {
  const double d = of - s;
  return closed_ && d < 0.0 ? d + s_.back() : d;
}

double Cruise::speed_behind(const ControllerInput& input, const world::CurvePlace& here) const {
  double least = settings_.speed;
  for (const Neighbour& other : input.others) {
    const base::Pose& X = other.state.X_WM;
    const world::CurvePlace there = world::place_beside(points_, s_, {X.x, X.y});
    const double distance = ahead(here.s, there.s);
    if (std::abs(there.left) > half_width_ || !(distance > 0.0 && distance < settings_.range)) continue;
    const double speed = other.state.velocity.forward * base::cos(X.yaw - there.yaw);
    const double free = distance - settings_.gap - settings_.headway * input.state.velocity.forward;
    least = std::min(least, std::max(speed + kApproach * free, 0.0));
  }
  return least;
}

base::Twist Cruise::step(const ControllerInput& input) {
  if (!input.started) return {};
  const base::Pose& X = input.state.X_WM;
  const world::CurvePlace here = world::place_beside(points_, s_, {X.x, X.y});
  offset_ = here.left;
  const double reach = std::max(settings_.preview * input.state.velocity.forward, 3.0);
  const double bend = std::max(std::abs(curvature_at(here.s)), std::abs(curvature_at(here.s + 2.0 * reach)));
  double speed = speed_behind(input, here);
  stop_reason_ = speed > kStandstillSpeed ? "" : "a robot is ahead of it";
  if (bend > 0.0) speed = std::min(speed, std::sqrt(settings_.sideways / bend));
  done_ = !closed_ && ahead(here.s, s_.back()) < kStops;
  if (done_) return {};
  // The car's steering lags, so the curvature is that of the place a moment later.
  const double curvature = curvature_at(here.s + 0.2 * input.state.velocity.forward);
  return steer(speed, here.left, base::wrap_angle(X.yaw - here.yaw), curvature, reach, kFastTurn, kFullTurn);
}

namespace {

std::unique_ptr<Controller> make_cruise(const ControllerContext& context, Settings& settings) {
  const world::Mover& mover = context.world.movers[context.mover];
  if (context.roads == nullptr)
    throw base::InputError(context.world.file, 0,
                           "it has no road network to drive on; expected road( rndf \"...\" ) in it");
  CruiseSettings s;
  s.speed = settings.number("speed", std::min(s.speed, mover.max_forward), 0.1, mover.max_forward);
  s.headway = settings.number("headway", s.headway, 0.1, 60.0);
  s.gap = settings.number("gap", s.gap, 0.0, 1e3);
  s.sideways = settings.number("sideways", s.sideways, 0.01, 20.0);
  s.preview = settings.number("preview", s.preview, 0.1, 10.0);
  s.range = settings.number("radio", s.range, 1.0, 1e6);
  const std::string name = settings.text("lane", "");
  const std::vector<world::RoadLane>& lanes = context.roads->lanes;
  const auto lane = std::ranges::find_if(
      lanes, [&](const world::RoadLane& row) { return world::lane_name(*context.roads, row) == name; });
  if (lane == lanes.end() || lane->centre.points.size() < 2)
    settings.refuse("lane", fmt::format("there is no lane '{}' with a direction; expected one such as lane=1.1", name));
  const auto row = static_cast<std::uint32_t>(lane - lanes.begin());
  const auto last = static_cast<std::uint32_t>(lane->points.size() - 1);
  const world::PointRef start{world::PointRef::Kind::lane, row, 0}, end{world::PointRef::Kind::lane, row, last};
  const bool closed = std::ranges::any_of(
      context.roads->exits, [&](const world::RoadExit& exit) { return exit.from == end && exit.to == start; });
  return std::make_unique<Cruise>(*lane, closed, s);
}

}  // namespace

constinit const ControllerType cruise_controller{
    .name = "cruise",
    .summary = "keeps to one lane at a constant speed, slower in bends and behind others",
    .rate = 20.0,
    .stops_on_bumper = false,
    .make = make_cruise,
};

}  // namespace sf::control
