#include "raycast/wall_blocks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace sf::raycast {

void append_blocks(std::vector<CandidateWall>& found, std::vector<SegmentBlock>& blocks,
                   std::vector<BlockBounds>& bounds) {
  std::sort(found.begin(), found.end(), [](const CandidateWall& p, const CandidateWall& q) {
    return std::tie(p.distance_ring, p.bearing, p.row, p.a.x, p.a.y) <
           std::tie(q.distance_ring, q.bearing, q.row, q.a.x, q.a.y);
  });
  std::uint32_t used = kBlock;
  for (std::size_t i = 0; i < found.size(); ++i) {
    append(blocks, used, found[i].a, found[i].b, found[i].row);
    if (used < kBlock && i + 1 < found.size()) continue;
    const std::span<const CandidateWall> own = std::span(found).subspan(i + 1 - used, used);
    double low = 0.0, high = 0.0, nearest = own[0].nearest;
    for (const CandidateWall& f : own) {
      const double offset = base::wrap_angle(f.bearing - own[0].bearing);
      low = std::min(low, offset - f.half), high = std::max(high, offset + f.half);
      nearest = std::min(nearest, f.nearest);
    }
    bounds.push_back({std::nextafter(static_cast<float>(nearest), 0.0f),
                      static_cast<float>(own[0].bearing + 0.5 * (low + high)), static_cast<float>(0.5 * (high - low))});
  }
}

}  // namespace sf::raycast
