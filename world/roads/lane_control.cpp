#include "world/roads/lane_control.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"

namespace sf::world {

namespace {

constexpr double kApart = 0.5;  // [lane widths] height above or below a lane from which a robot is on another road
constexpr double kAlong = 0.7;  // smallest cosine between a robot on an exit and the exit

/// Calls `test(s, d)` with the place [m] and the direction of each piece of the curve that is within `reach` [m] of
/// `p`, until it returns true.
template <class Test>
bool any_near(const Curve& curve, double reach, glm::dvec2 p, Test&& test) {
  for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
    const glm::dvec2 d = curve.points[i + 1] - curve.points[i];
    const double t = std::clamp(dot(p - curve.points[i], d) / dot(d, d), 0.0, 1.0);
    if (length(p - curve.points[i] - t * d) <= reach && test(curve.s[i] + t * length(d), normalize(d))) return true;
  }
  return false;
}

}  // namespace

LaneControl::LaneControl(const RoadNetwork& base)
    : base_(std::make_shared<const RoadNetwork>(base)),
      network_(base_),
      wanted_(base.lanes.size()),
      uses_(base.lanes.size()),
      empty_since_(base.lanes.size()) {}

void LaneControl::request(std::uint32_t lane, const LaneUse& use) {
  SF_CHECK(lane < wanted_.size(), "lane " + std::to_string(lane));
  std::vector<LaneUse> wanted = wanted_;
  wanted[lane] = use;
  with_uses(*base_, wanted);
  wanted_ = std::move(wanted);
  requested_ = true;
}

bool LaneControl::update(std::int64_t now, std::span<const base::Report> robots) {
  const bool clears = std::ranges::any_of(empty_since_, [](const auto& since) { return since.has_value(); });
  if (!requested_ && !clears) return false;
  requested_ = false;
  std::vector<LaneUse> next = wanted_;
  for (std::uint32_t lane = 0; lane < next.size(); ++lane) {
    auto& since = empty_since_[lane];
    if (!is_clearing(lane)) {
      since.reset();
      continue;
    }
    if (!since || !is_empty(lane, robots)) since = now;
    if (now - *since < kClearing) {
      next[lane] = {.rule = LaneUse::Rule::closed, .reversed = uses_[lane].reversed};
    } else {
      since.reset();
    }
  }
  if (next == uses_) return false;
  network_ = std::make_shared<const RoadNetwork>(with_uses(*base_, next, true));
  uses_ = std::move(next);
  return true;
}

bool LaneControl::is_empty(std::uint32_t row, std::span<const base::Report> robots) const {
  const RoadLane& lane = network_->lanes[row];
  const double reach = 0.5 * lane.width;
  std::vector<Curve> links;  // exits and lane changes from and to the lane
  const auto concerns = [&](PointRef at) { return at.kind == PointRef::Kind::lane && at.row == row; };
  for (const RoadExit& exit : network_->exits)
    if (concerns(exit.from) || concerns(exit.to)) links.push_back(exit_curve(*network_, exit));
  return std::ranges::none_of(robots, [&](const base::Report& robot) {
    if (base::is_absent(robot.X_WM)) return false;
    const glm::dvec2 p{robot.X_WM.x, robot.X_WM.y}, facing = base::direction(robot.X_WM.yaw);
    const auto at_its_height = [&](double s, glm::dvec2) {
      return std::abs(robot.X_WM.z - height_at(lane, s)) < kApart * lane.width;
    };
    const auto in_its_direction = [&](double, glm::dvec2 d) { return dot(d, facing) > kAlong; };
    return any_near(lane.centre, reach, p, at_its_height) ||
           std::ranges::any_of(links, [&](const Curve& link) { return any_near(link, reach, p, in_its_direction); });
  });
}

}  // namespace sf::world
