#include "world/stage/polygon.h"

#include <algorithm>
#include <cmath>

namespace sf::world {

using base::cross;

namespace {

bool coincide(glm::dvec2 p, glm::dvec2 q) { return p.x == q.x && p.y == q.y; }

void drop_repeated(std::vector<glm::dvec2>& points) {
  points.erase(std::unique(points.begin(), points.end(), coincide), points.end());
  while (points.size() > 1 && coincide(points.front(), points.back())) points.pop_back();
}

double twice_area(const std::vector<glm::dvec2>& points) {
  double sum = 0.0;  // relative to the first corner, so the result does not depend on the polygon's position
  for (std::size_t i = 1; i + 1 < points.size(); ++i) sum += cross(points[i] - points[0], points[i + 1] - points[0]);
  return sum;
}

double extent(const std::vector<glm::dvec2>& points) {
  double most = 0.0;
  for (const glm::dvec2& p : points) most = std::max({most, std::abs(p.x - points[0].x), std::abs(p.y - points[0].y)});
  return most;
}

int side(const PolygonEdge& edge, glm::dvec2 p) {
  const double value = cross(edge.b - edge.a, p - edge.a);
  return (value > 0.0) - (value < 0.0);
}

bool between(const PolygonEdge& edge, glm::dvec2 p) {
  return std::min(edge.a.x, edge.b.x) <= p.x && p.x <= std::max(edge.a.x, edge.b.x) &&
         std::min(edge.a.y, edge.b.y) <= p.y && p.y <= std::max(edge.a.y, edge.b.y);
}

bool meet(const PolygonEdge& e, const PolygonEdge& f) {
  const int ea = side(f, e.a), eb = side(f, e.b), fa = side(e, f.a), fb = side(e, f.b);
  if (ea * eb < 0 && fa * fb < 0) return true;
  return (ea == 0 && between(f, e.a)) || (eb == 0 && between(f, e.b)) || (fa == 0 && between(e, f.a)) ||
         (fb == 0 && between(e, f.b));
}

bool folds_back(const PolygonEdge& first, const PolygonEdge& second) {
  const glm::dvec2 d = first.b - first.a;
  const glm::dvec2 e = second.b - second.a;
  return cross(d, e) == 0.0 && dot(d, e) < 0.0;
}

/// The extent of an edge along x.
struct EdgeSpan {
  double min, max;
  std::size_t edge;
};

/// Returns the extents sorted by lower end, so those that overlap an extent follow it.
std::vector<EdgeSpan> spans_of(const std::vector<PolygonEdge>& edges) {
  std::vector<EdgeSpan> spans;
  spans.reserve(edges.size());
  for (const PolygonEdge& e : edges) spans.push_back({std::min(e.a.x, e.b.x), std::max(e.a.x, e.b.x), spans.size()});
  std::sort(spans.begin(), spans.end(), [](const EdgeSpan& s, const EdgeSpan& t) { return s.min < t.min; });
  return spans;
}

double overlapping_pairs(const std::vector<EdgeSpan>& spans) {
  double pairs = 0.0;
  for (auto span = spans.begin(); span != spans.end(); ++span)
    pairs += static_cast<double>(
        std::upper_bound(span, spans.end(), span->max, [](double max, const EdgeSpan& s) { return max < s.min; }) -
        span - 1);
  return pairs;
}

bool is_simple(const std::vector<PolygonEdge>& edges, const std::vector<EdgeSpan>& spans) {
  const std::size_t n = edges.size();
  for (std::size_t i = 0; i < n; ++i)
    if (folds_back(edges[i], edges[(i + 1) % n])) return false;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n && spans[j].min <= spans[i].max; ++j) {
      const std::size_t apart = std::max(spans[i].edge, spans[j].edge) - std::min(spans[i].edge, spans[j].edge);
      const bool neighbours = apart == 1 || apart == n - 1;
      if (!neighbours && meet(edges[spans[i].edge], edges[spans[j].edge])) return false;
    }
  return true;
}

}  // namespace

std::optional<Polygon> make_polygon(std::vector<glm::dvec2> points, double& pairs) {
  drop_repeated(points);
  if (points.size() < 2) return Polygon{};
  if (points.size() == 2) return Polygon{{{points[0], points[1]}}, false};

  const double area = twice_area(points);
  if (area < 0.0) std::reverse(points.begin(), points.end());
  Polygon outline;
  outline.edges.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) outline.edges.push_back({points[i], points[(i + 1) % points.size()]});
  const double size = extent(points);
  outline.solid_left = std::abs(area) > 1e-12 * size * size;
  if (!outline.solid_left) return outline;

  const std::vector<EdgeSpan> spans = spans_of(outline.edges);
  const double compared = overlapping_pairs(spans);
  if (compared > pairs) return std::nullopt;
  pairs -= compared;
  outline.solid_left = is_simple(outline.edges, spans);
  return outline;
}

Polygon make_polygon(std::vector<glm::dvec2> points) {
  double pairs = HUGE_VAL;
  return *make_polygon(std::move(points), pairs);
}

}  // namespace sf::world
