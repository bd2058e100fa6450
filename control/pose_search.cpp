#include "control/pose_search.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::control {

namespace {

constexpr std::array<int, 2> kSteps[] = {{1, 0},  {2, 1},   {1, 1},   {1, 2},   {0, 1},  {-1, 2}, {-1, 1}, {-2, 1},
                                         {-1, 0}, {-2, -1}, {-1, -1}, {-1, -2}, {0, -1}, {1, -2}, {1, -1}, {2, -1}};

// Costs: a step of one node at full speed costs 10.
constexpr std::uint32_t kTurnCost = 40;  // per heading
constexpr std::uint32_t kBackwards = 2;  // factor in reverse
constexpr std::uint32_t kNear = 2;       // factor near a surface
constexpr double kNearBody = 0.03;       // [m] distance to a surface that counts as near
constexpr std::uint32_t kMostCost = 23 * kBackwards * kNear + 1;
constexpr std::uint32_t kNever = 0xFFFFFFFFu;
constexpr Node kAround = 3;     // nodes around the start within which the smaller margin is allowed
constexpr double kArm = 0.005;  // [m] required clearance beyond the sensor

enum : std::uint8_t { kForward, kBack, kLeft, kRight, kStart };

int around(int heading) { return (heading + kHeadings) % kHeadings; }

std::uint32_t length_cost(int heading) {
  const auto& step = kSteps[static_cast<std::size_t>(heading)];
  return static_cast<std::uint32_t>(std::lround(10.0 * base::hypot(step[0], step[1])));
}

}  // namespace

double heading_angle(int heading) {
  const auto& step = kSteps[static_cast<std::size_t>(heading)];
  return base::atan2(step[1], step[0]);
}

PoseSearch::PoseSearch(const ExplorationMap& map, const Footprint& body)
    : map_(map),
      body_(body),
      cost_(static_cast<std::size_t>(map.nodes()) * kHeadings),
      move_(cost_.size()),
      buckets_(kMostCost + 1) {
  const auto offset = [&](glm::dvec2 p) {
    return static_cast<Node>(std::lround(p.x / map.cell())) -
           map.columns() * static_cast<Node>(std::lround(p.y / map.cell()));
  };
  const double reach = glm::length(body.p_MS);
  for (int half = 0; half < 2 * kHeadings; ++half) {
    // Odd entries are the headings halfway between two neighbours, which a turn passes.
    const double to =
        half % 2 == 0 ? 0.0 : 0.5 * base::wrap_angle(heading_angle(around(half / 2 + 1)) - heading_angle(half / 2));
    const double yaw = heading_angle(half / 2) + to;
    auto& arm = sensor_arm_[static_cast<std::size_t>(half)];
    for (double far = body.radius - 0.01; reach > body.radius && far <= reach + kArm; far += 0.25 * map.cell())
      arm.push_back(offset(base::rotate(yaw, (far / reach) * body.p_MS)));
    arm.erase(std::unique(arm.begin(), arm.end()), arm.end());
    if (half % 2 != 0) continue;
    const auto k = static_cast<std::size_t>(half / 2);
    sensor_[k] = offset(base::rotate(yaw, body.p_MS));
    ahead_[k] = kSteps[k][0] - map.columns() * kSteps[k][1];
  }
}

bool PoseSearch::sensor_arm_clear(Node node, int half_heading) const {
  const auto& arm = sensor_arm_[static_cast<std::size_t>(half_heading)];
  return std::none_of(arm.begin(), arm.end(), [&](Node by) { return map_.occupied(node + by); });
}

bool PoseSearch::allowed(const LatticeState& state, double margin) const {
  return !map_.covers_unknown(state.node) && map_.clearance(state.node) >= static_cast<float>(body_.radius + margin) &&
         sensor_arm_clear(state.node, 2 * state.heading);
}

std::uint32_t PoseSearch::cost_at(Node node) const {
  return map_.clearance(node) < static_cast<float>(body_.radius + kNearBody) ? kNear : 1;
}

// `spare`: the margin that suffices near the start.
void PoseSearch::relax(const LatticeState& from, std::uint32_t so_far, double margin, double spare) {
  const int h = from.heading;
  const Node step = ahead_[static_cast<std::size_t>(h)];
  const std::uint32_t length = length_cost(h) * cost_at(from.node);
  const auto try_one = [&](const LatticeState& to, std::uint32_t cost, std::uint8_t move) {
    const std::size_t at = static_cast<std::size_t>(to.node) * kHeadings + static_cast<std::size_t>(to.heading);
    if (so_far + cost >= cost_[at]) return;
    const Node columns = map_.columns();
    const bool near_start = std::abs(to.node % columns - start_ % columns) <= kAround &&
                            std::abs(to.node / columns - start_ / columns) <= kAround;
    if (!allowed(to, near_start ? std::min(margin, spare) : margin)) return;
    cost_[at] = so_far + cost;
    move_[at] = move;
    buckets_[(so_far + cost) % buckets_.size()].push_back(static_cast<std::uint32_t>(at));
    ++waiting_;
  };
  try_one({from.node + step, h}, length, kForward);
  try_one({from.node - step, h}, kBackwards * length, kBack);
  if (sensor_arm_clear(from.node, 2 * h + 1)) try_one({from.node, around(h + 1)}, kTurnCost, kLeft);
  if (sensor_arm_clear(from.node, 2 * around(h - 1) + 1)) try_one({from.node, around(h - 1)}, kTurnCost, kRight);
}

std::vector<LatticeState> PoseSearch::find(const LatticeState& from, double margin,
                                           const std::function<bool(const LatticeState&)>& goal) {
  std::fill(cost_.begin(), cost_.end(), kNever);
  for (auto& bucket : buckets_) bucket.clear();
  const std::size_t first = static_cast<std::size_t>(from.node) * kHeadings + static_cast<std::size_t>(from.heading);
  start_ = from.node;
  cost_[first] = 0;
  move_[first] = kStart;
  buckets_[0].push_back(static_cast<std::uint32_t>(first));
  waiting_ = 1;
  const double spare = static_cast<double>(map_.clearance(from.node)) - body_.radius - 5e-4;
  for (std::uint32_t so_far = 0; waiting_ > 0; ++so_far) {
    auto& bucket = buckets_[so_far % buckets_.size()];
    for (std::size_t i = 0; i < bucket.size(); ++i) {
      const std::uint32_t at = bucket[i];
      --waiting_;
      if (cost_[at] != so_far) continue;
      const LatticeState state{static_cast<Node>(at / kHeadings), static_cast<int>(at % kHeadings)};
      if (goal(state)) return path_to(state, from);
      relax(state, so_far, margin, spare);
    }
    bucket.clear();
  }
  return {};
}

std::vector<LatticeState> PoseSearch::path_to(const LatticeState& goal, const LatticeState& from) const {
  std::vector<LatticeState> way{goal};
  for (LatticeState state = goal; !(state == from);) {
    const auto h = static_cast<std::size_t>(state.heading);
    switch (move_[static_cast<std::size_t>(state.node) * kHeadings + h]) {
      case kForward:
        state.node -= ahead_[h];
        break;
      case kBack:
        state.node += ahead_[h];
        break;
      case kLeft:
        state.heading = around(state.heading - 1);
        break;
      default:
        state.heading = around(state.heading + 1);
        break;
    }
    way.push_back(state);
  }
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace sf::control
