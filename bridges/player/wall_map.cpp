#include "bridges/player/wall_map.h"

#include <zlib.h>

#include <algorithm>
#include <vector>

#include "base/error.h"

namespace sf::bridges::player {

namespace {

constexpr std::uint8_t kOccupied = 1, kFree = 0xFF;
constexpr std::size_t kMostSegments = 200'000;

base::Bytes compressed(const base::Bytes& plain) {
  uLongf size = compressBound(plain.size());
  base::Bytes packed(size);
  const int failed = compress(packed.data(), &size, plain.data(), plain.size());
  SF_CHECK(failed == Z_OK, "compress: " + std::to_string(failed));
  packed.resize(size);
  return packed;
}

}  // namespace

void put_map_info(const record::WorldShape& shape, XdrWriter& xdr) {
  xdr.put(static_cast<float>(shape.cell));
  xdr.put_all({shape.columns, shape.rows});
  xdr.put_all({shape.corner.x, shape.corner.y, 0.0});
}

bool put_map_tile(const record::WorldShape& shape, const Tile& tile, XdrWriter& xdr) {
  if (tile.col >= shape.columns || tile.row >= shape.rows) return false;
  const std::uint32_t across = std::min(tile.width, shape.columns - tile.col);
  const std::uint32_t up = std::min(tile.height, shape.rows - tile.row);
  if (across == 0 || up == 0) return false;
  base::Bytes cells;
  for (std::uint32_t row = tile.row; row < tile.row + up; ++row)
    for (std::uint32_t col = tile.col; col < tile.col + across; ++col)
      cells.push_back(shape.occupied[std::size_t{row} * shape.columns + col] ? kOccupied : kFree);
  const base::Bytes packed = compressed(cells);
  const auto size = static_cast<std::uint32_t>(packed.size());
  xdr.put_all({tile.col, tile.row, across, up, size, std::uint32_t{kOccupied}, size});
  xdr.put_padded(packed);
  return true;
}

void put_map_segments(const world::World& world, XdrWriter& xdr) {
  std::vector<const world::Segment*> walls;
  for (const world::Segment& wall : world.walls)
    if (wall.stops_robots && walls.size() < kMostSegments) walls.push_back(&wall);
  const world::Extent& extent = world.extent;
  for (const double bound : {extent.x_min, extent.x_max, extent.y_min, extent.y_max})
    xdr.put(static_cast<float>(bound));
  xdr.put_count(walls.size());
  for (const world::Segment* wall : walls) xdr.put_all({wall->a.x, wall->a.y, wall->b.x, wall->b.y});
}

}  // namespace sf::bridges::player
