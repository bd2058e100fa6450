#pragma once
// Surfaces of movers: outlines at this tick's poses, and a grid of mover positions.

#include <map>
#include <span>
#include <vector>

#include "base/report.h"
#include "base/thread_pool.h"
#include "raycast/scan_tables.h"
#include "world/world.h"

namespace sf::raycast {

using base::Pose;

inline constexpr int kMaxGridCells = 256;  ///< along each axis, of a world without copies
inline constexpr int kMinGridCells = 4;

/// Outlines of all movers, without edges that are invisible to lasers.
class MoverGeometry {
 public:
  explicit MoverGeometry(const world::World& world);

  /// Takes the present outlines of the world's movers, in time in proportion to what changed, apart from a comparison.
  /// @return false, with nothing changed, if a mover has another number of edges or too much has changed since the
  /// construction: construct it again
  bool update(const world::World& world);

  /// Moves every outline to its mover's pose. @param states one per mover; must stay valid until the next call
  /// @param exact out: `segments()` edges, ordered by mover
  void place(std::span<const base::Report> states, base::ThreadPool& thread_pool, std::span<ExactSegment> exact);

  std::size_t segments() const { return local_.size(); }
  /// `Segment::model` of each edge.
  const std::vector<std::uint32_t>& models() const { return models_; }
  double largest_radius() const { return grid_.largest_radius; }  ///< [m]
  double smallest_inner() const;                                  ///< [m] smallest `MoverGrid::inner`

  const MoverGrid& grid() const { return grid_; }
  const OutlineTable& outlines() const { return outlines_; }
  std::span<const base::Report> states() const { return states_; }
  std::span<const glm::dvec2> headings() const { return headings_; }
  std::span<const ExactSegment> exact() const { return exact_; }  ///< the edges at this tick's poses
  /// Returns the row of each mover's first edge in the table of exact segments, which starts with the walls; then the
  /// end.
  std::span<const std::uint32_t> first_rows() const { return first_rows_; }

 private:
  std::size_t end_of(std::size_t mover) const {
    return mover + 1 < first_rows_.size() ? first_rows_[mover + 1] - walls_ : local_.size();
  }
  void update_mover(std::uint32_t mover, const world::Mover& now);
  void add_slices(std::size_t mover);
  OutlineTable::Outline outline_at(std::size_t mover, double z);
  void add_loops(std::size_t mover, std::span<const std::uint32_t> edges);
  bool is_present(std::size_t mover) const { return radii_[mover] > 0.0 && !base::is_absent(states_[mover].X_WM); }
  std::size_t most_cells() const;
  void build_grid();
  void find_cells();
  void sort_into_cells();
  bool drop_twins();
  bool drop_twins(std::span<std::uint32_t> movers);

  std::vector<world::Segment> local_;  ///< mover frame
  std::vector<std::uint32_t> models_;
  std::vector<std::uint32_t> first_rows_;
  std::vector<double> radii_;          ///< [m] 0 if there is no outline
  std::vector<double> inner_;          ///< [m] distance of the nearest edge from the origin
  std::vector<std::uint32_t> shapes_;  ///< equal for movers with equal outlines
  std::vector<std::uint32_t> twins_;   ///< per mover, same as MoverGrid::twin
  std::uint32_t walls_;
  std::uint32_t next_shape_ = 0;        ///< > all of `shapes_`
  std::size_t most_slices_ = 0;         ///< of `outlines_`, whose unused ones `update` leaves behind
  std::vector<std::uint32_t> scratch_;  ///< movers that changed
  OutlineTable outlines_;
  std::span<const base::Report> states_;
  std::span<const ExactSegment> exact_;
  std::vector<glm::dvec2> headings_;
  std::vector<std::uint32_t> cells_, next_;
  MoverGrid grid_;
};

}  // namespace sf::raycast
