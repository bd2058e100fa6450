#include "raycast/bearing_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sf::raycast {

namespace {

/// With fewer segments, an index does not speed up the search.
constexpr std::size_t kFewest = 256;
constexpr std::uint32_t kFewestSectors = 32, kMostSectors = 4096;
constexpr double kMostPerBeam = 64.0;  ///< [segments] at one bearing, on average
constexpr double kPoint = 1e-9;        ///< [m] radius of a disc that is treated as a point
constexpr std::uint32_t kWideArc = 4;  ///< [sectors] wider arcs are narrowed by the bands of their sectors

/// Returns a number of sectors with few segments each; 0 if segments are so wide that each beam would read many of
/// them.
std::uint32_t sectors_for(std::span<const CandidateWall> walls) {
  double sum = 0.0;  // [turns]
  for (const CandidateWall& wall : walls) sum += std::min(wall.half, M_PI) / M_PI;
  if (sum > kMostPerBeam) return 0;
  return std::bit_floor(std::clamp(static_cast<std::uint32_t>(walls.size()) / 4, kFewestSectors, kMostSectors));
}

}  // namespace

void BearingIndex::build(std::span<const CandidateWall> found, double radius,
                         const std::function<ExactSegment(std::uint32_t)>& exact, Scratch& scratch) {
  first_.clear(), bands_.clear(), segments_.clear();
  all_ = {};
  sectors_ = 0;
  if (found.size() < kFewest) return;
  auto& [walls, lists] = scratch;
  walls.clear();
  base::Box box = base::empty_box();
  for (const CandidateWall& wall : found) box = base::united(box, base::box_of(wall.a, wall.b));
  centre_ = 0.5 * (box.min + box.max);
  for (const CandidateWall& wall : found)
    walls.push_back(candidate_wall(wall.a - centre_, wall.b - centre_, wall.row, kPoint));
  sectors_ = sectors_for(walls);
  if (empty()) return;
  lists.clear(sectors_);
  for (std::uint32_t i = 0; i < walls.size(); ++i) lists.add(walls[i].bearing, walls[i].half, i);
  lists.sort();
  for (std::uint32_t s = 0; s < sectors_; ++s) {
    first_.push_back(static_cast<std::uint32_t>(segments_.size()));
    Band& band = bands_.emplace_back();
    for (const std::uint32_t i : lists.of(s)) {
      const CandidateWall& wall = walls[i];
      segments_.push_back({exact(wall.row), wall.row});
      band.nearest = std::min(band.nearest, wall.nearest * (1.0 - 1e-9));
      band.farthest = std::max(band.farthest, std::max(length(wall.a), length(wall.b)) * (1.0 + 1e-9));
    }
    all_ = {std::min(all_.nearest, band.nearest), std::max(all_.farthest, band.farthest)};
  }
  first_.push_back(static_cast<std::uint32_t>(segments_.size()));
  if (all_.nearest <= length(centre_) + radius) sectors_ = 0;
}

/// Returns the sectors that a beam crosses while its distance from the centre is in `band`.
BearingIndex::Arc BearingIndex::arc_within(glm::dvec2 from, glm::dvec2 d, const Band& band) const {
  const double along = dot(from, d), across = base::cross(from, d), aside = across * across;
  const auto place_at = [&](double distance) {
    const double t = std::sqrt(std::max(distance * distance - aside, 0.0)) - along;
    return fast_bearing(from + t * d) * sectors_ / (2.0 * M_PI);
  };
  double low = place_at(band.nearest), high = place_at(band.farthest);
  if (across < 0.0) std::swap(low, high);
  const double slack = 1e-5 * sectors_;
  if (high < low - slack) high += sectors_;
  const auto first = static_cast<std::int64_t>(std::floor(low - slack)),
             last = static_cast<std::int64_t>(std::floor(high + slack));
  return {static_cast<std::uint32_t>(first) & (sectors_ - 1),
          static_cast<std::uint32_t>(std::min<std::int64_t>(last - first + 1, sectors_))};
}

BearingIndex::Arc BearingIndex::arc_of(glm::dvec2 from, glm::dvec2 d) const {
  from -= centre_;
  Arc arc = arc_within(from, d, all_);
  for (std::uint32_t before = sectors_; arc.sectors > kWideArc && arc.sectors <= before / 2;) {
    before = arc.sectors;
    Band band;
    for (std::uint32_t k = 0; k < arc.sectors; ++k) {
      const Band& own = bands_[(arc.first + k) & (sectors_ - 1)];
      band = {std::min(band.nearest, own.nearest), std::max(band.farthest, own.farthest)};
    }
    if (band.nearest > band.farthest) break;
    arc = arc_within(from, d, band);
  }
  return arc;
}

std::size_t BearingIndex::intersect(glm::dvec2 from, glm::dvec2 origin, glm::dvec2 d, RowRange skipped,
                                    ClosestHit& best) const {
  const Arc arc = arc_of(from, d);
  std::size_t met = 0;
  for (std::uint32_t k = 0; k < arc.sectors; ++k) {
    const std::uint32_t sector = (arc.first + k) & (sectors_ - 1);
    for (std::uint32_t i = first_[sector]; i < first_[sector + 1]; ++i, ++met)
      if (segments_[i].id < skipped.first || segments_[i].id >= skipped.end)
        raycast::intersect(segments_[i], origin, d, best);
  }
  return met;
}

}  // namespace sf::raycast
