#include "control/corridor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"

namespace sf::control {

namespace {

using world::PointRef;

constexpr double kAlike = 0.7;       // cosine of the angle between a robot and its way, at least
constexpr double kChangeCost = 1.0;  // [m] more than its length: lanes are changed where it helps only

world::Curve straight(Vec2 a, Vec2 b) { return world::smooth_curve(std::array{a, b}, {}); }

/// Even samples of a line.
void sample(Way& way, const world::Curve& line, double step) {
  way.length = std::max(line.s.back(), 1e-6);
  const auto spans = static_cast<std::size_t>(std::max(1.0, std::ceil(way.length / step)));
  way.step = way.length / static_cast<double>(spans);
  for (std::size_t i = 0; i <= spans; ++i) way.points.push_back(point_at(line, static_cast<double>(i) * way.step));
  way.yaw.resize(spans + 1);
  const auto direction = [](Vec2 d) { return std::atan2(d.y, d.x); };
  for (std::size_t i = 0; i <= spans; ++i) {
    double yaw = i == 0       ? direction(line.tangents.front())
                 : i == spans ? direction(line.tangents.back())
                              : direction(way.points[i + 1] - way.points[i - 1]);
    if (i > 0) yaw = way.yaw[i - 1] + base::wrap_angle(yaw - way.yaw[i - 1]);
    way.yaw[i] = yaw;
  }
  for (const double yaw : way.yaw) way.tangents.push_back({std::cos(yaw), std::sin(yaw)});
  way.curvature.resize(spans + 1);
  for (std::size_t i = 0; i <= spans; ++i) {
    const std::size_t a = i > 0 ? i - 1 : 0, b = std::min(i + 1, spans);
    way.curvature[i] = (way.yaw[b] - way.yaw[a]) / (static_cast<double>(b - a) * way.step);
  }
}

double between(const std::vector<double>& values, const Way& way, double s) {
  const double at = std::clamp(s / way.step, 0.0, static_cast<double>(values.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(at), values.size() - 2);
  return values[i] + (at - static_cast<double>(i)) * (values[i + 1] - values[i]);
}

}  // namespace

Body body_of(const world::Mover& mover) {
  double front = 0.0;
  for (const world::Segment& s : mover.body) front = std::max({front, s.a.x, s.b.x});
  return {mover.radius, front};
}

Vec2 point_on(const Way& way, double s) {
  const double at = std::clamp(s / way.step, 0.0, static_cast<double>(way.points.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(at), way.points.size() - 2);
  return way.points[i] + (at - static_cast<double>(i)) * (way.points[i + 1] - way.points[i]);
}
double yaw_on(const Way& way, double s) { return between(way.yaw, way, s); }
double curvature_on(const Way& way, double s) { return between(way.curvature, way, s); }

Corridors::Corridors(const world::RoadNetwork& roads, const world::World& world, const Body& body)
    : roads_(roads),
      body_(body),
      clearance_(2.0 * body.radius + 0.25 * body.radius),
      step_(0.25 * body.radius),
      edges_(roads.index.size()) {
  add_lanes(world);
  add_exits();
  add_changes();
  add_zones();
  fill_grid();
  find_meetings();
  make_lines();
}

std::uint32_t Corridors::node_of(PointRef at) const {
  const world::PointId id = id_of(roads_, at);
  const auto found = std::lower_bound(roads_.index.begin(), roads_.index.end(), id,
                                      [](const auto& row, world::PointId wanted) { return row.first < wanted; });
  SF_CHECK(found != roads_.index.end() && found->first == id, "no point " + world::text_of(id));
  return static_cast<std::uint32_t>(found - roads_.index.begin());
}

std::uint32_t Corridors::add_way(Way way, const world::Curve& line) {
  sample(way, line, step_);
  ways_.push_back(std::move(way));
  return static_cast<std::uint32_t>(ways_.size() - 1);
}

void Corridors::add_edge(PointRef from, PointRef to, std::uint32_t way, double from_s, double to_s, double extra) {
  edges_[node_of(from)].push_back({node_of(to), {way, world::kNone}, from_s, to_s, to_s - from_s + extra});
}

void Corridors::add_lanes(const world::World& world) {
  for (std::uint32_t row = 0; row < roads_.lanes.size(); ++row) {
    const world::RoadLane& lane = roads_.lanes[row];
    add_way({.kind = Way::Kind::lane}, lane.centre);
    for (std::uint32_t i = 0; i + 1 < lane.points.size(); ++i)
      add_edge({PointRef::Kind::lane, row, i}, {PointRef::Kind::lane, row, i + 1}, row, lane.points[i].s,
               lane.points[i + 1].s, 0.0);
  }
  for (const world::StopLine& stop : roads_.stops) {
    StopMark mark{roads_.lanes[stop.at.row].points[stop.at.index].s, {}};
    const std::string name = text_of(id_of(roads_, stop.at));
    for (std::uint32_t light = 0; light < world.lights.size(); ++light) {
      const auto& points = world.lights[light].points;
      if (std::find(points.begin(), points.end(), name) != points.end()) mark.lights.push_back(light);
    }
    ways_[stop.at.row].stops.push_back(std::move(mark));
  }
  for (Way& way : ways_)
    std::sort(way.stops.begin(), way.stops.end(), [](const auto& a, const auto& b) { return a.s < b.s; });
}

void Corridors::add_exits() {
  for (const world::RoadExit& exit : roads_.exits) {
    Way way{.kind = Way::Kind::exit};
    if (exit.from.kind == PointRef::Kind::lane) {
      const world::RoadLane& lane = roads_.lanes[exit.from.row];
      way.from = exit.from.row;
      way.leave = lane.points[exit.from.index].s;
      way.at_end = exit.from.index + 1 == lane.points.size();
    } else {
      way.in_zone = true;
      way.zone = exit.from.row;
    }
    if (exit.to.kind == PointRef::Kind::lane) {
      way.into = exit.to.row;
      way.enter = roads_.lanes[exit.to.row].points[exit.to.index].s;
    } else {
      way.in_zone = true;
      way.zone = exit.to.row;
    }
    const std::uint32_t row = add_way(way, connection_of(roads_, exit));
    add_edge(exit.from, exit.to, row, 0.0, ways_[row].length, 0.0);
  }
}

void Corridors::add_changes() {
  for (std::uint32_t row = 0; row < roads_.lanes.size(); ++row) {
    for (std::uint32_t i = 0; i < roads_.lanes[row].points.size(); ++i) {
      const PointRef from{PointRef::Kind::lane, row, i};
      for (const world::Step& step : lane_changes(roads_, from)) {
        Way way{.kind = Way::Kind::change, .from = row, .into = step.to.row};
        way.leave = roads_.lanes[row].points[i].s;
        way.enter = roads_.lanes[step.to.row].points[step.to.index].s;
        const std::uint32_t added = add_way(way, change_of(roads_, from, step.to));
        add_edge(from, step.to, added, 0.0, ways_[added].length, kChangeCost);
      }
    }
  }
}

Pose Corridors::parked(std::uint32_t row) const {
  const world::RoadSpot& spot = roads_.spots[row];
  const Vec2 d = spot.end - spot.entry;
  const Vec2 along = length(d) > 0.0 ? (1.0 / length(d)) * d : Vec2{1.0, 0.0};
  const Vec2 p = spot.end - body_.front * along;
  return {p.x, p.y, 0.0, std::atan2(along.y, along.x)};
}

// Into a spot: along the aisle to where the robot stands before it, a turn in place, straight in; out again backwards.
void Corridors::add_zones() {
  const auto leads = [&](PointRef at, bool out) {
    return std::any_of(roads_.exits.begin(), roads_.exits.end(),
                       [&](const world::RoadExit& exit) { return (out ? exit.from : exit.to) == at; });
  };
  for (std::uint32_t row = 0; row < roads_.zones.size(); ++row) {
    const world::RoadZone& zone = roads_.zones[row];
    const Way about{.kind = Way::Kind::zone, .in_zone = true, .zone = row};
    const auto aisle = [&](Vec2 a, Vec2 b) { return add_way(about, straight(a, b)); };
    for (std::uint32_t i = 0; i < zone.perimeter.size(); ++i) {
      const PointRef here{PointRef::Kind::perimeter, row, i};
      for (std::uint32_t j = 0; j < zone.perimeter.size(); ++j) {
        const PointRef there{PointRef::Kind::perimeter, row, j};
        if (i == j || !leads(here, false) || !leads(there, true)) continue;
        const std::uint32_t way = aisle(zone.perimeter[i].p, zone.perimeter[j].p);
        add_edge(here, there, way, 0.0, ways_[way].length, 0.0);
      }
      for (std::uint32_t spot = zone.first_spot; spot < zone.first_spot + zone.spots; ++spot) {
        const PointRef entry{PointRef::Kind::spot, spot, 0}, end{PointRef::Kind::spot, spot, 1};
        const Pose stand = parked(spot);
        const Vec2 in{stand.x, stand.y};
        const Vec2 before = roads_.spots[spot].entry - body_.radius * Vec2{std::cos(stand.yaw), std::sin(stand.yaw)};
        if (leads(here, false)) {
          const std::uint32_t way = aisle(zone.perimeter[i].p, before);
          add_edge(here, entry, way, 0.0, ways_[way].length, 0.0);
          if (edges_[node_of(entry)].empty()) {
            const std::uint32_t dock = aisle(before, in);
            add_edge(entry, end, dock, 0.0, ways_[dock].length, 0.0);
          }
        }
        if (leads(here, true)) {
          const std::uint32_t back = aisle(in, before);
          ways_[back].backwards = true;
          const std::uint32_t way = aisle(before, zone.perimeter[i].p);
          edges_[node_of(end)].push_back(
              {node_of(here), {back, way}, 0.0, ways_[back].length, ways_[back].length + ways_[way].length});
        }
      }
    }
  }
}

bool Corridors::inside(std::uint32_t zone, Vec2 p) const {
  const auto& perimeter = roads_.zones[zone].perimeter;
  bool in = false;
  for (std::size_t i = 0, j = perimeter.size() - 1; i < perimeter.size(); j = i++) {
    const Vec2 a = perimeter[i].p, b = perimeter[j].p;
    const Vec2 d = b - a;
    const double t = std::clamp(dot(p - a, d) / std::max(dot(d, d), 1e-18), 0.0, 1.0);
    if (length(p - a - t * d) < 0.5 * body_.radius) return true;
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
  }
  return in;
}

void Corridors::fill_grid() {
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const Way& way : ways_)
    for (const Vec2 p : way.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  if (ways_.empty()) low = high = {};
  corner_ = low;
  // A few million cells at most, however long the roads.
  const double area = std::max((high.x - low.x) * (high.y - low.y), 1e-12);
  cell_ = std::max(0.5 * clearance_, std::sqrt(area / 4e6));
  columns_ = static_cast<std::int64_t>((high.x - low.x) / cell_) + 1;
  rows_ = static_cast<std::int64_t>((high.y - low.y) / cell_) + 1;
  const auto cell_of = [&](Vec2 p) {
    return static_cast<std::size_t>(static_cast<std::int64_t>((p.y - low.y) / cell_) * columns_ +
                                    static_cast<std::int64_t>((p.x - low.x) / cell_));
  };
  first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  std::size_t count = 0;
  for (const Way& way : ways_)
    for (const Vec2 p : way.points) ++first_[cell_of(p) + 1], ++count;
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  samples_.resize(count);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t w = 0; w < ways_.size(); ++w) {
    const Way& way = ways_[w];
    for (std::uint32_t i = 0; i < way.points.size(); ++i)
      samples_[next[cell_of(way.points[i])]++] = {way.points[i], (way.backwards ? -1.0 : 1.0) * way.tangents[i], w, i};
  }
}

template <class F>
void Corridors::near(Vec2 p, double reach, F&& visit) const {
  const auto cell = [&](double v, double low, std::int64_t most) {
    const double at = std::floor((v - low) / cell_);
    return at < 0.0 ? std::int64_t{-1} : at >= static_cast<double>(most) ? most : static_cast<std::int64_t>(at);
  };
  const std::int64_t r0 = std::max<std::int64_t>(cell(p.y - reach, corner_.y, rows_), 0);
  const std::int64_t r1 = std::min(cell(p.y + reach, corner_.y, rows_), rows_ - 1);
  const std::int64_t c0 = std::max<std::int64_t>(cell(p.x - reach, corner_.x, columns_), 0);
  const std::int64_t c1 = std::min(cell(p.x + reach, corner_.x, columns_), columns_ - 1);
  for (std::int64_t r = r0; r <= r1; ++r)
    for (std::int64_t c = c0; c <= c1; ++c) {
      const auto at = static_cast<std::size_t>(r * columns_ + c);
      for (std::uint32_t i = first_[at]; i < first_[at + 1]; ++i) visit(samples_[i]);
    }
}

Places Corridors::places(const Pose& X_WM, double reach) const {
  const Vec2 p{X_WM.x, X_WM.y};
  const Vec2 facing{std::cos(X_WM.yaw), std::sin(X_WM.yaw)};
  // The nearest sample of each way, the nearest ways first.
  struct Nearest {
    std::uint32_t way = 0, index = 0;
    double distance = 0.0;
  };
  std::array<Nearest, 48> found;
  std::size_t count = 0;
  const double within = reach + 0.5 * step_;
  near(p, within, [&](const Sample& sample) {
    const Vec2 d = sample.p - p;
    const double dd = dot(d, d);
    if (dd > within * within) return;
    if (dot(sample.along, facing) < kAlike) return;
    for (std::size_t i = 0; i < count; ++i) {
      if (found[i].way != sample.way) continue;
      if (dd < found[i].distance) found[i] = {sample.way, sample.index, dd};
      return;
    }
    if (count < found.size()) found[count++] = {sample.way, sample.index, dd};
  });

  Places places;
  for (std::size_t i = 0; i < count; ++i) {
    const Way& way = ways_[found[i].way];
    const Vec2 along = way.tangents[found[i].index];
    const Vec2 d = p - way.points[found[i].index];
    const double s = static_cast<double>(found[i].index) * way.step + dot(d, along);
    if (s < -1e-6 || s > way.length + 1e-6) continue;  // beyond its ends
    const Place place{found[i].way, s, std::abs(cross(along, d))};
    if (place.offset > reach) continue;
    // In order of offset, then of rows.
    std::uint32_t at = places.count;
    while (at > 0 && (places.all[at - 1].offset > place.offset ||
                      (places.all[at - 1].offset == place.offset && places.all[at - 1].way > place.way)))
      --at;
    if (at == places.all.size()) continue;
    places.count = std::min(places.count + 1, static_cast<std::uint32_t>(places.all.size()));
    for (std::uint32_t k = places.count - 1; k > at; --k) places.all[k] = places.all[k - 1];
    places.all[at] = place;
  }
  return places;
}

// ---- Where ways meet.

namespace {

enum class Relation { none, meets, yields };

/// How way `a` stands to way `b`, rows of lanes given.
Relation relation(const Way& a, std::uint32_t row_a, const Way& b, std::uint32_t row_b) {
  if (a.kind == Way::Kind::zone || b.kind == Way::Kind::zone) return Relation::none;
  const bool lane_a = a.kind == Way::Kind::lane, lane_b = b.kind == Way::Kind::lane;
  if (lane_a && lane_b) return Relation::meets;
  if (lane_a || lane_b) {
    const Way& other = lane_a ? b : a;
    const std::uint32_t lane = lane_a ? row_a : row_b;
    if (other.from == lane) return Relation::none;
    if (other.into != lane) return Relation::meets;
    // Lanes do not wait for who comes into them in their course.
    return lane_b && a.enter > 0.0 ? Relation::yields : Relation::none;
  }
  // From one lane, or one after the other: they follow each other.
  const bool side_by_side =
      a.from != world::kNone && a.from == b.from && (a.leave == b.leave || !a.at_end || !b.at_end);
  const bool in_turn = (a.into != world::kNone && a.into == b.from) || (b.into != world::kNone && b.into == a.from);
  return side_by_side || in_turn ? Relation::none : Relation::meets;
}

}  // namespace

// Lanes of one segment run side by side; others may be one road.
bool Corridors::joined(std::uint32_t a, std::uint32_t b) const {
  if (roads_.lanes[a].segment == roads_.lanes[b].segment) return true;
  return std::any_of(ways_.begin(), ways_.end(), [&](const Way& way) {
    return (way.from == a && way.into == b) || (way.from == b && way.into == a);
  });
}

void Corridors::find_meetings() {
  for (std::uint32_t way = 0; way < ways_.size(); ++way) find_meetings(way);
}

void Corridors::find_meetings(std::uint32_t row) {
  Way& way = ways_[row];
  struct Found {
    std::uint32_t way, from, to, other_from, other_to;
  };
  std::vector<Found> found;
  for (std::uint32_t i = 0; i < way.points.size(); ++i) {
    near(way.points[i], clearance_, [&](const Sample& sample) {
      if (sample.way == row) return;
      const Vec2 d = sample.p - way.points[i];
      if (dot(d, d) >= clearance_ * clearance_) return;
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
  std::vector<Meeting> meetings;
  for (const Found& f : found) {
    const Way& other = ways_[f.way];
    const Relation kind = relation(way, row, other, f.way);
    if (kind == Relation::none) continue;
    const bool lane = way.kind == Way::Kind::lane, other_lane = other.kind == Way::Kind::lane;
    if (lane && other_lane && joined(row, f.way)) continue;
    // What passes a lane's very end meets the exits there.
    const double end = 0.7 * body_.radius;
    const auto at_end = [&](const Way& w, std::uint32_t first, std::uint32_t last) {
      return last * w.step < end || first * w.step > w.length - end;
    };
    if (lane != other_lane && (lane ? at_end(way, f.from, f.to) : at_end(other, f.other_from, f.other_to))) continue;
    // Between samples the ways may be that near already.
    const auto low = [](const Way& w, std::uint32_t i) { return i > 0 ? (i - 1) * w.step : 0.0; };
    const auto high = [](const Way& w, std::uint32_t i) { return std::min((i + 1) * w.step, w.length); };
    meetings.push_back({f.way, low(way, f.from), high(way, f.to), low(other, f.other_from), high(other, f.other_to),
                        kind == Relation::yields});
  }
  make_gates(way, std::move(meetings));
}

void Corridors::make_gates(Way& way, std::vector<Meeting> meetings) const {
  std::sort(meetings.begin(), meetings.end(),
            [](const Meeting& a, const Meeting& b) { return a.from != b.from ? a.from < b.from : a.way < b.way; });
  const double margin = 0.12 * body_.radius;
  const bool whole = way.kind == Way::Kind::exit && way.at_end;
  for (Meeting& meeting : meetings) {
    const double body = 2.0 * body_.radius + 3.0 * margin;
    if (way.gates.empty() || (!whole && meeting.from > way.gates.back().end + body))
      way.gates.push_back({whole ? -body_.front - margin : meeting.from - margin, meeting.to, {}});
    Gate& gate = way.gates.back();
    gate.end = std::max(gate.end, meeting.to);
    gate.meetings.push_back(meeting);
  }
}

void Corridors::make_lines() {
  for (std::uint32_t row = 0; row < ways_.size(); ++row) {
    Way& way = ways_[row];
    if (way.kind == Way::Kind::lane)
      for (const Gate& gate : way.gates) way.lines.push_back(gate.hold);
    if (way.from == world::kNone) continue;
    Way& lane = ways_[way.from];
    lane.out.push_back(row);
    for (const Gate& gate : way.gates)
      if (way.at_end && gate.hold < 0.0) lane.lines.push_back(way.leave + gate.hold);
  }
  for (Way& way : ways_) {
    std::sort(way.lines.begin(), way.lines.end());
    way.lines.erase(std::unique(way.lines.begin(), way.lines.end(), [](double a, double b) { return b - a < 1e-9; }),
                    way.lines.end());
  }
}

std::shared_ptr<const Corridors> shared_corridors(const world::RoadNetwork& roads, const world::World& world,
                                                  const Body& body) {
  // Whoever holds corridors keeps their network, so that an address names it while they live.
  struct Shared {
    const world::World* world;
    Body body;
    std::weak_ptr<const Corridors> corridors;
  };
  static std::mutex mutex;
  static std::vector<Shared> all;
  const std::lock_guard lock(mutex);
  std::erase_if(all, [](const Shared& shared) { return shared.corridors.expired(); });
  for (const Shared& shared : all) {
    const auto corridors = shared.corridors.lock();
    if (corridors && &corridors->roads() == &roads && shared.world == &world && shared.body == body) return corridors;
  }
  auto corridors = std::make_shared<const Corridors>(roads, world, body);
  all.push_back({&world, body, corridors});
  return corridors;
}

}  // namespace sf::control
