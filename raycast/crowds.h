#pragma once
// Crowds: places where viewers are inside many movers at once.
//
// Input: movers at this tick's poses. Output: for each small cell with viewers in a crowd, the edges that they may see.
//
// A viewer inside a convex outline sees nothing beyond the line through any of its edges. Each mover's edges are
// therefore clipped at the lines of two other movers; the second one is needed if the first carries the sensor. The
// cost of a cell grows with the number of its movers, not with its viewers and beams. A scan from the cell reads the
// few remaining edges; if many remain, each beam reads those at its bearing. Movers that contain no viewer, and
// outlines that are not convex, are scanned as outside of crowds.
//
// A line hides only points that are beyond it by more than the rounding of 64-bit ranges, so readings do not change.

#include <compare>
#include <span>
#include <vector>

#include "base/box.h"
#include "base/thread_pool.h"
#include "raycast/bearing_index.h"
#include "raycast/candidate_walls.h"
#include "raycast/mover_geometry.h"
#include "raycast/viewpoint.h"

namespace sf::raycast {

/// Edges that viewers in one cell of a crowd may see, of the movers that contain the cell.
struct CrowdCell {
  glm::dvec2 centre;                   ///< [m] world
  double horizon = 0.0;                ///< [m] every beam meets a member's edge within this distance
  std::vector<SegmentBlock> blocks;    ///< relative to the centre; rows refer to exact segments
  std::vector<BlockBounds> bounds;     ///< of `blocks`, padded by kBlock
  BearingIndex by_bearing;             ///< index of the same segments
  std::vector<std::uint64_t> members;  ///< one bit per mover that contains the cell; empty: too few for a crowd
};

/// Not thread-safe. `movers` must outlive this object.
class Crowds {
 public:
  explicit Crowds(const MoverGeometry& movers);
  ~Crowds();

  /// Call when the outlines of the movers have changed.
  void update_outlines() { size_ = 0.0; }
  /// Finds the crowds around `views`.
  void find(std::span<const Viewpoint> views, base::ThreadPool& thread_pool);
  /// Returns the crowd of a view of the last `find`, or null.
  const CrowdCell* of(std::size_t view) const {
    if (places_.empty() || place_of_[view] == kNoPlace || cells_[place_of_[view]].members.empty()) return nullptr;
    return &cells_[place_of_[view]];
  }

 private:
  static constexpr std::uint32_t kNoPlace = 0xFFFFFFFFu;
  static constexpr std::int32_t kLarge = 8;  ///< [size_] side of a large cell: about the size of a robot
  /// A cell's key.
  struct Place {
    double z;            ///< [m] height of the viewers
    std::int32_t scale;  ///< [size_] side: kLarge or 1; 0: no place
    std::int64_t x, y;
    std::uint32_t copy;  ///< of the world
    auto operator<=>(const Place&) const = default;
  };
  static constexpr Place kNowhere{0.0, 0, 0, 0, 0};
  /// A disc that contains the viewers of a cell.
  struct Disc {
    glm::dvec2 centre;
    double radius = 0.0;     ///< [m]
    double z = 0.0;          ///< [m] height of the viewers
    std::uint32_t copy = 0;  ///< of the world
  };
  struct Lines;
  struct Scratch;

  bool is_crowded(const Viewpoint& view) const;
  Place place_of(const Viewpoint& view, std::int32_t scale) const;
  Disc viewers_of(std::size_t place) const;
  void collect_places(std::span<const Viewpoint> views);
  bool serves(const Disc& viewers, Scratch& scratch) const;
  void find_places(std::span<const Viewpoint> views, base::ThreadPool& thread_pool);
  void build(const Disc& viewers, Scratch& scratch, CrowdCell& cell) const;
  void find_members(const Disc& viewers, std::vector<std::uint32_t>& members) const;
  const OutlineTable::Outline& outline_of(std::uint32_t mover, const Disc& viewers) const;
  struct Edge {
    glm::dvec2 a, b;
  };
  Edge edge_of(std::uint32_t mover, std::uint32_t number, glm::dvec2 centre) const;
  bool holds(std::uint32_t mover, const OutlineTable::Loop& loop, const Disc& viewers) const;
  void add_loop(std::uint32_t mover, const OutlineTable::Loop& loop, const Disc& viewers, Lines& lines) const;
  void add_edges(std::uint32_t mover, const Lines& lines, const Disc& viewers, std::vector<CandidateWall>& found) const;

  const MoverGeometry& movers_;
  double size_ = 0.0;  ///< [m] side of a small cell; viewers are at least an eighth of it away from members' edges
  std::vector<Place> places_;            ///< of this tick, ascending
  std::vector<std::uint32_t> place_of_;  ///< per view: row of `places_`
  std::vector<Place> place_of_view_;     ///< scratch
  std::vector<std::uint8_t> serves_;     ///< scratch, per place
  std::vector<base::Box> boxes_;         ///< per place: bounds its viewers
  std::vector<CrowdCell> cells_;         ///< per place; kept to reuse their memory
  std::vector<Scratch> scratch_;         ///< per thread
};

}  // namespace sf::raycast
