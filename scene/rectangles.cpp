#include "scene/rectangles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "base/pose.h"

namespace sf::scene {

namespace {

using glm::dvec2;

/// Parallel lines, by their coordinates across them.
class Lines {
 public:
  Lines() = default;
  /// @param rounding coordinates that differ by at most this belong to one line
  Lines(std::vector<double> at, double rounding) {
    std::ranges::sort(at);
    double last = -HUGE_VAL;
    for (const double x : at)
      if (x - std::exchange(last, x) > rounding) first_.push_back(x);
  }
  /// Returns the number of the line at a coordinate, from 0, as a coordinate of edges.
  double number(double x) const {
    return static_cast<double>(std::ranges::upper_bound(first_, x) - first_.begin()) - 1.0;
  }
  double at(double number) const { return first_[static_cast<std::size_t>(number)]; }

 private:
  std::vector<double> first_;  ///< smallest coordinate of each line
};

/// An edge along a column. Heights are numbers of rows.
struct Upright {
  double column = 0.0, low = 0.0, high = 0.0;
  dvec2 p_low, p_high;
};

/// The frame of the edges: its first axis is along the longest.
struct Frame {
  dvec2 origin, along;
  double rounding = 0.0;  ///< [m] largest difference of coordinates on one line

  dvec2 operator()(dvec2 p) const { return {glm::dot(along, p - origin), base::cross(along, p - origin)}; }
};

/// @return nullopt if the lines of the shortest edges may not be told apart
std::optional<Frame> frame_of(std::span<const RegionEdge> edges) {
  const RegionEdge* longest = &edges[0];
  dvec2 low{HUGE_VAL}, high{-HUGE_VAL};
  double shortest = HUGE_VAL;
  const auto length = [](const RegionEdge& e) { return glm::distance(e.a, e.b); };
  for (const RegionEdge& e : edges) {
    if (length(e) > length(*longest)) longest = &e;
    shortest = std::min(shortest, length(e));
    low = glm::min(low, e.a), high = glm::max(high, e.a);
  }
  const dvec2 far = glm::max(glm::abs(low), glm::abs(high));
  // The direction of the longest edge is known to a few roundings of its ends.
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * std::max(far.x, far.y) *
                          (1.0 + glm::distance(low, high) / length(*longest));
  if (!(16.0 * rounding < shortest)) return {};
  return Frame{longest->a, (longest->b - longest->a) / length(*longest), rounding};
}

/// Returns the point of the upright through `corner` (column, row), at its row.
dvec2 point_at(dvec2 corner, const std::vector<Upright>& uprights, const Lines& rows) {
  const auto next = std::ranges::upper_bound(uprights, std::pair(corner.x, corner.y), {},
                                             [](const Upright& u) { return std::pair(u.column, u.low); });
  const Upright& u = *(next - 1);
  if (corner.y == u.low) return u.p_low;
  if (corner.y == u.high) return u.p_high;
  const double part = (rows.at(corner.y) - rows.at(u.low)) / (rows.at(u.high) - rows.at(u.low));
  return u.p_low + part * (u.p_high - u.p_low);
}

}  // namespace

std::optional<std::vector<Trapezoid>> rectangles_of(std::span<const RegionEdge> edges) {
  if (edges.empty()) return std::vector<Trapezoid>{};
  const std::optional<Frame> local = frame_of(edges);
  if (!local) return {};
  std::vector<double> x, y;
  for (const RegionEdge& e : edges) x.push_back((*local)(e.a).x), y.push_back((*local)(e.a).y);
  const Lines columns(std::move(x), local->rounding), rows(std::move(y), local->rounding);
  const auto number = [&](dvec2 p) { return dvec2{columns.number((*local)(p).x), rows.number((*local)(p).y)}; };

  std::vector<RegionEdge> numbered;
  std::vector<Upright> uprights;
  for (const RegionEdge& e : edges) {
    const dvec2 a = number(e.a), b = number(e.b);
    if ((a.x == b.x) == (a.y == b.y)) return {};
    numbered.push_back({a, b});
    if (a.y < b.y) uprights.push_back({a.x, a.y, b.y, e.a, e.b});
    if (a.y > b.y) uprights.push_back({a.x, b.y, a.y, e.b, e.a});
  }
  std::ranges::sort(uprights, {}, [](const Upright& u) { return std::pair(u.column, u.low); });

  std::vector<Trapezoid> pieces = trapezoids_of(numbered);
  for (Trapezoid& piece : pieces)
    for (dvec2& corner : piece) corner = point_at(corner, uprights, rows);
  return pieces;
}

}  // namespace sf::scene
