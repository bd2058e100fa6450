#include "sensors/lane_markings/host_raster.h"

#include <algorithm>
#include <cmath>

#include "sensors/lane_markings/marking_raster.h"

namespace sf::sensors {

namespace {

struct CellIndex {
  std::int32_t x, y;
};

/// Same as `Cell` in the kernel.
struct RasterCell {
  bool inside, full;
  std::uint32_t word, ends;
  std::uint32_t painted;
  std::int32_t clear;
};

struct RasterWalk {
  bool met = false, across_x = false;
  std::int32_t face = 0;
  CellIndex paint;
};

std::uint32_t bit_of(std::uint32_t half_block, CellIndex at) {
  return half_block >> (((at.y & 3) << 3) | (at.x & 7)) & 1u;
}

RasterCell cell_at(const RasterTables& tables, const RasterRow& row, CellIndex at) {
  const CellIndex block{at.x >> 3, at.y >> 3};
  RasterCell c{};
  c.inside = at.x >= 0 && at.y >= 0 && block.x < static_cast<std::int32_t>(row.columns) &&
             block.y < static_cast<std::int32_t>(row.rows);
  c.clear = 4;
  if (!c.inside) return c;
  c.word = tables.directory[static_cast<std::size_t>(block.y) * row.columns + static_cast<std::size_t>(block.x)];
  c.full = (c.word & MarkingRaster::kFull) != 0;
  if (!c.full) return c;
  const std::uint32_t* const bits =
      &tables.blocks[4 * std::size_t{c.word & ~MarkingRaster::kFull} + static_cast<std::size_t>((at.y & 7) >> 2)];
  c.ends = bits[2];
  c.painted = bit_of(bits[0], at);
  const std::uint32_t quarter = bits[0] & (0x0F0F0F0Fu << (at.x & 4));
  const std::uint32_t pairs = bits[0] & (0x0303u << (((at.y & 2) << 3) | (at.x & 6)));
  c.clear = quarter == 0u ? 4 : pairs == 0u ? 2 : 1;
  return c;
}

/// Returns the cell of a coordinate [cells] relative to the sensor's cell.
std::int32_t cell_of(float x, std::int32_t start, std::int32_t low, std::int32_t high) {
  return std::clamp(static_cast<std::int32_t>(std::floor(x)) + start, low, high - 1);
}

RasterWalk walk(const RasterTables& tables, const RasterRow& row, float dx, float dy) {
  const CellIndex start{row.column, row.row};
  const float inverse_x = dx == 0.0F ? 1e30F : 1.0F / dx, inverse_y = dy == 0.0F ? 1e30F : 1.0F / dy;
  RasterWalk w{.paint = start};
  if (row.column < 0) return w;
  const std::uint32_t wanted = 1u - cell_at(tables, row, start).painted;
  for (CellIndex at = start;;) {
    const RasterCell c = cell_at(tables, row, at);
    const bool met = c.painted == wanted;
    if (met == (wanted == 1u)) w.paint = at;
    w.met = met && c.inside;
    if (met || !c.inside) return w;
    const std::int32_t clear = c.full || wanted == 0u ? 0 : static_cast<std::int32_t>(c.word);
    const std::int32_t side = wanted == 0u ? 1 : c.clear;
    CellIndex low{at.x & -side, at.y & -side}, high{low.x + side, low.y + side};
    if (clear > 0) {
      low = {((at.x >> 3) - (clear - 1)) * 8, ((at.y >> 3) - (clear - 1)) * 8};
      high = {((at.x >> 3) + clear) * 8, ((at.y >> 3) + clear) * 8};
    }
    const CellIndex exit{(dx > 0.0F ? high.x : low.x) - start.x, (dy > 0.0F ? high.y : low.y) - start.y};
    const float tx = (static_cast<float>(exit.x) - row.x) * inverse_x;
    const float ty = (static_cast<float>(exit.y) - row.y) * inverse_y;
    const bool across_x = dx != 0.0F && (dy == 0.0F || tx < ty);
    const float out_at = across_x ? tx : ty;
    if (!(out_at < row.reach)) return w;
    w.across_x = across_x;
    w.face = across_x ? exit.x : exit.y;
    at = across_x ? CellIndex{dx > 0.0F ? high.x : low.x - 1, cell_of(row.y + out_at * dy, start.y, low.y, high.y)}
                  : CellIndex{cell_of(row.x + out_at * dx, start.x, low.x, high.x), dy > 0.0F ? high.y : low.y - 1};
  }
}

}  // namespace

RasterHit cast_through_raster(const RasterTables& tables, const RasterRow& row, const raycast::BeamDirection& bearing,
                              const RasterHit& cast) {
  const double dx = row.heading_cos * bearing.cos - row.heading_sin * bearing.sin;
  const double dy = row.heading_sin * bearing.cos + row.heading_cos * bearing.sin;
  const RasterWalk w = walk(tables, row, static_cast<float>(dx), static_cast<float>(dy));
  const double span = w.face - double{w.across_x ? row.x : row.y};
  const double along = w.across_x ? dx : dy;
  const double paint_range = std::max(span / (along == 0.0 ? 1.0 : along), 0.0) * row.cell;
  const bool met = w.met && paint_range < row.range_max;
  if ((row.flags & SF_EDGE_CAST) != 0u && cast.tag != SF_NO_HIT && (!met || cast.range < paint_range)) return cast;
  if (!met) return {row.range_max, SF_NO_HIT};
  const RasterCell painted = cell_at(tables, row, w.paint);
  const bool is_end = painted.full && bit_of(painted.ends, w.paint) != 0;
  return {paint_range, row.tag | (is_end ? SF_TAG_END : 0u)};
}

}  // namespace sf::sensors
