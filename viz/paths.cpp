#include "viz/paths.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace sf::viz {
namespace {

bool is_finite_line(const Line& l) { return std::isfinite(l.a.x + l.a.y + l.b.x + l.b.y); }

/// Clips by Liang and Barsky ("A new concept and method for line clipping", 1984).
std::optional<Line> cut_line(const Line& line, const PathBox& box) {
  const glm::dvec2 d = line.b - line.a;
  double from = 0.0, to = 1.0;
  const auto keep = [&](double step, double room) {  // keeps the part with t * step <= room
    if (step == 0.0) return room >= 0.0;
    if (step < 0.0) from = std::max(from, room / step);
    if (step > 0.0) to = std::min(to, room / step);
    return from <= to;
  };
  if (!keep(-d.x, line.a.x - box.low.x) || !keep(d.x, box.high.x - line.a.x) || !keep(-d.y, line.a.y - box.low.y) ||
      !keep(d.y, box.high.y - line.a.y))
    return std::nullopt;
  return Line{from > 0.0 ? line.a + from * d : line.a, to < 1.0 ? line.a + to * d : line.b};
}

/// Returns the part of a closed outline with axis * sign <= limit * sign (Sutherland and Hodgman, "Reentrant polygon
/// clipping", 1974).
std::vector<glm::dvec2> cut_side(const std::vector<glm::dvec2>& outline, int axis, double sign, double limit) {
  std::vector<glm::dvec2> kept;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    const double room_a = sign * (limit - a[axis]), room_b = sign * (limit - b[axis]);
    if (room_a >= 0.0) kept.push_back(a);
    if ((room_a < 0.0) != (room_b < 0.0)) kept.push_back(a + room_a / (room_a - room_b) * (b - a));
  }
  return kept;
}

bool is_in(const std::vector<glm::dvec2>& outline, const PathBox& box) {
  return std::all_of(outline.begin(), outline.end(), [&](const glm::dvec2& p) {
    return p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y;
  });
}

}  // namespace

Paths cut_lines(std::span<const Line> lines, const PathBox& box) {
  Paths paths;
  for (const Line& whole : lines) {
    if (!is_finite_line(whole)) continue;
    const std::optional<Line> l = cut_line(whole, box);
    if (!l) continue;
    if (paths.empty() || paths.back().back() != l->a) paths.push_back({l->a});
    if (l->b != l->a) paths.back().push_back(l->b);
  }
  return paths;
}

Paths join_edges(std::span<const Line> edges) {
  // Most edges are followed by the next one in the list, so a search for the successor is needed only at the end of an
  // outline.
  std::multimap<std::pair<double, double>, std::size_t> starts;
  std::vector<bool> used(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    used[i] = !is_finite_line(edges[i]);
    if (!used[i]) starts.insert({{edges[i].a.x, edges[i].a.y}, i});
  }
  const auto successor = [&](std::size_t i) {
    if (i + 1 < edges.size() && !used[i + 1] && edges[i + 1].a == edges[i].b) return i + 1;
    const auto [first, last] = starts.equal_range({edges[i].b.x, edges[i].b.y});
    const auto next = std::find_if(first, last, [&](const auto& start) { return !used[start.second]; });
    return next == last ? edges.size() : next->second;
  };
  Paths outlines;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (used[i]) continue;
    std::vector<glm::dvec2>& outline = outlines.emplace_back();
    for (std::size_t at = i; at < edges.size(); at = successor(at)) {
      used[at] = true;
      outline.push_back(edges[at].a);
      if (edges[at].b == outline.front()) break;
    }
  }
  return outlines;
}

Paths cut_outlines(Paths outlines, const PathBox& box) {
  for (auto& outline : outlines) {
    if (is_in(outline, box)) continue;
    for (const int axis : {0, 1}) {
      outline = cut_side(outline, axis, 1.0, box.high[axis]);
      outline = cut_side(outline, axis, -1.0, box.low[axis]);
    }
  }
  std::erase_if(outlines, [](const auto& outline) { return outline.size() < 2; });
  return outlines;
}

}  // namespace sf::viz
