#include "world/roads/lane_use.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "base/elementary.h"
#include "base/error.h"
#include "base/suggest.h"

namespace sf::world {

namespace {

constexpr std::array<std::string_view, 6> kUses{"open", "closed", "turn", "left", "right", "reversed"};
constexpr double kLeastTurn = M_PI / 4;  // [rad] smallest change of direction of a turn
constexpr double kAgainst = -0.7;        // largest cosine between lanes that run against each other
constexpr double kFarthest = 6.0;        // [lane widths] between the ends of lanes that belong to one road

[[noreturn]] void refuse(const RoadNetwork& network, const RoadLane& lane, const std::string& why) {
  throw base::InputError(network.file, 0, fmt::format("lane {} {}", lane_name(network, lane), why));
}

void reverse(RoadLane& lane) {
  const double length = length_of(lane);
  const std::size_t last = lane.centre.points.size() - 1;
  std::ranges::reverse(lane.points);
  for (LanePoint& point : lane.points) {
    point.s = length - point.s;
    point.yaw = base::wrap_angle(point.yaw + M_PI);
  }
  Curve& centre = lane.centre;
  std::ranges::reverse(centre.points), std::ranges::reverse(centre.tangents);
  std::ranges::reverse(centre.s), std::ranges::reverse(centre.knots);
  for (glm::dvec2& tangent : centre.tangents) tangent = -tangent;
  for (double& s : centre.s) s = length - s;
  for (std::size_t& knot : centre.knots) knot = last - knot;
  std::swap(lane.left, lane.right);
  std::swap(lane.left_edge, lane.right_edge);
  std::ranges::reverse(lane.left_edge), std::ranges::reverse(lane.right_edge);
}

glm::dvec2 along(const LanePoint& point) { return base::direction(point.yaw); }

/// Builds the parts of a network around its reversed lanes.
class Reversal {
 public:
  Reversal(const RoadNetwork& base, std::span<const LaneUse> uses) : base_(base), uses_(uses), network_(base) {}

  RoadNetwork build(bool lenient) {
    for (std::uint32_t row = 0; row < uses_.size(); ++row) {
      if (!uses_[row].reversed) continue;
      if (network_.lanes[row].centre.points.size() < 2)
        refuse(base_, base_.lanes[row], "has one point only, so it has no direction to reverse");
      reverse(network_.lanes[row]);
    }
    for (auto& [id, at] : network_.index) at = moved(at);
    for (RoadCheckpoint& checkpoint : network_.checkpoints) checkpoint.at = moved(checkpoint.at);
    replace_exits(lenient);
    replace_stops();
    return std::move(network_);
  }

 private:
  bool reversed(PointRef at) const { return at.kind == PointRef::Kind::lane && uses_[at.row].reversed; }

  /// Returns the same point in the new network.
  PointRef moved(PointRef at) const {
    if (reversed(at)) at.index = static_cast<std::uint32_t>(base_.lanes[at.row].points.size()) - 1 - at.index;
    return at;
  }

  /// Returns where traffic in the opposite direction drives: the same point of a reversed lane or a zone, else the
  /// nearest point of a lane of the same segment that runs against it.
  std::optional<PointRef> opposite(PointRef at) const {
    if (at.kind != PointRef::Kind::lane || reversed(at)) return moved(at);
    const RoadLane& lane = network_.lanes[at.row];
    const LanePoint& point = lane.points[at.index];
    const RoadSegment& segment = network_.segments[lane.segment];
    std::optional<PointRef> best;
    double least = kFarthest * lane.width;
    for (std::uint32_t row = segment.first_lane; row < segment.first_lane + segment.lanes; ++row) {
      const RoadLane& other = network_.lanes[row];
      for (std::uint32_t i = 0; other.centre.points.size() > 1 && i < other.points.size(); ++i) {
        const double distance = length(other.points[i].p - point.p);
        if (dot(along(other.points[i]), along(point)) > kAgainst || distance >= least) continue;
        least = distance;
        best = PointRef{PointRef::Kind::lane, row, i};
      }
    }
    return best;
  }

  void replace_exits(bool lenient) {
    const auto key = [](const RoadExit& exit) {
      return std::tuple(exit.from.kind, exit.from.row, exit.from.index, exit.to.kind, exit.to.row, exit.to.index);
    };
    const auto concerns = [&](const RoadExit& exit) { return reversed(exit.from) || reversed(exit.to); };
    std::erase_if(network_.exits, concerns);
    std::vector<bool> entered(uses_.size()), left(uses_.size());
    for (const RoadExit& exit : base_.exits) {
      if (!concerns(exit)) continue;
      const auto from = opposite(exit.to), to = opposite(exit.from);
      if (!from || !to || (from->kind == to->kind && from->row == to->row)) continue;
      RoadExit back{*from, *to};
      if (std::ranges::any_of(network_.exits, [&](const RoadExit& other) { return key(other) == key(back); })) continue;
      back.length = exit_curve(network_, back).s.back();
      network_.exits.push_back(back);
      if (reversed(exit.to)) left[exit.to.row] = true;
      if (reversed(exit.from)) entered[exit.from.row] = true;
    }
    std::ranges::stable_sort(network_.exits, {}, [](const RoadExit& exit) {
      return std::tuple(exit.from.kind, exit.from.row, exit.from.index);
    });
    for (std::uint32_t row = 0; row < uses_.size() && !lenient; ++row)
      if (uses_[row].reversed && !(entered[row] && left[row]))
        refuse(base_, base_.lanes[row],
               fmt::format("cannot be reversed: no exit would lead {} it, since no lane runs against the lanes there",
                           entered[row] ? "out of" : "into"));
  }

