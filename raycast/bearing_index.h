#pragma once
// Index of the segments around a cell by their bearing from their common centre. It pays off for many segments if each
// beam can meet only a few of them.
//
// Input: segments that include a closed curve around the cell, so a beam from inside hits a segment before it is
// farther from the centre than all of them. Output for a beam: the segments in the sectors that it crosses between the
// nearest and the farthest segment.

#include <functional>
#include <span>
#include <vector>

#include "base/box.h"
#include "raycast/candidate_walls.h"
#include "raycast/intersect.h"
#include "raycast/sector_lists.h"

namespace sf::raycast {

/// Rows [first, end).
struct RowRange {
  std::uint32_t first = 0, end = 0;
};

/// Reuses its memory.
class BearingIndex {
 public:
  struct Scratch {
    std::vector<CandidateWall> walls;
    SectorLists lists;
  };
  /// Rebuilds the index from `walls`. It stays empty if they are few or wide, or if a viewer may be as far from their
  /// centre as a segment.
  /// @param radius [m] of the disc around the origin that contains the viewers  @param exact returns a segment by its
  /// row
  void build(std::span<const CandidateWall> walls, double radius,
             const std::function<ExactSegment(std::uint32_t row)>& exact, Scratch& scratch);
  bool empty() const { return sectors_ == 0; }
  /// Intersects a beam, in 64 bits, with the segments that it may meet.
  /// @param from [m] the viewer relative to the cell's centre  @param origin [m] in the world  @param d unit vector
  /// @param skipped rows that are invisible to the beam  @return number of segments tested  @pre the index is not empty
  std::size_t intersect(glm::dvec2 from, glm::dvec2 origin, glm::dvec2 d, RowRange skipped, ClosestHit& best) const;

 private:
  struct Band {
    double nearest = HUGE_VAL, farthest = 0.0;  ///< [m] from the centre
  };
  struct Arc {
    std::uint32_t first, sectors;
  };
  Arc arc_of(glm::dvec2 from, glm::dvec2 d) const;
  Arc arc_within(glm::dvec2 from, glm::dvec2 d, const Band& band) const;

  glm::dvec2 centre_;          ///< [m] of the segments, relative to the cell's centre; origin of bearings and distances
  std::uint32_t sectors_ = 0;  ///< a power of two
  std::vector<std::uint32_t> first_;  ///< first segment of each sector, and the end
  std::vector<Band> bands_;           ///< of the segments of each sector
  Band all_;                          ///< of all segments
  std::vector<CandidateSegment> segments_;
};

}  // namespace sf::raycast
