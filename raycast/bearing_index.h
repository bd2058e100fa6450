#pragma once
// Segments round a cell by their bearing from their own centre, for beams that each meet few of very many.
//
// Needs: a closed curve round the cell among the segments, so that a beam from inside has met something when it is
// farther from the centre than all segments. Result: for a beam, the sectors of the bearings that it passes between the
// nearest and the farthest segment, and the segments in them.

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

/// Keeps its memory between uses.
class BearingIndex {
 public:
  struct Scratch {
    std::vector<CandidateWall> walls;
    SectorLists lists;
  };
  /// Replaces the index by one of `walls`, or by none where they are few, wide or not all outside of the viewers.
  /// @param radius [m] of the disc round the origin that holds the viewers  @param exact segments by row
  void build(std::span<const CandidateWall> walls, double radius,
             const std::function<ExactSegment(std::uint32_t row)>& exact, Scratch& scratch);
  bool empty() const { return sectors_ == 0; }
  /// Intersects a beam with the segments that it may meet, in 64 bits. Needs an index that is not empty.
  /// @param from [m] the viewer relative to the cell's centre  @param origin [m] in the world  @param d unit vector
  /// @param skipped rows that the beam does not see  @return number of segments
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

  glm::dvec2 centre_;                 ///< [m] of the segments, from the cell's: bearings and distances are from here
  std::uint32_t sectors_ = 0;         ///< a power of two
  std::vector<std::uint32_t> first_;  ///< segment of each sector, and the end
  std::vector<Band> bands_;           ///< of the segments of each sector
  Band all_;                          ///< of all segments
  std::vector<CandidateSegment> segments_;
};

}  // namespace sf::raycast
