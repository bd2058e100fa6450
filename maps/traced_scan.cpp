#include "maps/traced_scan.h"

#include <algorithm>
#include <cmath>

#include "base/bearing.h"
#include "base/elementary.h"
#include "base/error.h"

namespace sf::maps {

namespace {

constexpr double kFarthestCell =
    1e9;  // [cells] largest distance of a sensor from the map's corner; a scan from farther away is ignored

void grow(CellBox& box, CellAt at) {
  box.low = {std::min(box.low.column, at.column), std::min(box.low.row, at.row)};
  box.high = {std::max(box.high.column, at.column + 1), std::max(box.high.row, at.row + 1)};
}

}  // namespace

std::vector<glm::dvec2> beam_directions(double fov, std::uint32_t samples) {
  std::vector<glm::dvec2> beams;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double bearing = base::bearing_of(fov, samples, i);
    beams.push_back(base::direction(bearing));
  }
  return beams;
}

CellBox intersect(const CellBox& a, const CellBox& b) {
  return {{std::max(a.low.column, b.low.column), std::max(a.low.row, b.low.row)},
          {std::min(a.high.column, b.high.column), std::min(a.high.row, b.high.row)}};
}

TracedScan trace_scan(const GridGeometry& geometry, const ScanView& scan, std::span<std::uint32_t> ends) {
  SF_CHECK(scan.range_max <= kMaxRangeCells * geometry.cell && scan.range_min >= 0.0,
           std::to_string(scan.range_max) + " m on cells of " + std::to_string(geometry.cell) + " m");
  SF_CHECK(scan.beams.size() == scan.ranges.size() && ends.size() == scan.ranges.size(),
           std::to_string(scan.ranges.size()) + " ranges of " + std::to_string(scan.beams.size()) + " beams");
  TracedScan out;
  const base::Pose& X = scan.X_WS;
  const glm::dvec2 place{(X.x - geometry.left) / geometry.cell, (geometry.top - X.y) / geometry.cell};
  const auto [s, c] = base::sin_cos(X.yaw);
  // The negated comparison also rejects NaN.
  if (!(std::abs(place.x) <= kFarthestCell && std::abs(place.y) <= kFarthestCell && std::abs(c + s) <= 2.0)) return out;
  out.sensor = cell_at(geometry, {X.x, X.y});
  out.within = {place.x - static_cast<double>(out.sensor.column) - 0.5,
                place.y - static_cast<double>(out.sensor.row) - 0.5};

  std::size_t silent = 0;  // number of leading beams without a valid range
  std::uint32_t said = 0;
  CellBox box{{0, 0}, {1, 1}};  // relative to the sensor's cell
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const double range = scan.ranges[k];
    const bool tells = range > scan.range_min || (scan.range_min == 0.0 && range == 0.0);
    if (tells) {
      const bool hit = range < scan.range_max;
      const double r = hit ? range : scan.range_max;
      const glm::dvec2 b = scan.beams[k];
      const CellAt end = cell_at(geometry, {X.x + r * (c * b.x - s * b.y), X.y + r * (s * b.x + c * b.y)});
      const CellAt from{end.column - out.sensor.column, end.row - out.sensor.row};
      grow(box, from);
      said = pack_end(from.column, from.row, hit);
    }
    if (!tells && silent == k) ++silent;
    ends[k] = tells ? said : without_hit(said);
  }
  if (silent == ends.size()) return out;
  std::fill(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(silent), without_hit(ends[silent]));
  out.box = {{box.low.column + out.sensor.column, box.low.row + out.sensor.row},
             {box.high.column + out.sensor.column, box.high.row + out.sensor.row}};
  return out;
}

}  // namespace sf::maps
