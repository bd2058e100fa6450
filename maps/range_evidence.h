#pragma once
// Adds readings of unlike range sensors to a map of log odds: beams of lasers, cones of sonars and infrareds.
//
// A cone with an echo says that at least one cell of its arc is occupied, and that those before it are free. A cell
// belongs to the arc by its weight w: the share of the stated noise's distribution within the cell's depth, times
// 1 - (angle from the axis / half aperture)^2. The cell with the echo's point on the axis is weighed as if its middle
// were that point. The rest is Bayes' rule for causes of which one suffices (a noisy OR; K.
// Konolige, Improved occupancy grids for map building, 1997, argues for it): an echo without a cause in the arc has the
// probability exp(-hit), and cell i gains
//
//   ln (1 - (1 - w_i) N_i) / (1 - N_i),   N_i = (1 - exp(-hit)) product over j != i of (1 - w_j p_j)
//
// where p_j is the probability of cell j so far. So one cell that is known to be occupied explains the echo, and a
// narrow arc in free space marks more than a wide one in the unknown; a single cell of weight 1 gains `hit`. A cell
// before the arc loses `miss`, times its weight by angle, by the noise, and by the share of surfaces that the sensor
// sees. Without an echo the whole cone is before the arc.

#include <span>
#include <vector>

#include "maps/grid_update.h"

namespace sf::maps {

/// A beam or a cone of a range reading.
struct RangeCone {
  base::Pose X_WC;     ///< its apex; x is the axis
  double half = 0.0;   ///< [rad] half of its aperture, in [0, pi]; 0: a beam, as wide as a cell
  double range = 0.0;  ///< [m] of the echo; without one, up to which a surface would have been seen
  bool has_echo = true;
  double sigma = 0.0;  ///< [m] >= 0 standard deviation of the range
  double seen = 1.0;   ///< share of surfaces that return an echo, in (0, 1]
};

/// Not thread-safe. Keeps scratch memory of two bytes per cell of the largest map.
class RangeEvidence {
 public:
  /// Finds the cells of cones that are measured together: a cell counts once for all, as occupied if it lies in an arc.
  /// Cells outside the map are skipped. Precondition: ranges are at most kMaxRangeCells cells.
  void trace(const GridGeometry& geometry, std::span<const RangeCone> cones);
  /// Adds what was traced to a map of that geometry. The result depends on the order of readings, since the odds so far
  /// decide which cell of an arc explains its echo.
  void add_to(LogOddsGrid& grid);

 private:
  struct Part {
    std::uint32_t cell;  ///< index in LogOddsGrid::cells
    float weight;        ///< of an arc's cell; of a free cell
  };
  struct Arc {
    std::uint32_t first = 0, end = 0;  ///< rows of `arc_parts_`
  };
  struct Cone;
  void trace(const GridGeometry& geometry, const RangeCone& cone);
  void add_cell(std::uint32_t cell, const Cone& cone, double along, double across);
  void weigh_arc(const LogOddsGrid& grid, const Arc& arc);
  void note(std::uint32_t cell, std::int32_t change);

  std::vector<Arc> arcs_;
  std::vector<Part> arc_parts_, free_parts_;
  std::vector<std::int16_t> changes_;  ///< per cell: 0 between calls
  std::vector<std::uint32_t> changed_;
};

}  // namespace sf::maps
