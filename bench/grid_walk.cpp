// Compiled twice with different SF_WALK, see grid.h.

#include "base/reading.h"
#include "bench/grid.h"

namespace sf::bench {

namespace {

struct Hit {
  double range;
  std::uint32_t model;
};

void test(const SegmentGrid& grid, std::size_t cell, glm::dvec2 o, glm::dvec2 d, Hit& best) {
  for (std::uint32_t at = grid.first[cell]; at < grid.first[cell + 1]; ++at) {
    const SegmentGrid::Item& s = grid.items[at];
    const double wx = s.ax - o.x;
    const double wy = s.ay - o.y;
    const double below = s.ex * d.y - s.ey * d.x;
    const double across = d.x * wy - d.y * wx;
    const double above = s.ex * wy - s.ey * wx;
    // u = across / below in [0, 1] and t = above / below >= 0, tested without a division.
    const bool misses = below > 0.0 ? across < 0.0 || across > below || above < 0.0
                                    : across > 0.0 || across < below || above > 0.0 || below == 0.0;
    if (misses) continue;
    const double t = above / below;
    if (t < best.range) best = {t, s.model};
  }
}

/// Traversal along one axis: direction of the cells, and distance to the next cell.
struct Axis {
  int step;
  double next;   ///< [m] along the beam
  double every;  ///< [m] along the beam between cells
};

Axis axis(double origin, double direction, int index, double cell) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (direction == 0.0) return {0, kNever, kNever};
  const double edge = (direction > 0.0 ? index + 1 : index) * cell;
  return {direction > 0.0 ? 1 : -1, (edge - origin) / direction, cell / std::fabs(direction)};
}

Hit walk_beam(const SegmentGrid& grid, glm::dvec2 o, glm::dvec2 d, double range_max) {
  Hit best{range_max, base::kNoHit};
  int column = static_cast<int>(std::floor((o.x - grid.x) / grid.cell));
  int row = static_cast<int>(std::floor((o.y - grid.y) / grid.cell));
  Axis x = axis(o.x - grid.x, d.x, column, grid.cell);
  Axis y = axis(o.y - grid.y, d.y, row, grid.cell);
  while (column >= 0 && row >= 0 && column < grid.columns && row < grid.rows) {
    test(grid, static_cast<std::size_t>(row) * grid.columns + column, o, d, best);
    const double leaves = x.next < y.next ? x.next : y.next;
    if (best.range <= leaves) break;
    if (x.next < y.next) {
      column += x.step;
      x.next += x.every;
    } else {
      row += y.step;
      y.next += y.every;
    }
  }
  return best;
}

}  // namespace

void SF_WALK(const SegmentGrid& grid, const base::Pose& X_WS, const std::vector<glm::dvec2>& beams, double range_max,
             double* ranges, std::uint32_t* hits) {
  const double c = std::cos(X_WS.yaw);
  const double s = std::sin(X_WS.yaw);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const glm::dvec2 d{c * beams[i].x - s * beams[i].y, s * beams[i].x + c * beams[i].y};
    const Hit hit = walk_beam(grid, {X_WS.x, X_WS.y}, d, range_max);
    ranges[i] = hit.range;
    hits[i] = hit.model;
  }
}

}  // namespace sf::bench
