// Localizes robots on the ways, with a grid of samples.

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "control/lane_corridors.h"

namespace sf::control {

namespace {

constexpr double kAlike = 0.7;  // smallest cosine of the angle between a robot and its way

}  // namespace

void LaneCorridors::fill_grid() {
  glm::dvec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const Way& way : ways_)
    for (const glm::dvec2& p : way.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  if (ways_.empty()) low = high = {};
  corner_ = low;
  // Limits the grid to a few million cells, whatever the length of the roads.
  const double area = std::max((high.x - low.x) * (high.y - low.y), 1e-12);
  cell_ = std::max(0.5 * clearance_, std::sqrt(area / 4e6));
  columns_ = static_cast<std::int64_t>((high.x - low.x) / cell_) + 1;
  rows_ = static_cast<std::int64_t>((high.y - low.y) / cell_) + 1;
  const auto cell_of = [&](glm::dvec2 p) {
    return static_cast<std::size_t>(static_cast<std::int64_t>((p.y - low.y) / cell_) * columns_ +
                                    static_cast<std::int64_t>((p.x - low.x) / cell_));
  };
  first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  std::size_t count = 0;
  for (const Way& way : ways_)
    for (const glm::dvec2& p : way.points) ++first_[cell_of(p) + 1], ++count;
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  samples_.resize(count);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t w = 0; w < ways_.size(); ++w) {
    const Way& way = ways_[w];
    for (std::uint32_t i = 0; i < way.points.size(); ++i)
      samples_[next[cell_of(way.points[i])]++] = {way.points[i], (way.backwards ? -1.0 : 1.0) * way.tangents[i], w, i,
                                                  way.z.empty() ? 0.0 : way.z[i]};
  }
}

RoadPositions LaneCorridors::positions(const Pose& X_WM, double reach) const {
  const glm::dvec2 p{X_WM.x, X_WM.y};
  const glm::dvec2 facing = base::direction(X_WM.yaw);
  // The nearest sample of each way, nearest way first.
  struct Nearest {
    std::uint32_t way = 0, index = 0;
    double distance = 0.0;
  };
  std::array<Nearest, 48> found;
  std::size_t count = 0;
  const double within = reach + 0.5 * step_;
  near(p, within, [&](const Sample& sample) {
    const glm::dvec2 d = sample.p - p;
    const double dd = dot(d, d);
    if (dd > within * within) return;
    if (dot(sample.along, facing) < kAlike || apart(sample.z, X_WM.z)) return;
    for (std::size_t i = 0; i < count; ++i) {
      if (found[i].way != sample.way) continue;
      if (dd < found[i].distance) found[i] = {sample.way, sample.index, dd};
      return;
    }
    if (count < found.size()) found[count++] = {sample.way, sample.index, dd};
  });

  RoadPositions positions;
  for (std::size_t i = 0; i < count; ++i) {
    const Way& way = ways_[found[i].way];
    const glm::dvec2 along = way.tangents[found[i].index];
    const glm::dvec2 d = p - way.points[found[i].index];
    const double s = static_cast<double>(found[i].index) * way.step + dot(d, along);
    if (s < -1e-6 || s > way.length + 1e-6) continue;  // beyond its ends
    const RoadPosition place{found[i].way, s, std::abs(base::cross(along, d))};
    if (place.offset > reach) continue;
    // Inserts in order of offset, then of row.
    std::uint32_t at = positions.count;
    while (at > 0 && (positions.all[at - 1].offset > place.offset ||
                      (positions.all[at - 1].offset == place.offset && positions.all[at - 1].way > place.way)))
      --at;
    if (at == positions.all.size()) continue;
    positions.count = std::min(positions.count + 1, static_cast<std::uint32_t>(positions.all.size()));
    for (std::uint32_t k = positions.count - 1; k > at; --k) positions.all[k] = positions.all[k - 1];
    positions.all[at] = place;
  }
  return positions;
}

}  // namespace sf::control
