#include "raycast/scan_tables.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::raycast {

namespace {

/// Fills a place with a segment that faces away from every viewer.
void clear(SegmentBlock& block, std::uint32_t k) {
  block.ax[k] = 0.0f, block.ay[k] = -1e15f, block.ex[k] = 1.0f, block.ey[k] = 0.0f;
  block.row[k] = SF_NO_HIT;
}

}  // namespace

void hide_rows(std::span<SegmentBlock> blocks, std::uint32_t first, std::uint32_t end) {
  for (SegmentBlock& block : blocks)
    for (std::uint32_t k = 0; k < kBlock; ++k)
      if (block.row[k] >= first && block.row[k] < end) clear(block, k);
}

void append(std::vector<SegmentBlock>& blocks, std::uint32_t& used, glm::dvec2 a, glm::dvec2 b, std::uint32_t row) {
  if (blocks.empty() || used == kBlock) {
    SegmentBlock& fresh = blocks.emplace_back();
    for (std::uint32_t k = 0; k < kBlock; ++k) clear(fresh, k);
    used = 0;
  }
  SegmentBlock& block = blocks.back();
  block.ax[used] = static_cast<float>(a.x), block.ay[used] = static_cast<float>(a.y);
  block.ex[used] = static_cast<float>(b.x - a.x), block.ey[used] = static_cast<float>(b.y - a.y);
  block.row[used++] = row;
}

void ScanPattern::assign(std::span<const double> bearings, std::span<const double> directions64, double first,
                         double last, std::size_t step) {
  beams = static_cast<std::uint32_t>(bearings.size());
  const bool spread = beams > 1 && last > first;
  const double per = spread ? (beams - 1) / (last - first) : 1.0;
  per_radian = static_cast<float>(per);
  middle = static_cast<float>(-first * per);
  const std::size_t padded = std::size_t{beams} + 2 * kBlock;
  place.resize(padded);
  cos32.resize(padded), sin32.resize(padded), cos64.resize(padded), sin64.resize(padded);
  double most = 0.0, farthest = 0.0;
  for (std::size_t i = 0; i < padded; ++i) {
    const std::size_t k = std::min<std::size_t>(i, beams - 1);
    const double at = (bearings[k] - first) * per;
    place[i] = static_cast<float>(at);
    cos64[i] = directions64[2 * step * k], sin64[i] = directions64[2 * step * k + 1];
    cos32[i] = static_cast<float>(cos64[i]), sin32[i] = static_cast<float>(sin64[i]);
    most = std::max(most, std::abs(at - static_cast<double>(k)));
    farthest = std::max(farthest, std::abs(bearings[k]));
  }
  slack = static_cast<float>(most < 1e-6 ? 0.0 : 1.001 * most);
  narrow = farthest <= 0.5 * M_PI;
  half_view = static_cast<float>(farthest + 1e-6);
  // Widened to cover rounding errors.
  const double edge = std::min(farthest + 1e-6, 0.5 * M_PI);
  edge_cos = static_cast<float>(base::cos(edge)), edge_sin = static_cast<float>(base::sin(edge));
}

glm::dvec2 direction_of(const ScanView& view, const ScanPattern& pattern, std::size_t i) {
  if (view.x != nullptr) return {view.x[i], view.y[i]};
  const double c = pattern.cos64[i], s = pattern.sin64[i];
  return {view.heading.x * c - view.heading.y * s, view.heading.y * c + view.heading.x * s};
}

}  // namespace sf::raycast
