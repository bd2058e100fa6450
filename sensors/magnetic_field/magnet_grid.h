#pragma once
// Which magnets lie near a place: square cells in rows, and magnets in the order of their cells, so that what is near
// in one row of cells is one span of them.

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "sensors/magnetic_field/records.h"

namespace sf::sensors {

class MagnetGrid {
 public:
  /// Sorts `magnets` [m] into cells of a quarter of `cutoff` [m], larger ones where that would make more than
  /// `most_cells`. Allocates nothing when it has seen as many before.
  /// @param cutoff 0: none, one span holds them all.
  void build(std::span<const glm::dvec2> magnets, double cutoff, std::size_t most_cells);

  /// The magnet at each place of the order.
  std::span<const std::uint32_t> order() const { return order_; }

  /// Spans of the order that together hold each magnet within `reach` [m] of `centre`, and few others.
  /// @param out has room for `most_spans(reach)`. @return how many were written.
  std::uint32_t find(glm::dvec2 centre, double reach, std::span<MagnetSpan> out) const;
  std::uint32_t most_spans(double reach) const;

 private:
  void measure(std::span<const glm::dvec2> magnets, double cutoff, std::size_t most_cells);
  double column_of(double x) const;
  double row_of(double y) const;

  bool whole_ = true;   ///< no cells
  glm::dvec2 low_;      ///< [m] corner of the first cell
  double width_ = 1.0;  ///< [m] of a cell
  double depth_ = 1.0;  ///< [m] of a cell
  std::uint32_t across_ = 1;
  std::uint32_t rows_ = 1;
  std::vector<std::uint32_t> cells_;   ///< scratch: of each magnet
  std::vector<std::uint32_t> starts_;  ///< per cell and one more: its first place in the order
  std::vector<std::uint32_t> order_;
};

}  // namespace sf::sensors