  void replace_stops() {
    std::erase_if(network_.stops, [&](const StopLine& stop) { return reversed(stop.at); });
    for (std::uint32_t row = 0; row < uses_.size(); ++row) {
      if (!uses_[row].reversed) continue;
      const RoadLane& lane = network_.lanes[row];
      const LanePoint& end = lane.points.back();
      const PointRef at{PointRef::Kind::lane, row, static_cast<std::uint32_t>(lane.points.size()) - 1};
      const glm::dvec2 half = base::rotate(end.yaw, {0.0, 0.5 * lane.width});
      network_.stops.push_back({at, end.p + half, end.p - half, lights_at(lane)});
    }
  }

  /// Returns the way-point whose lights govern the end of a reversed lane.
  PointId lights_at(const RoadLane& lane) const {
    const LanePoint& end = lane.points.back();
    PointId best = end.id;
    double least = kFarthest * lane.width;
    for (const StopLine& stop : base_.stops) {
      const LanePoint& other = base_.lanes[stop.at.row].points[stop.at.index];
      const double distance = length(other.p - end.p);
      if (reversed(stop.at) || base_.lanes[stop.at.row].segment != lane.segment || distance >= least ||
          dot(along(other), along(end)) < -kAgainst)
        continue;
      least = distance;
      best = other.id;
    }
    return best;
  }

  const RoadNetwork& base_;
  std::span<const LaneUse> uses_;
  RoadNetwork network_;
};

/// [rad] Change of direction along an exit, to the left; nullopt if it has no direction at its start.
std::optional<double> turn_of(const RoadNetwork& network, const RoadExit& exit) {
  const auto from = yaw_of(network, exit.from);
  if (!from) return std::nullopt;
  const glm::dvec2 d = position_of(network, exit.to) - position_of(network, exit.from);
  const double to = yaw_of(network, exit.to).value_or(base::atan2(d.y, d.x));
  return base::wrap_angle(to - *from);
}

bool may_turn(LaneUse::Rule rule, double turn) {
  return rule == LaneUse::Rule::left    ? turn >= kLeastTurn
         : rule == LaneUse::Rule::right ? turn <= -kLeastTurn
                                        : std::abs(turn) >= kLeastTurn;
}

void restrict_to_turns(RoadNetwork& network, std::uint32_t row, LaneUse::Rule rule, bool lenient) {
  const RoadLane& lane = network.lanes[row];
  const PointRef end{PointRef::Kind::lane, row, static_cast<std::uint32_t>(lane.points.size()) - 1};
  bool any = false;
  for (RoadExit& exit : network.exits) {
    if (exit.from != end) continue;
    const auto turn = turn_of(network, exit);
    const bool may = turn && may_turn(rule, *turn);
    exit.open = exit.open && may;
    any = any || may;
  }
  if (!any && !lenient)
    refuse(network, lane,
           fmt::format("has no exit at its end that turns{} by 45 degrees or more", rule == LaneUse::Rule::turn ? ""
                                                                                    : rule == LaneUse::Rule::left
                                                                                        ? " left"
                                                                                        : " right"));
}

}  // namespace

LaneUse lane_use_of(const std::string& word) {
  const auto found = std::ranges::find(kUses, word);
  if (found == kUses.end())
    throw base::InputError(fmt::format("no use of a lane is '{}'{}", word, base::expected_one_of(word, kUses)));
  if (word == kUses.back()) return {.reversed = true};
  return {.rule = static_cast<LaneUse::Rule>(found - kUses.begin())};
}

std::string_view lane_use_name(const LaneUse& use) {
  const bool is_reversed = use.reversed && use.rule == LaneUse::Rule::open;
  return is_reversed ? kUses.back() : kUses[static_cast<std::size_t>(use.rule)];
}

std::uint32_t lane_named(const RoadNetwork& network, const std::string& name) {
  std::vector<std::string> names;
  for (std::uint32_t row = 0; row < network.lanes.size(); ++row) {
    names.push_back(lane_name(network, network.lanes[row]));
    if (names.back() == name) return row;
  }
  constexpr std::size_t kShown = 20;
  const std::size_t more = names.size() - std::min(names.size(), kShown);
  names.resize(names.size() - more);
  throw base::InputError(network.file, 0,
                         fmt::format("has no lane '{}'; expected segment.lane, one of {}{}", name,
                                     fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : ""));
}

RoadNetwork with_uses(const RoadNetwork& base, std::span<const LaneUse> uses, bool lenient) {
  SF_CHECK(uses.size() == base.lanes.size(), "uses: expected one per lane");
  RoadNetwork network = Reversal(base, uses).build(lenient);
  for (std::uint32_t row = 0; row < uses.size(); ++row) {
    const LaneUse::Rule rule = uses[row].rule;
    network.lanes[row].open = rule != LaneUse::Rule::closed;
    if (rule != LaneUse::Rule::open && rule != LaneUse::Rule::closed) restrict_to_turns(network, row, rule, lenient);
  }
  for (RoadExit& exit : network.exits)
    if (exit.to.kind == PointRef::Kind::lane && !network.lanes[exit.to.row].open) exit.open = false;
  return network;
}

}  // namespace sf::world
