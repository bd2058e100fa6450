#include "maps/range_evidence.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::maps {

namespace {

constexpr double kPrior = 0.3;         // probability that an unexplored cell of an arc is occupied
constexpr double kLeastWeight = 0.05;  // of a cell in an arc
constexpr double kWidest = 1.4;        // [rad] half aperture up to which rows are clipped
constexpr double kSigmas = 4.0;        // beyond the range
constexpr double kFarthestApex = 1e9;  // [cells]

std::uint32_t cell_index(const GridGeometry& geometry, std::int64_t column, std::int64_t row) {
  return static_cast<std::uint32_t>(16 * word_of(geometry, {column, row})) + place_of({column, row});
}

/// Probability that a normal deviate is below `x`.
double below(double x) { return 0.5 * base::erfc(-x * M_SQRT1_2); }

}  // namespace

/// A cone on the lattice of a map: in cells, with y along rows.
struct RangeEvidence::Cone {
  glm::dvec2 apex, axis;
  double half, slope;  ///< [rad], [-] of its sides
  double range, sigma, seen;
  bool has_echo;
  double reach;  ///< to the last cell that counts

  Cone(const GridGeometry& geometry, const RangeCone& c)
      : apex((c.X_WC.x - geometry.left) / geometry.cell, (geometry.top - c.X_WC.y) / geometry.cell),
        axis(base::cos(c.X_WC.yaw), -base::sin(c.X_WC.yaw)),
        half(c.half),
        slope(base::tan(std::min(c.half, kWidest))),
        range(c.range / geometry.cell),
        sigma(std::max(c.sigma / geometry.cell, 1e-6)),
        seen(c.seen),
        has_echo(c.has_echo),
        reach(range + 1.0 + (c.has_echo ? kSigmas * sigma : 0.0)) {}

  /// Narrows [low, high] of u = x - apex.x to the cone at v = y - apex.y.
  void clip(double v, double& low, double& high) const {
    if (half > kWidest) return;
    for (const double side : {-1.0, 1.0}) {
      // side * across - slope * along <= 1/2
      const double k = -side * axis.y - slope * axis.x, rest = 0.5 - (side * axis.x - slope * axis.y) * v;
      if (k > 0.0) high = std::min(high, rest / k);
      if (k < 0.0) low = std::max(low, rest / k);
      if (k == 0.0 && rest < 0.0) low = 1.0, high = 0.0;
    }
  }
};

void RangeEvidence::add_cell(std::uint32_t cell, const Cone& cone, double along, double across) {
  const double r = base::hypot(along, across);
  double weight = 1.0;
  if (cone.half > 0.0) {
    // Near the apex a cone is as wide as a cell.
    const double share = std::abs(base::atan2(across, along)) / std::max(cone.half, 0.5 / std::max(r, 0.5));
    if (share >= 1.0) return;
    weight = 1.0 - share * share;
  } else if (along < 0.0) {
    return;
  }
  const double nearer = below((cone.range - r - 0.5) / cone.sigma);  // that the surface is beyond the cell
  if (cone.has_echo) {
    const double within = weight * (below((cone.range - r + 0.5) / cone.sigma) - nearer);
    if (within >= kLeastWeight) {
      arc_parts_.push_back({cell, static_cast<float>(std::min(within, 1.0))});
      return;
    }
  }
  const double free = weight * nearer * cone.seen;
  if (free > 0.0) free_parts_.push_back({cell, static_cast<float>(free)});
}

