#include "sensors/lane_markings/outline.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace sf::sensors {

namespace {

bool same(glm::dvec2 p, glm::dvec2 q) { return p.x == q.x && p.y == q.y; }

glm::dvec2 direction(glm::dvec2 from, glm::dvec2 to) {
  const glm::dvec2 d = to - from;
  return (1.0 / length(d)) * d;
}

glm::dvec2 left_of(glm::dvec2 d) { return {-d.y, d.x}; }

/// Returns the offset from a vertex of the line to its left side, at half the width from both adjacent pieces.
glm::dvec2 mitre(glm::dvec2 before, glm::dvec2 after, double half) {
  const glm::dvec2 sum = left_of(before) + left_of(after);
  return (2.0 * half / dot(sum, sum)) * sum;
}

/// Both sides of the line, point by point.
struct Sides {
  std::vector<glm::dvec2> left, right;
};

Sides sides_of(const std::vector<glm::dvec2>& line, double half, bool closed) {
  Sides sides;
  const std::size_t count = closed ? line.size() - 1 : line.size();
  for (std::size_t i = 0; i < count; ++i) {
    const bool starts = i == 0 && !closed;
    const bool ends = i + 1 == count && !closed;
    const glm::dvec2 previous = i == 0 ? line[count - 1] : line[i - 1];
    const glm::dvec2 next = i + 1 == count ? line[0] : line[i + 1];
    const glm::dvec2 before = starts ? direction(line[i], next) : direction(previous, line[i]);
    const glm::dvec2 after = ends ? before : direction(line[i], next);
    const glm::dvec2 offset = mitre(before, after, half);
    sides.left.push_back(line[i] + offset);
    sides.right.push_back(line[i] - offset);
  }
  return sides;
}

/// Returns true when a side of a piece runs against the line: the band is wider than the bend allows.
bool runs_back(const std::vector<glm::dvec2>& line, const std::vector<glm::dvec2>& side) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const glm::dvec2 along = side[(i + 1) % side.size()] - side[i];
    if (dot(along, line[i + 1] - line[i]) <= 0.0) return true;
  }
  return false;
}

void add_side(const std::vector<glm::dvec2>& side, bool closed, bool forward, bool solid,
              std::vector<OutlineEdge>& out) {
  const std::size_t pieces = closed ? side.size() : side.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    const glm::dvec2 a = side[i];
    const glm::dvec2 b = side[(i + 1) % side.size()];
    if (!same(a, b)) out.push_back({forward ? a : b, forward ? b : a, false, solid});
  }
}

bool is_closed(const std::vector<glm::dvec2>& line) { return line.size() > 3 && same(line.front(), line.back()); }

}  // namespace

void add_quads(const world::LaneMarking& marking, std::vector<Quad>& out) {
  const auto [left, right] = sides_of(marking.line, 0.5 * marking.width, is_closed(marking.line));
  for (std::size_t i = 0; i + 1 < marking.line.size(); ++i) {
    const std::size_t j = (i + 1) % left.size();
    out.push_back({right[i], right[j], left[j], left[i]});
  }
}

void add_outline(const world::LaneMarking& marking, std::vector<OutlineEdge>& out) {
  const std::vector<glm::dvec2>& line = marking.line;
  const bool closed = is_closed(line);
  const Sides sides = sides_of(line, 0.5 * marking.width, closed);
  const bool solid = !runs_back(line, sides.left) && !runs_back(line, sides.right);
  add_side(sides.right, closed, true, solid, out);
  add_side(sides.left, closed, false, solid, out);
  if (closed) return;
  out.push_back({sides.right.back(), sides.left.back(), true, solid});
  out.push_back({sides.left.front(), sides.right.front(), true, solid});
}

std::vector<world::LaneMarking> distinct_markings(std::span<const world::LaneMarking> lane_markings, double within) {
  using Key = std::tuple<std::size_t, std::int64_t, std::int64_t>;
  // Keys are coarse squares of [m]. Equal markings may fall into neighbouring squares, so all neighbours are searched.
  const double square = std::max(1e-2, 4.0 * within);
  const auto key_of = [&](const world::LaneMarking& s, int dx, int dy) {
    const glm::dvec2 sum = s.line.front() + s.line.back();
    return Key{s.line.size(), static_cast<std::int64_t>(std::floor(sum.x / square)) + dx,
               static_cast<std::int64_t>(std::floor(sum.y / square)) + dy};
  };
  const auto alike = [&](const world::LaneMarking& p, const world::LaneMarking& q, bool turned) {
    const std::size_t n = p.line.size();
    if (std::fabs(p.width - q.width) > within) return false;
    for (std::size_t i = 0; i < n; ++i)
      if (length(p.line[i] - q.line[turned ? n - 1 - i : i]) > within) return false;
    return true;
  };
  std::vector<world::LaneMarking> kept;
  std::map<Key, std::vector<std::size_t>> known;
  for (const world::LaneMarking& marking : lane_markings) {
    bool is_new = true;
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found = known.find(key_of(marking, dx, dy));
        if (found == known.end()) continue;
        for (const std::size_t k : found->second)
          is_new = is_new && !alike(marking, kept[k], false) && !alike(marking, kept[k], true);
      }
    if (!is_new) continue;
    known[key_of(marking, 0, 0)].push_back(kept.size());
    kept.push_back(marking);
  }
  return kept;
}

}  // namespace sf::sensors
