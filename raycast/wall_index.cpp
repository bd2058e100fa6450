#include "raycast/wall_index.h"

#include <algorithm>
#include <cmath>

namespace sf::raycast {

namespace {

constexpr int kMaxCells = 512;  ///< along an axis
constexpr int kMaxBands = 1024;

/// Counting sort of (bucket, item) pairs. `each_pair` calls its argument with each pair.
template <class EachPair>
void fill_buckets(std::size_t buckets, std::vector<std::uint32_t>& first, std::vector<std::uint32_t>& items,
                  EachPair each_pair) {
  first.assign(buckets + 1, 0);
  each_pair([&](std::size_t bucket, std::uint32_t) { ++first[bucket + 1]; });
  for (std::size_t i = 0; i < buckets; ++i) first[i + 1] += first[i];
  items.resize(first[buckets]);
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  each_pair([&](std::size_t bucket, std::uint32_t item) { items[next[bucket]++] = item; });
}

int clamp_index(double value, int count) {
  return static_cast<int>(std::clamp(std::floor(value), 0.0, static_cast<double>(count - 1)));
}

double least_x(const IndexedWall& s) { return std::min(s.a.x, s.b.x); }
double largest_x(const IndexedWall& s) { return std::max(s.a.x, s.b.x); }

}  // namespace

WallIndex::WallIndex(const world::World& world, double z, double typical_range) {
  for (std::uint32_t row = 0; row < world.walls.size(); ++row) {
    const world::Segment& s = world.walls[row];
    if (s.seen_by_laser && s.z_min <= z && z < s.z_max) segments_.push_back({s.a, s.b, row, s.solid_left});
  }
  if (segments_.empty()) return;
  low_ = high_ = segments_[0].a;
  for (const IndexedWall& s : segments_) {
    low_ = {std::min({low_.x, s.a.x, s.b.x}), std::min({low_.y, s.a.y, s.b.y})};
    high_ = {std::max({high_.x, s.a.x, s.b.x}), std::max({high_.y, s.a.y, s.b.y})};
  }
  index_cells(typical_range);
  index_bands();
}

WallIndex::Span WallIndex::cells_of(double x0, double y0, double x1, double y1) const {
  return {clamp_index((x0 - low_.x) / cell_, columns_), clamp_index((y0 - low_.y) / cell_, rows_),
          clamp_index((x1 - low_.x) / cell_, columns_), clamp_index((y1 - low_.y) / cell_, rows_)};
}

void WallIndex::index_cells(double typical_range) {
  const double width = high_.x - low_.x;
  const double height = high_.y - low_.y;
  cell_ = std::max({typical_range / 4.0, width / kMaxCells, height / kMaxCells, 1e-6});
  columns_ = static_cast<int>(width / cell_) + 1;
  rows_ = static_cast<int>(height / cell_) + 1;
  fill_buckets(static_cast<std::size_t>(columns_) * rows_, cell_first_, cell_items_, [&](auto put) {
    for (std::uint32_t i = 0; i < segments_.size(); ++i) {
      const IndexedWall& s = segments_[i];
      const Span span =
          cells_of(std::min(s.a.x, s.b.x), std::min(s.a.y, s.b.y), std::max(s.a.x, s.b.x), std::max(s.a.y, s.b.y));
      for (int y = span.y0; y <= span.y1; ++y)
        for (int x = span.x0; x <= span.x1; ++x) put(static_cast<std::size_t>(y) * columns_ + x, i);
    }
  });
}

void WallIndex::index_bands() {
  bands_ = std::clamp(static_cast<int>(segments_.size() / 8), 1, kMaxBands);
  band_ = std::max((high_.y - low_.y) / bands_, 1e-9);
  fill_buckets(static_cast<std::size_t>(bands_), band_first_, from_left_, [&](auto put) {
    for (std::uint32_t i = 0; i < segments_.size(); ++i) {
      const IndexedWall& s = segments_[i];
      if (!s.solid_left) continue;
      const int first = clamp_index((std::min(s.a.y, s.b.y) - low_.y) / band_ - 1e-6, bands_);
      const int last = clamp_index((std::max(s.a.y, s.b.y) - low_.y) / band_ + 1e-6, bands_);
      for (int band = first; band <= last; ++band) put(static_cast<std::size_t>(band), i);
    }
  });
  from_right_ = from_left_;
  for (std::size_t band = 0; band + 1 < band_first_.size(); ++band) {
    const auto first = static_cast<std::ptrdiff_t>(band_first_[band]);
    const auto end = static_cast<std::ptrdiff_t>(band_first_[band + 1]);
    std::sort(from_left_.begin() + first, from_left_.begin() + end,
              [&](std::uint32_t i, std::uint32_t j) { return least_x(segments_[i]) < least_x(segments_[j]); });
    std::sort(from_right_.begin() + first, from_right_.begin() + end,
              [&](std::uint32_t i, std::uint32_t j) { return largest_x(segments_[i]) > largest_x(segments_[j]); });
  }
}

void WallIndex::near(glm::dvec2 p, double radius, Query& query) const {
  query.found.clear();
  if (segments_.empty()) return;
  if (query.stamps.size() < segments_.size()) {
    query.stamps.resize(segments_.size(), 0);
    query.found.reserve(segments_.size());
  }
  if (++query.stamp == 0) {
    std::fill(query.stamps.begin(), query.stamps.end(), 0);
    query.stamp = 1;
  }
  const Span span = cells_of(p.x - radius, p.y - radius, p.x + radius, p.y + radius);
  for (int y = span.y0; y <= span.y1; ++y)
    for (int x = span.x0; x <= span.x1; ++x) {
      const std::size_t cell = static_cast<std::size_t>(y) * columns_ + x;
      for (std::uint32_t at = cell_first_[cell]; at < cell_first_[cell + 1]; ++at) {
        const std::uint32_t i = cell_items_[at];
        if (query.stamps[i] == query.stamp) continue;
        query.stamps[i] = query.stamp;
        query.found.push_back(i);
      }
    }
}

bool WallIndex::inside_solid(glm::dvec2 p) const {
  if (segments_.empty() || p.x < low_.x || p.x > high_.x || p.y < low_.y || p.y > high_.y) return false;
  const std::size_t band = static_cast<std::size_t>(clamp_index((p.y - low_.y) / band_, bands_));
  // A horizontal line crosses closed outlines upward as often as downward. The crossings on one side of p suffice: the
  // side with less of the world.
  const bool left = p.x - low_.x < high_.x - p.x;
  const std::vector<std::uint32_t>& items = left ? from_left_ : from_right_;
  int winding = 0;
  for (std::uint32_t at = band_first_[band]; at < band_first_[band + 1]; ++at) {
    const IndexedWall& s = segments_[items[at]];
    if (left ? least_x(s) > p.x : largest_x(s) < p.x) break;
    const bool below_a = s.a.y <= p.y;
    if (below_a == (s.b.y <= p.y)) continue;
    const double side = (left ? -1.0 : 1.0) * base::cross(s.b - s.a, p - s.a);
    if (below_a && side > 0.0) ++winding;
    if (!below_a && side < 0.0) --winding;
  }
  return winding != 0;
}

}  // namespace sf::raycast
