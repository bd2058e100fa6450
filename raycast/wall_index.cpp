#include "raycast/wall_index.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace sf::raycast {

namespace {

constexpr std::size_t kMaxBands = 1024;
constexpr double kBandsPerWall = 16.0;  ///< limit of the mean: long walls are in many bands
constexpr std::size_t kLeafWalls = 8;
constexpr std::size_t kAhead = 8;  ///< number of walls to prefetch ahead

double least_x(const IndexedWall& s) { return std::min(s.a.x, s.b.x); }
double largest_x(const IndexedWall& s) { return std::max(s.a.x, s.b.x); }

}  // namespace

WallIndex::WallIndex(std::span<const world::Segment> walls) {
  std::vector<IndexedWall> visible;
  std::vector<base::Box> boxes;
  for (std::uint32_t row = 0; row < walls.size(); ++row) {
    const world::Segment& s = walls[row];
    if (!s.seen_by_laser) continue;
    visible.push_back({s.a, s.b, row, s.solid_left, s.z_min, s.z_max});
    boxes.push_back(base::box_of(s.a, s.b));
  }
  tree_ = base::BoxTree(boxes, kLeafWalls);
  for (const std::uint32_t i : tree_.order()) segments_.push_back(visible[i]);
  if (!segments_.empty()) index_bands();
}

void WallIndex::index_bands() {
  const base::Box all = tree_.extent();
  const double height = std::max(all.max.y - all.min.y, 1e-9);
  double heights = 0.0;
  for (const IndexedWall& s : segments_) heights += std::abs(s.b.y - s.a.y) / height;
  const double most = kBandsPerWall * static_cast<double>(segments_.size()) / std::max(heights, 1e-9);
  bands_.resize(std::clamp<std::size_t>(segments_.size() / 8, 1,
                                        static_cast<std::size_t>(std::clamp(most, 1.0, double{kMaxBands}))));
  band_height_ = std::max(height / static_cast<double>(bands_.size()), 1e-9);
  for (std::uint32_t i = 0; i < segments_.size(); ++i) {
    const IndexedWall& s = segments_[i];
    const std::size_t last = band_of(std::max(s.a.y, s.b.y) + 1e-6 * band_height_);
    for (std::size_t k = band_of(std::min(s.a.y, s.b.y) - 1e-6 * band_height_); s.solid_left && k <= last; ++k)
      bands_[k].from_left.push_back(i);
  }
  for (Band& band : bands_) {
    band.from_right = band.from_left;
    std::ranges::sort(band.from_left, std::less{}, [&](std::uint32_t i) { return least_x(segments_[i]); });
    std::ranges::sort(band.from_right, std::greater{}, [&](std::uint32_t i) { return largest_x(segments_[i]); });
  }
}

std::size_t WallIndex::band_of(double y) const {
  const double last = static_cast<double>(bands_.size() - 1);
  return static_cast<std::size_t>(std::clamp(std::floor((y - tree_.extent().min.y) / band_height_), 0.0, last));
}

void WallIndex::near(glm::dvec2 p, double z, double radius, std::vector<std::uint32_t>& found) const {
  found.clear();
  found.reserve(segments_.size());
  tree_.any_place(base::box_around(p, radius), [&](std::uint32_t i) {
    if (segments_[i].is_at(z)) found.push_back(i);
    return false;
  });
}

bool WallIndex::inside_solid(glm::dvec2 p, double z) const {
  const base::Box all = tree_.extent();
  if (!meet(all, {p, p})) return false;
  // A horizontal line crosses closed outlines upward as often as downward, so the crossings on one side of p suffice.
  // Use the side with less of the world.
  const bool left = p.x - all.min.x < all.max.x - p.x;
  const Band& band = bands_[band_of(p.y)];
  int winding = 0;
  const std::vector<std::uint32_t>& walls = left ? band.from_left : band.from_right;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    if (k + kAhead < walls.size()) __builtin_prefetch(&segments_[walls[k + kAhead]]);
    const IndexedWall& s = segments_[walls[k]];
    if (left ? least_x(s) > p.x : largest_x(s) < p.x) break;
    if (!s.is_at(z)) continue;
    const bool below_a = s.a.y <= p.y;
    if (below_a == (s.b.y <= p.y)) continue;
    const double side = (left ? -1.0 : 1.0) * base::cross(s.b - s.a, p - s.a);
    if (below_a && side > 0.0) ++winding;
    if (!below_a && side < 0.0) --winding;
  }
  return winding != 0;
}

}  // namespace sf::raycast
