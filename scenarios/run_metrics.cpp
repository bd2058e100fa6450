#include "scenarios/run_metrics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/elementary.h"
#include "world/lights.h"
#include "world/roads/network.h"

namespace sf::scenarios {

namespace {

/// [m] Distance from the origin to the foremost colliding point; carried sensors may extend farther.
double front_of(const world::Mover& mover) {
  double front = 0.0;
  for (const world::Segment& side : mover.body)
    if (side.stops_robots) front = std::max({front, side.a.x, side.b.x});
  return front;
}

}  // namespace

void CheckpointProgress::update(std::uint32_t next) {
  any = any || next != base::kNoId;
  passed += now != base::kNoId && next != now;
  now = next;
}

RunMetrics::RunMetrics(const world::World& world, const Simulation& simulation)
    : world_(world), simulation_(simulation), before_(world.movers.size()), counts_(world.movers.size()) {
  for (const world::Mover& mover : world.movers) fronts_.push_back(front_of(mover));
  add_lines();
}

void RunMetrics::add_mover() {
  before_.emplace_back();
  counts_.emplace_back();
  fronts_.push_back(front_of(world_.movers.back()));
}

void RunMetrics::add_lines() {
  const world::RoadNetwork* roads = simulation_.roads();
  if (roads == nullptr) return;
  for (std::uint32_t light = 0; light < world_.lights.size(); ++light)
    for (const std::string& name : world_.lights[light].points) {
      const auto id = world::read_point_id(name);
      const auto at = id ? world::find_point(*roads, *id) : std::nullopt;
      if (!at || at->kind != world::PointRef::Kind::lane) continue;
      const glm::dvec2 p = world::position_of(*roads, *at);
      const double yaw = world::yaw_of(*roads, *at).value_or(0.0);
      lines_.push_back({light, {p.x, p.y, 0.0, yaw}, 0.5 * roads->lanes[at->row].width});
    }
}

namespace {

template <class Count>
std::uint64_t sum_of(const std::vector<RobotMetrics>& counts, Count&& count) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0},
                         [&](std::uint64_t sum, const RobotMetrics& c) { return sum + count(c); });
}

}  // namespace

std::uint64_t RunMetrics::contacts() const {
  return sum_of(counts_, [](const RobotMetrics& c) { return c.contacts; });
}
std::uint64_t RunMetrics::red_lights_passed() const {
  return sum_of(counts_, [](const RobotMetrics& c) { return c.red_lights_passed; });
}
std::uint64_t RunMetrics::checkpoints() const {
  return sum_of(counts_, [](const RobotMetrics& c) { return c.goals.passed; });
}

void RunMetrics::update(const base::TickRecord& tick) {
  for (std::uint32_t m = 0; m < counts_.size(); ++m) {
    RobotMetrics& counts = counts_[m];
    PreviousTick& before = before_[m];
    const base::Pose& X_WM = tick.reports[m].X_WM;
    if (base::is_absent(X_WM)) {
      before = {};
      continue;
    }
    counts.contacts += before.contact.begins(tick.contacts[m] != 0);
    const double way = base::hypot(X_WM.x - before.X_WM.x, X_WM.y - before.X_WM.y);
    // Farther than it can drive: an event or `put` has placed it.
    const bool placed = way > 2.0 * world_.movers[m].max_forward * world_.interval;
    if (before.seen && !placed) {
      counts.travelled += way;
      update_red_lights(tick, m);
    }
    before.X_WM = X_WM;
    before.seen = true;

    const double speed = std::abs(tick.reports[m].velocity.forward);
    counts.stops += before.moving && speed <= kStanding;
    before.moving = speed >= kDriving || (before.moving && speed > kStanding);
    update_checkpoints(m);
  }
}

void RunMetrics::update_checkpoints(std::uint32_t mover) {
  if (simulation_.share().owns(mover) && !simulation_.stepped(mover)) return;
  const ControlStatus status = simulation_.status(mover);
  if (!status.stepped) return;
  RobotMetrics& counts = counts_[mover];
  if (std::isfinite(status.error)) counts.errors.push_back(status.error);
  counts.goals.update(simulation_.intent(mover).checkpoint);
}

/// Counts stop lines that the robot's front crosses in driving direction at red.
void RunMetrics::update_red_lights(const base::TickRecord& tick, std::uint32_t mover) {
  const base::Pose& X_WM = tick.reports[mover].X_WM;
  const double front = fronts_[mover];
  for (const Line& line : lines_) {
    const glm::dvec2 middle{line.X_WL.x, line.X_WL.y};
    const auto ahead = [&](const base::Pose& X) {
      return base::rotate(-line.X_WL.yaw, base::transform(X, {front, 0.0}) - middle);
    };
    const glm::dvec2 now = ahead(X_WM);
    const glm::dvec2 then = ahead(before_[mover].X_WM);
    if (then.x >= kPassed || now.x < kPassed || std::abs(now.y) > line.half_width) continue;
    if (base::cos(X_WM.yaw - line.X_WL.yaw) < 0.5) continue;
    const world::Signal shown = world::signal_at(world_.lights[line.light], 1e-9 * static_cast<double>(tick.time));
    counts_[mover].red_lights_passed += shown.state == world::LightState::red;
  }
}

}  // namespace sf::scenarios
