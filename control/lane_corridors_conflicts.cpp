// Conflicts between ways, and the lines where robots wait.

#include <algorithm>

#include "control/lane_corridors.h"

namespace sf::control {

namespace {

enum class Relation { none, meets, yields };

/// Returns the relation of way `a` to way `b`. `row_a` and `row_b` are their rows, used for lanes.
Relation relation(const Way& a, std::uint32_t row_a, const Way& b, std::uint32_t row_b) {
  if (a.kind == Way::Kind::zone || b.kind == Way::Kind::zone) return Relation::none;
  const bool lane_a = a.kind == Way::Kind::lane, lane_b = b.kind == Way::Kind::lane;
  if (lane_a && lane_b) return Relation::meets;
  if (lane_a || lane_b) {
    const Way& other = lane_a ? b : a;
    const std::uint32_t lane = lane_a ? row_a : row_b;
    if (other.from == lane) return Relation::none;
    if (other.into != lane) return Relation::meets;
    // A lane does not yield to ways that enter it between its ends.
    return lane_b && a.enter > 0.0 ? Relation::yields : Relation::none;
  }
  // The ways start at one lane, or follow each other: robots follow each other there.
  const bool side_by_side =
      a.from != world::kNone && a.from == b.from && (a.leave == b.leave || !a.at_end || !b.at_end);
  const bool in_turn = (a.into != world::kNone && a.into == b.from) || (b.into != world::kNone && b.into == a.from);
  return side_by_side || in_turn ? Relation::none : Relation::meets;
}

}  // namespace

// Lanes of one segment run side by side; lanes connected by a way may form one road.
bool LaneCorridors::joined(std::uint32_t a, std::uint32_t b) const {
  if (roads_.lanes[a].segment == roads_.lanes[b].segment) return true;
  return std::any_of(ways_.begin(), ways_.end(), [&](const Way& way) {
    return (way.from == a && way.into == b) || (way.from == b && way.into == a);
  });
}

void LaneCorridors::find_conflicts() {
  for (std::uint32_t way = 0; way < ways_.size(); ++way) find_conflicts(way);
}

void LaneCorridors::find_conflicts(std::uint32_t row) {
  Way& way = ways_[row];
  struct Found {
    std::uint32_t way, from, to, other_from, other_to;
  };
  std::vector<Found> found;
  for (std::uint32_t i = 0; i < way.points.size(); ++i) {
    near(way.points[i], clearance_, [&](const Sample& sample) {
      if (sample.way == row) return;
      const glm::dvec2 d = sample.p - way.points[i];
      if (dot(d, d) >= clearance_ * clearance_ || apart(sample.z, way.z.empty() ? 0.0 : way.z[i])) return;
      const auto at = std::find_if(found.begin(), found.end(), [&](const Found& f) { return f.way == sample.way; });
      if (at == found.end()) {
        found.push_back({sample.way, i, i, sample.index, sample.index});
        return;
      }
      at->to = i;
      at->other_from = std::min(at->other_from, sample.index);
      at->other_to = std::max(at->other_to, sample.index);
    });
  }
  std::vector<Conflict> conflicts;
  for (const Found& f : found) {
    const Way& other = ways_[f.way];
    const Relation kind = relation(way, row, other, f.way);
    if (kind == Relation::none) continue;
    const bool lane = way.kind == Way::Kind::lane, other_lane = other.kind == Way::Kind::lane;
    if (lane && other_lane && joined(row, f.way)) continue;
    // A way that touches only the end of a lane conflicts with the exits there instead.
    const double end = 0.7 * body_.radius;
    const auto at_end = [&](const Way& w, std::uint32_t first, std::uint32_t last) {
      return last * w.step < end || first * w.step > w.length - end;
    };
    if (lane != other_lane && (lane ? at_end(way, f.from, f.to) : at_end(other, f.other_from, f.other_to))) continue;
    // Between two samples the distance may drop below the clearance.
    const auto low = [](const Way& w, std::uint32_t i) { return i > 0 ? (i - 1) * w.step : 0.0; };
    const auto high = [](const Way& w, std::uint32_t i) { return std::min((i + 1) * w.step, w.length); };
    conflicts.push_back({f.way, low(way, f.from), high(way, f.to), low(other, f.other_from), high(other, f.other_to),
                         kind == Relation::yields});
  }
  make_conflict_zones(way, std::move(conflicts));
}

void LaneCorridors::make_conflict_zones(Way& way, std::vector<Conflict> conflicts) const {
  std::sort(conflicts.begin(), conflicts.end(),
            [](const Conflict& a, const Conflict& b) { return a.from != b.from ? a.from < b.from : a.way < b.way; });
  const double margin = 0.12 * body_.radius;
  const bool whole = way.kind == Way::Kind::exit && way.at_end;
  for (Conflict& conflict : conflicts) {
    const double body = 2.0 * body_.radius + 3.0 * margin;
    if (way.conflict_zones.empty() || (!whole && conflict.from > way.conflict_zones.back().end + body))
      way.conflict_zones.push_back({whole ? -body_.front - margin : conflict.from - margin, conflict.to, {}});
    ConflictZone& conflict_zone = way.conflict_zones.back();
    conflict_zone.end = std::max(conflict_zone.end, conflict.to);
    conflict_zone.conflicts.push_back(conflict);
  }
}

void LaneCorridors::make_lines() {
  for (std::uint32_t row = 0; row < ways_.size(); ++row) {
    Way& way = ways_[row];
    if (way.kind == Way::Kind::lane)
      for (const ConflictZone& conflict_zone : way.conflict_zones) way.lines.push_back(conflict_zone.hold);
    if (way.from == world::kNone) continue;
    Way& lane = ways_[way.from];
    lane.out.push_back(row);
    for (const ConflictZone& conflict_zone : way.conflict_zones)
      if (way.at_end && conflict_zone.hold < 0.0) lane.lines.push_back(way.leave + conflict_zone.hold);
  }
  for (Way& way : ways_) {
    std::sort(way.lines.begin(), way.lines.end());
    way.lines.erase(std::unique(way.lines.begin(), way.lines.end(), [](double a, double b) { return b - a < 1e-9; }),
                    way.lines.end());
  }
}

}  // namespace sf::control
