#include "scenarios/sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/elementary.h"
#include "base/pose.h"

namespace sf::scenarios {

namespace {

using base::cross;
using maps::CellAt;

constexpr double kTouch = 1e-9;      ///< [m] a wall within this distance passes through the point
constexpr double kSlack = 1e-6;      ///< [m] added to triangles, far above the error of their corners
constexpr double kFirstSize = 0.75;  ///< [m] of the first square around a point
constexpr double kGrowth = 4.0;      ///< factor of the next ones

/// Returns a value in [-2, 2] that increases with the angle from -pi to pi.
double pseudo_angle(glm::dvec2 d) {
  const double part = d.x / (std::abs(d.x) + std::abs(d.y));
  return d.y < 0.0 ? part - 1.0 : 1.0 - part;
}

struct Interval {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  void add(double x) {
    least = std::min(least, x);
    most = std::max(most, x);
  }
};

/// Adds the x range of the part of the line from `p` to `q` with y in [low, high].
void add_clipped(glm::dvec2 p, glm::dvec2 q, double low, double high, Interval& x) {
  if (p.y > q.y) std::swap(p, q);
  if (q.y < low || p.y > high) return;
  const double dy = q.y - p.y;
  const auto at = [&](double y) { return p.x + (q.x - p.x) * (y - p.y) / dy; };
  x.add(p.y >= low ? p.x : at(low));
  x.add(q.y <= high ? q.x : at(high));
}

/// Returns the intersection along the direction from the origin, in units of its length; infinity: it misses the line.
double meeting(glm::dvec2 direction, glm::dvec2 a, glm::dvec2 b) {
  const double across = cross(direction, b - a);
  return across > 0.0 ? cross(a, b - a) / across : std::numeric_limits<double>::infinity();
}

}  // namespace

Sight::Sight(std::vector<world::Segment> walls, const sensors::SensorSpec& laser, const maps::OccupancyGrid& robots)
    : walls_(walls),
      laser_(laser),
      robots_(robots),
      margin_(1 + maps::whole_below(1.0 + base::hypot(laser.X_MS.x, laser.X_MS.y) / robots.geometry.cell)),
      box_(base::empty_box()) {
  const maps::GridGeometry& grid = robots.geometry;
  for (int h = 0; h < kHeadings; ++h) {
    const base::Pose X_RS = base::compose({0.0, 0.0, 0.0, 2.0 * M_PI * h / kHeadings}, laser.X_MS);
    headings_[h] = {{X_RS.x, X_RS.y},
                    X_RS.yaw,
                    {maps::whole_below(0.5 + X_RS.x / grid.cell), maps::whole_below(0.5 - X_RS.y / grid.cell)}};
  }
  count_eyes();
}

void Sight::count_eyes() {
  const maps::GridGeometry& grid = robots_.geometry;
  const std::int64_t columns = maps::columns(grid), rows = maps::rows(grid);
  eyes_.assign(static_cast<std::size_t>((columns + 2 * margin_ + 1) * (rows + 2 * margin_)), 0);
  for (std::int64_t row = 0; row < rows; ++row)
    for (std::int64_t column = 0; column < columns; ++column) {
      if (robots_.at({column, row}) != maps::Cell::free) continue;
      for (const Heading& heading : headings_) {
        const CellAt eye{column + heading.cells.column, row + heading.cells.row};
        eyes_[place_of(eye) + 1] = 1;
        box_ = base::united(box_, base::box_around(maps::middle(grid, eye), grid.cell));
      }
    }
  for (std::int64_t row = -margin_; row < rows + margin_; ++row)
    for (std::int64_t column = -margin_; column < columns + margin_; ++column) {
      const std::size_t at = place_of({column, row});
      eyes_[at + 1] += eyes_[at];
    }
}

bool Sight::is_clear(glm::dvec2 from, glm::dvec2 to) const {
  const glm::dvec2 along = to - from;
  const double end = 1.0 - kTouch / glm::length(along);
  return !walls_.any(base::box_of(from, to), [&](const world::Segment& wall) {
    const glm::dvec2 side = wall.b - wall.a;
    const double across = cross(along, side);
    if (across == 0.0) return false;
    const double t = cross(wall.a - from, side) / across, u = cross(wall.a - from, along) / across;
    return t >= 0.0 && t < end && u >= 0.0 && u <= 1.0;
  });
}

bool Sight::sees(CellAt robot, const Heading& heading, glm::dvec2 p) const {
  const glm::dvec2 origin = maps::middle(robots_.geometry, robot), eye = origin + heading.eye;
  const glm::dvec2 d = base::rotate(-heading.yaw, p - eye);
  const double far = glm::length(d);
  if (far >= laser_.limit || std::abs(base::atan2(d.y, d.x)) > 0.5 * laser_.fov) return false;
  return is_clear(eye, p) && (heading.eye == glm::dvec2{} || is_clear(origin, eye));
}

bool Sight::sees(CellAt robot, glm::dvec2 p) const {
  return is_robot(robot) && std::any_of(headings_.begin(), headings_.end(),
                                        [&](const Heading& heading) { return sees(robot, heading, p); });
}

void Sight::add_edge(glm::dvec2 a, glm::dvec2 b, bool is_wall) {
  const double turn = cross(a, b);
  if (turn < 0.0) std::swap(a, b);
  if (turn == 0.0) return;
  const double first = pseudo_angle(a), last = pseudo_angle(b);
  directions_.push_back({first, a});
  directions_.push_back({last, b});
  if (first <= last) {
    edges_.push_back({a, b, first, last, is_wall});
  } else {  // crosses the direction of -x
    edges_.push_back({a, b, first, 2.0, is_wall});
    edges_.push_back({a, b, -2.0, last, is_wall});
  }
}

/// Collects walls in a square of 2 `size` around the point, and its sides, sorted by their first angle.
void Sight::gather(glm::dvec2 p, double size) {
  edges_.clear();
  directions_.assign({{-2.0, {-1.0, 0.0}}, {2.0, {-1.0, 0.0}}});
  walls_.any(base::box_around(p, size), [&](const world::Segment& wall) {
    if (world::distance(p, wall.a, wall.b) > kTouch) add_edge(wall.a - p, wall.b - p, true);
    return false;
  });
  const glm::dvec2 corners[4] = {{size, size}, {-size, size}, {-size, -size}, {size, -size}};
  for (int i = 0; i < 4; ++i) add_edge(corners[i], corners[(i + 1) % 4], false);
  std::sort(edges_.begin(), edges_.end(), [](const Edge& x, const Edge& y) { return x.first < y.first; });
  std::sort(directions_.begin(), directions_.end(),
            [](const Direction& x, const Direction& y) { return x.angle < y.angle; });
}

/// Returns false only if no eye is between the directions from the point.
bool Sight::may_reach_eyes(glm::dvec2 p, glm::dvec2 d0, glm::dvec2 d1) const {
  const glm::dvec2 corners[4] = {
      box_.min - p, box_.max - p, {box_.min.x - p.x, box_.max.y - p.y}, {box_.max.x - p.x, box_.min.y - p.y}};
  const auto all = [&](auto&& test) { return std::all_of(corners, corners + 4, test); };
  return !all([&](glm::dvec2 c) { return cross(d0, c) < 0.0; }) &&
         !all([&](glm::dvec2 c) { return cross(d1, c) > 0.0; }) &&
         !all([&](glm::dvec2 c) { return glm::dot(d0, c) < 0.0 && glm::dot(d1, c) < 0.0; });
}

/// @param open out: whether a direction to eyes is clear up to the edge of the square
std::optional<CellAt> Sight::find_within(glm::dvec2 p, double size, bool& open) {
  gather(p, size);
  active_.clear();
  std::size_t next = 0;
  for (std::size_t i = 0; i + 1 < directions_.size(); ++i) {
    const Direction &from = directions_[i], &to = directions_[i + 1];
    if (!(from.angle < to.angle)) continue;
    std::erase_if(active_, [&](const Edge* edge) { return edge->last <= from.angle; });
    for (; next < edges_.size() && edges_[next].first <= from.angle; ++next)
      if (edges_[next].last > from.angle) active_.push_back(&edges_[next]);
    const glm::dvec2 d0 = glm::normalize(from.d), d1 = glm::normalize(to.d), half = d0 + d1;
    const Edge* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const Edge* edge : active_)
      if (const double t = meeting(half, edge->a, edge->b); t < least) least = t, nearest = edge;
    if (nearest == nullptr) continue;
    const double t0 = meeting(d0, nearest->a, nearest->b), t1 = meeting(d1, nearest->a, nearest->b);
    const double most = std::max(glm::length(nearest->a), glm::length(nearest->b));  // where rounding misses an end
    if (const auto found = find_in_triangle(p, std::min(t0, most) * d0, std::min(t1, most) * d1)) return found;
    open = open || (!nearest->is_wall && may_reach_eyes(p, d0, d1));
  }
  return std::nullopt;
}

