#pragma once
// Index of movers by position: a hashed grid of points, rebuilt each tick.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "base/report.h"
#include "world/copies.h"

namespace sf::robots {

/// Thread-safe for queries, except during `build`.
class NeighbourGrid {
 public:
  /// @param reports one per row; allocates only if there are more than in all earlier calls
  /// @param cell [m] > 0, about twice the reach of a query
  /// @param copies of the world, which the rows belong to
  void build(std::span<const base::Report> reports, double cell, const world::CopyIndex& copies = {});

  /// Returns true as soon as `predicate(row)` is true for a row of `copy` whose cell, at the time of `build`, was
  /// within `reach` [m] of `p`. Calls the predicate at most once per row, in an order that depends on the number of
  /// rows.
  template <class Predicate>
  bool any(glm::dvec2 p, double reach, Predicate&& predicate, std::uint32_t copy = 0) const {
    const std::int64_t x1 = cell_of(p.x + reach), y1 = cell_of(p.y + reach);
    for (std::int64_t y = cell_of(p.y - reach); y <= y1; ++y) {
      for (std::int64_t x = cell_of(p.x - reach); x <= x1; ++x) {
        const Cell cell{x, y, copy};
        const std::size_t at = bucket(cell);
        for (std::uint32_t e = starts_[at]; e < starts_[at + 1]; ++e) {
          if (cells_[e] == cell && predicate(rows_[e])) return true;
        }
      }
    }
    return false;
  }

 private:
  struct Cell {
    std::int64_t x, y;
    std::uint32_t copy;
    bool operator==(const Cell&) const = default;
  };
  std::int64_t cell_of(double v) const {
    constexpr double kFarthest = 4.0e15;  // keeps cell numbers exact integers for any reported position
    const double at = std::clamp(v / cell_, -kFarthest, kFarthest);
    const auto whole = static_cast<std::int64_t>(at);
    return whole - (static_cast<double>(whole) > at ? 1 : 0);  // std::floor is a call without SSE4.1
  }
  std::size_t bucket(const Cell& cell) const;

  double cell_ = 1.0;
  std::vector<std::uint32_t> starts_;  ///< per bucket, index into rows_; one extra entry at the end
  std::vector<std::uint32_t> rows_;
  std::vector<Cell> cells_;               ///< parallel to rows_: several cells share a bucket
  std::vector<std::uint32_t> bucket_of_;  ///< per row
};

}  // namespace sf::robots