/// The cell with the echo on the axis counts as if its middle were there: an oblique beam may miss the middles of all.
void RangeEvidence::trace(const GridGeometry& geometry, const RangeCone& of) {
  const Cone cone(geometry, of);
  if (!(std::abs(cone.apex.x) < kFarthestApex && std::abs(cone.apex.y) < kFarthestApex)) return;
  const glm::dvec2 echo = cone.apex + cone.range * cone.axis;
  const CellAt at{whole_below(echo.x), whole_below(echo.y)};
  glm::dvec2 low{-cone.reach, -cone.reach}, high{cone.reach, cone.reach};
  if (cone.half == 0.0) {
    const glm::dvec2 end = cone.reach * cone.axis;
    low = {std::min(0.0, end.x) - 1.0, std::min(0.0, end.y) - 1.0};
    high = {std::max(0.0, end.x) + 1.0, std::max(0.0, end.y) + 1.0};
  }
  const auto first = static_cast<std::uint32_t>(arc_parts_.size());
  if (cone.has_echo && contains(geometry, at)) add_cell(cell_index(geometry, at.column, at.row), cone, cone.range, 0.0);
  const std::int64_t row_end = std::min(rows(geometry), whole_below(cone.apex.y + high.y) + 1);
  for (std::int64_t row = std::max<std::int64_t>(0, whole_below(cone.apex.y + low.y)); row < row_end; ++row) {
    const double v = static_cast<double>(row) + 0.5 - cone.apex.y;
    double from = low.x, to = high.x;
    cone.clip(v, from, to);
    if (from > to) continue;
    const std::int64_t end = std::min(columns(geometry), whole_below(cone.apex.x + to) + 1);
    for (std::int64_t column = std::max<std::int64_t>(0, whole_below(cone.apex.x + from)); column < end; ++column) {
      if (cone.has_echo && column == at.column && row == at.row) continue;
      const double u = static_cast<double>(column) + 0.5 - cone.apex.x;
      const double along = u * cone.axis.x + v * cone.axis.y, across = v * cone.axis.x - u * cone.axis.y;
      const bool inside = cone.half > kWidest || std::abs(across) <= 0.5 + cone.slope * std::max(along, 0.0);
      if (inside && along * along + across * across <= cone.reach * cone.reach)
        add_cell(cell_index(geometry, column, row), cone, along, across);
    }
  }
  if (arc_parts_.size() > first) arcs_.push_back({first, static_cast<std::uint32_t>(arc_parts_.size())});
}

void RangeEvidence::trace(const GridGeometry& geometry, std::span<const RangeCone> cones) {
  arcs_.clear(), arc_parts_.clear(), free_parts_.clear();
  for (const RangeCone& cone : cones) trace(geometry, cone);
}

void RangeEvidence::note(std::uint32_t cell, std::int32_t change) {
  std::int16_t& noted = changes_[cell];
  if (noted == 0) changed_.push_back(cell);
  const bool stronger = change > 0 ? change > noted : noted <= 0 && change < noted;
  if (stronger) noted = static_cast<std::int16_t>(change);
}

void RangeEvidence::weigh_arc(const LogOddsGrid& grid, const Arc& arc) {
  constexpr double kUnit = 100.0;
  const double offset = base::log(kPrior / (1.0 - kPrior));
  const auto not_caused = [&](const Part& part) {
    const double p = 1.0 / (1.0 + base::exp(-(static_cast<double>(grid.cells[part.cell]) / kUnit + offset)));
    return std::max(1.0 - static_cast<double>(part.weight) * p, 1e-9);
  };
  const std::span<const Part> parts = std::span(arc_parts_).subspan(arc.first, arc.end - arc.first);
  double none = 1.0 - base::exp(-grid.rule.hit / kUnit);
  for (const Part& part : parts) none *= not_caused(part);
  for (const Part& part : parts) {
    const double without = std::min(none / not_caused(part), 1.0), w = part.weight;
    const double gain = base::log((1.0 - (1.0 - w) * without) / (1.0 - without));
    note(part.cell, static_cast<std::int32_t>(std::lround(kUnit * std::min(gain, 300.0))));
  }
}

void RangeEvidence::add_to(LogOddsGrid& grid) {
  if (changes_.size() < grid.cells.size()) changes_.resize(grid.cells.size());
  for (const Part& part : free_parts_)
    note(part.cell, -static_cast<std::int32_t>(std::lround(grid.rule.miss * static_cast<double>(part.weight))));
  for (const Arc& arc : arcs_) weigh_arc(grid, arc);
  for (const std::uint32_t cell : changed_) {
    const std::int32_t sum = std::clamp(grid.cells[cell] + changes_[cell], -grid.rule.limit, grid.rule.limit);
    grid.cells[cell] = static_cast<std::int16_t>(sum);
    const std::uint32_t state = state_of(sum);
    std::uint32_t& word = grid.words[cell / 16];
    word = (word & ~(3u << 2 * (cell % 16))) | state << 2 * (cell % 16);
    changes_[cell] = 0;
  }
  changed_.clear();
}

}  // namespace sf::maps