/// @param q0, q1 [m] corners opposite the corner `p`
std::optional<CellAt> Sight::find_in_triangle(glm::dvec2 p, glm::dvec2 q0, glm::dvec2 q1) const {
  const maps::GridGeometry& grid = robots_.geometry;
  const double top = std::min(p.y + std::max({0.0, q0.y, q1.y}), box_.max.y) + kSlack;
  const double bottom = std::max(p.y + std::min({0.0, q0.y, q1.y}), box_.min.y) - kSlack;
  if (!(bottom <= top)) return std::nullopt;
  const std::int64_t first = std::max(-margin_, maps::cell_at(grid, {grid.left, top}).row);
  const std::int64_t last = std::min(maps::rows(grid) + margin_ - 1, maps::cell_at(grid, {grid.left, bottom}).row);
  for (std::int64_t row = first; row <= last; ++row) {
    const double high = grid.top - static_cast<double>(row) * grid.cell - p.y + kSlack;
    const double low = high - grid.cell - 2.0 * kSlack;
    Interval x;
    add_clipped({}, q0, low, high, x);
    add_clipped({}, q1, low, high, x);
    add_clipped(q0, q1, low, high, x);
    if (!(x.least <= x.most)) continue;
    const auto column = [&](double at) {
      return std::clamp(maps::cell_at(grid, {p.x + at, grid.top}).column, -margin_, maps::columns(grid) + margin_ - 1);
    };
    const std::uint32_t* const before = &eyes_[place_of({0, row})];
    const std::int64_t end = column(x.most + kSlack) + 1;
    for (std::int64_t at = column(x.least - kSlack); at < end && before[at] < before[end]; ++at) {
      if (before[at] == before[at + 1]) continue;
      for (const Heading& heading : headings_) {
        const CellAt robot{at - heading.cells.column, row - heading.cells.row};
        if (is_robot(robot) && sees(robot, heading, p)) return robot;
      }
    }
  }
  return std::nullopt;
}

std::optional<CellAt> Sight::find(glm::dvec2 p) {
  for (double size = std::min(kFirstSize, laser_.limit);; size = std::min(kGrowth * size, laser_.limit)) {
    bool open = false;
    if (const auto found = find_within(p, size, open)) return found;
    if (!open || size >= laser_.limit) return std::nullopt;
  }
}

}  // namespace sf::scenarios
