#pragma once
// Grid of magnets: square cells in rows, with magnets sorted by cell. The magnets near a point are one span per row of
// cells.

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "sensors/magnetic_field/records.h"

namespace sf::sensors {

class MagnetGrid {
 public:
  /// Sorts `magnets` [m] into cells of a quarter of `cutoff` [m], or larger to stay within `most_cells`. Repeated calls
  /// with the same number of magnets do not allocate.
  /// @param cutoff [m] 0: no cut-off; one span holds all magnets
  void build(std::span<const glm::dvec2> magnets, double cutoff, std::size_t most_cells);

  /// Returns the index of the magnet at each place of the order.
  std::span<const std::uint32_t> order() const { return order_; }

  /// Finds spans of the order that contain each magnet within `reach` [m] of `centre`, and few others.
  /// @param out room for `most_spans(reach)`  @return number of spans written
  std::uint32_t find(glm::dvec2 centre, double reach, std::span<MagnetSpan> out) const;
  std::uint32_t most_spans(double reach) const;

 private:
  void measure(std::span<const glm::dvec2> magnets, double cutoff, std::size_t most_cells);
  double column_of(double x) const;
  double row_of(double y) const;

  bool whole_ = true;   ///< true: there are no cells
  glm::dvec2 low_;      ///< [m] corner of the first cell
  double width_ = 1.0;  ///< [m] of a cell
  double depth_ = 1.0;  ///< [m] of a cell
  std::uint32_t across_ = 1;
  std::uint32_t rows_ = 1;
  std::vector<std::uint32_t> cells_;   ///< scratch: cell of each magnet
  std::vector<std::uint32_t> starts_;  ///< per cell, plus one: its first place in the order
  std::vector<std::uint32_t> order_;
};

}  // namespace sf::sensors
