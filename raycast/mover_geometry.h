#pragma once
// Movers as host scans meet them: where their outlines are this tick, and who is where.

#include <map>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "raycast/scan_tables.h"
#include "world/world.h"

namespace sf::raycast {

using base::Pose;

/// All movers' outlines. Exact segments follow those of the walls: row = walls + the mover's first + number.
class MoverGeometry {
 public:
  explicit MoverGeometry(const world::World& world);

  /// Prepares for scans at world height `z` [m]: to be called for each before the first `place`. Gives its number.
  std::uint32_t add_height(double z);

  /// Moves every outline. One pose per mover; a mover whose x is not a number is nowhere. @param exact of movers' rows
  void set_poses(std::span<const Pose> poses, base::ThreadPool& thread_pool, std::span<ExactSegment> exact);

  std::size_t segments() const { return local_.size(); }
  /// Models that beams report, row by row.
  const std::vector<std::uint32_t>& models() const { return models_; }
  double largest_radius() const { return grid_.largest_radius; }  ///< [m]

  const MoverGrid& grid() const { return grid_; }
  std::uint32_t heights() const { return static_cast<std::uint32_t>(heights_.size()); }
  const OutlineTable& outlines(std::uint32_t height) const { return heights_[height].outlines; }
  std::span<const Pose> poses() const { return poses_; }
  std::span<const glm::dvec2> headings() const { return headings_; }
  /// Of each mover's exact segments among all of the scene's, and the end.
  std::span<const std::uint32_t> first_rows() const { return first_rows_; }

 private:
  struct Height {
    double z;
    OutlineTable outlines;
  };
  OutlineTable outlines_at(double z) const;
  void build_grid();

  std::vector<world::Segment> local_;  ///< mover frame
  std::vector<std::uint32_t> models_;
  std::vector<std::uint32_t> first_rows_;
  std::vector<double> radii_;   ///< [m] 0: nothing to meet
  std::vector<double> load_z_;  ///< [m] heights are those at load, the world is 2.5-D
  std::uint32_t walls_;
  std::vector<Height> heights_;
  std::vector<Pose> poses_;
  std::vector<glm::dvec2> headings_;
  std::vector<std::uint32_t> cells_, next_;
  MoverGrid grid_;
};

}  // namespace sf::raycast
