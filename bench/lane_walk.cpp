// Compiled twice with different SF_READ_LANE, see lane_walk.h.

#include "bench/lane_walk.h"

#include "sensors/lane_markings/host_fit.h"

namespace sf::bench {

namespace {

using sensors::MarkingRaster;

constexpr int kBlock = MarkingRaster::kBlock;

struct Met {
  double range;  ///< [m]
  std::uint32_t tag;
};

struct Cell {
  std::uint32_t word;
  bool painted;
  int side;  ///< [cells] side of the empty square around a free cell of a full block
};

Cell cell_at(const MarkingRaster& raster, int x, int y, std::size_t plane) {
  const std::uint32_t word =
      raster
          .directory()[static_cast<std::size_t>(y / kBlock) * raster.columns() + static_cast<std::size_t>(x / kBlock)];
  if ((word & MarkingRaster::kFull) == 0) return {word, false, 1};
  const std::size_t at = 4 * std::size_t{word & ~MarkingRaster::kFull} + plane + static_cast<std::size_t>((y & 7) >> 2);
  const std::uint32_t half = raster.blocks()[at];
  const bool quarter_free = (half & (0x0F0F0F0Fu << (x & 4))) == 0;
  const bool pair_free = (half & (0x0303u << (((y & 2) << 3) | (x & 6)))) == 0;
  return {word, ((half >> ((y & 3) * kBlock + (x & 7))) & 1u) != 0, quarter_free ? 4 : pair_free ? 2 : 1};
}

/// Returns the distance from `p` [cells of the raster] along `d` to the start of paint, or to its end if `p` is on
/// paint.
Met walk_paint(const LaneJob& job, glm::dvec2 p, glm::dvec2 d, double reach) {
  const MarkingRaster& raster = *job.raster;
  const glm::dvec2 inverse{d.x == 0.0 ? 1e300 : 1.0 / d.x, d.y == 0.0 ? 1e300 : 1.0 / d.y};
  const int most_x = static_cast<int>(raster.columns()) * kBlock;
  const int most_y = static_cast<int>(raster.rows()) * kBlock;
  int x = static_cast<int>(std::floor(p.x));
  int y = static_cast<int>(std::floor(p.y));
  if (x < 0 || y < 0 || x >= most_x || y >= most_y) return {job.range_max, SF_NO_HIT};
  const bool wanted = !cell_at(raster, x, y, 0).painted;
  int last_x = x;
  int last_y = y;
  double t = 0.0;
  while (t < reach && x >= 0 && y >= 0 && x < most_x && y < most_y) {
    const Cell c = cell_at(raster, x, y, 0);
    if (c.painted == wanted) {
      const bool end = cell_at(raster, wanted ? x : last_x, wanted ? y : last_y, 2).painted;
      return {t * raster.cell(), job.paint_tag | (end ? SF_TAG_END : 0u)};
    }
    const bool full = (c.word & MarkingRaster::kFull) != 0;
    const int clear = full || !wanted ? 0 : static_cast<int>(c.word);
    const int side = wanted ? c.side : 1;
    const int low_x = clear > 0 ? (x / kBlock - clear + 1) * kBlock : x & -side;
    const int low_y = clear > 0 ? (y / kBlock - clear + 1) * kBlock : y & -side;
    const int high_x = clear > 0 ? (x / kBlock + clear) * kBlock : low_x + side;
    const int high_y = clear > 0 ? (y / kBlock + clear) * kBlock : low_y + side;
    const double tx = d.x == 0.0 ? 1e300 : ((d.x > 0.0 ? high_x : low_x) - p.x) * inverse.x;
    const double ty = d.y == 0.0 ? 1e300 : ((d.y > 0.0 ? high_y : low_y) - p.y) * inverse.y;
    last_x = x;
    last_y = y;
    if (tx < ty) {
      t = tx;
      x = d.x > 0.0 ? high_x : low_x - 1;
      y = std::min(std::max(static_cast<int>(std::floor(p.y + t * d.y)), low_y), high_y - 1);
    } else {
      t = ty;
      y = d.y > 0.0 ? high_y : low_y - 1;
      x = std::min(std::max(static_cast<int>(std::floor(p.x + t * d.x)), low_x), high_x - 1);
    }
  }
  return {job.range_max, SF_NO_HIT};
}

void walk_fan(const LaneJob& job, const base::Pose& X_WS, double* ranges, std::uint32_t* tags) {
  const double cell = job.raster->cell();
  const glm::dvec2 p{X_WS.x / cell - static_cast<double>(job.raster->first_column()),
                     X_WS.y / cell - static_cast<double>(job.raster->first_row())};
  const double c = std::cos(X_WS.yaw);
  const double s = std::sin(X_WS.yaw);
  for (std::size_t k = 0; k < job.beams.size(); ++k) {
    const glm::dvec2 b = job.beams[k];
    const Met met = walk_paint(job, p, {c * b.x - s * b.y, s * b.x + c * b.y}, job.range_max / cell);
    ranges[k] = met.range;
    tags[k] = met.tag;
  }
}

}  // namespace

void SF_READ_LANE(const LaneJob& job, const sensors::EdgeRow& row, const base::Pose& X_WS, sensors::EdgeReading& out) {
  double ranges[sensors::kMostEdgeSamples];
  std::uint32_t tags[sensors::kMostEdgeSamples];
  if (job.raster != nullptr)
    walk_fan(job, X_WS, ranges, tags);
  else
    job.walk(*job.grid, X_WS, job.beams, job.range_max, ranges, tags);
  sensors::fit::Points points;
  sensors::fit::make_points(row, {ranges, tags, job.directions.data(), nullptr}, points);
  out = sensors::fit::read_edge(row, points, job.grains);
}

}  // namespace sf::bench
