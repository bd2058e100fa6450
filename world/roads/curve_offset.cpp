// Parallels of a curve without loops at tight bends. Where the curve bends more tightly than the distance, points of
// the parallel that are closer to the curve than the distance are left out, and the two ends are joined at their
// intersection.

#include <algorithm>
#include <cmath>
#include <optional>

#include "world/roads/curve.h"

namespace sf::world {

namespace {

constexpr double kAround =
    4.0;  // [distances] length along the curve around a tight bend in which points may be left out
constexpr std::size_t kReach = 400;  // pieces of the curve on each side that are compared with a point
constexpr std::size_t kEnds = 8;     // pieces at each end of a gap that are searched for the intersection
constexpr double kNearer = 2e-3;     // [distances] tolerance for the rounding of the polyline

/// Returns the intersection of the pieces a-b and c-d.
std::optional<glm::dvec2> crossing(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const glm::dvec2 ab = b - a;
  const glm::dvec2 cd = d - c;
  const double area = base::cross(ab, cd);
  if (area == 0.0) return std::nullopt;
  const double t = base::cross(c - a, cd) / area;
  const double u = base::cross(c - a, ab) / area;
  if (t < 0.0 || t > 1.0 || u < 0.0 || u > 1.0) return std::nullopt;
  return a + t * ab;
}

double distance(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 d = b - a;
  return length(p - (a + std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0) * d));
}

/// The complete parallel, and which of its points are kept.
struct Raw {
  std::vector<glm::dvec2> points;
  std::vector<bool> kept;
};

// Returns true if no piece of the curve within reach is closer to the raw point than `distance_to_keep`.
bool is_clear(const Curve& curve, glm::dvec2 p, std::size_t i, double distance_to_keep) {
  const double around = kAround * distance_to_keep;
  const double least = (1.0 - kNearer) * distance_to_keep;
  for (std::size_t j = i, n = 0; j > 0 && n < kReach && curve.s[i] - curve.s[j] < around; --j, ++n)
    if (distance(p, curve.points[j - 1], curve.points[j]) < least) return false;
  for (std::size_t j = i, n = 0; j + 1 < curve.points.size() && n < kReach && curve.s[j] - curve.s[i] < around;
       ++j, ++n)
    if (distance(p, curve.points[j], curve.points[j + 1]) < least) return false;
  return true;
}

Raw raw_parallel(const Curve& curve, double distance) {
  const std::size_t n = curve.points.size();
  Raw raw;
  for (std::size_t i = 0; i < n; ++i)
    raw.points.push_back(curve.points[i] + distance * glm::dvec2{-curve.tangents[i].y, curve.tangents[i].x});
  raw.kept.assign(n, true);

  // Pieces in reverse direction mark bends that are too tight. Only points around them are tested.
  double last = -INFINITY;  // [m] along the curve, of the last reversed piece
  const double around = kAround * std::abs(distance);
  std::vector<double> back(n, INFINITY);
  for (std::size_t i = 0; i < n; ++i) {
    const bool backwards =
        i + 1 < n && dot(raw.points[i + 1] - raw.points[i], curve.points[i + 1] - curve.points[i]) <= 0.0;
    if (backwards) last = curve.s[i + 1];
    back[i] = curve.s[i] - last;
  }
  double next = INFINITY;
  for (std::size_t i = n; i-- > 0;) {
    if (back[i] <= 0.0) next = curve.s[i];
    if (std::min(back[i], next - curve.s[i]) < around)
      raw.kept[i] = is_clear(curve, raw.points[i], i, std::abs(distance));
  }
  return raw;
}

void add_distinct(std::vector<glm::dvec2>& line, glm::dvec2 p) {
  if (line.empty() || length(p - line.back()) > 1e-9) line.push_back(p);
}

/// How the run of kept points [begin, end) continues: its intersection with the next run [from, to), if any.
struct Join {
  std::size_t leave = 0;  ///< last point of the run before it
  std::size_t enter = 0;  ///< first point of the run after it
  std::optional<glm::dvec2> at;
};

Join join(const std::vector<glm::dvec2>& raw, std::size_t begin, std::size_t end, std::size_t from, std::size_t to) {
  for (std::size_t i = end; i-- > begin && end - i <= kEnds;)
    for (std::size_t j = from; j < to && j - from < kEnds; ++j)
      if (const auto at = crossing(raw[i], raw[i + 1], raw[j - 1], raw[j])) return {i, j, at};
  return {end - 1, from, std::nullopt};
}

}  // namespace

std::vector<glm::dvec2> offset_curve(const Curve& curve, double distance) {
  const std::size_t n = curve.points.size();
  if (n < 2) return {};
  const Raw raw = raw_parallel(curve, distance);
  const auto next_kept = [&](std::size_t i) {
    while (i < n && !raw.kept[i]) ++i;
    return i;
  };
  const auto end_of_run = [&](std::size_t i) {
    while (i < n && raw.kept[i]) ++i;
    return i;
  };

  std::vector<glm::dvec2> line;
  std::size_t begin = next_kept(0);
  while (begin < n) {
    const std::size_t end = end_of_run(begin);
    const std::size_t from = next_kept(end);
    Join way{end - 1, n, std::nullopt};
    if (from < n) way = join(raw.points, begin, end, from, end_of_run(from));
    for (std::size_t i = begin; i <= way.leave; ++i) add_distinct(line, raw.points[i]);
    if (way.at) add_distinct(line, *way.at);
    begin = way.enter;
  }
  return line.size() < 2 ? std::vector<glm::dvec2>{} : line;
}

}  // namespace sf::world
