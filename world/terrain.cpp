#include "world/terrain.h"

#include <fmt/format.h>
#include <spng.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/files.h"
#include "base/plugin.h"
#include "world/outline_rows.h"

namespace sf::world {

namespace {

constexpr std::size_t kMostBytes = 300u << 20;  // of a file
constexpr double kMostValue = 65535.0;

void check(const std::string& file, int result) {
  if (result != 0)
    throw base::InputError(file, 0, fmt::format("corrupt PNG: {}; save it again", spng_strerror(result)));
}

void require_grey(const std::string& file, const spng_ihdr& header) {
  if (header.color_type == SPNG_COLOR_TYPE_GRAYSCALE && header.bit_depth == 16) return;
  throw base::InputError(
      file, 0,
      fmt::format("a picture of {} bits {}; expected a height map as greyscale PNG of 16 bits: "
                  "convert it (gdal_translate -ot UInt16 -scale -of PNG)",
                  header.bit_depth,
                  header.color_type == SPNG_COLOR_TYPE_GRAYSCALE ? "per pixel" : "in colour or with alpha"));
}

}  // namespace

void require_height_map_size(const std::string& file, std::uint64_t columns, std::uint64_t rows) {
  if (std::min(columns, rows) >= 2 && std::max(columns, rows) <= kMostSide && columns * rows <= kMostHeights) return;
  throw base::InputError(
      file, 0,
      fmt::format("a height map of {} x {} points; expected 2 to {} along each side, and at most {} in all", columns,
                  rows, kMostSide, kMostHeights));
}

HeightMap decode_height_map(const std::string& file, const std::string& bytes, double lowest, double highest) {
  if (!bytes.starts_with("\x89PNG"))
    throw base::InputError(file, 0, "is not a height map; expected a greyscale PNG of 16 bits, or a GeoTIFF (.tif)");
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> png(spng_ctx_new(0), &spng_ctx_free);
  check(file, spng_set_png_buffer(png.get(), bytes.data(), bytes.size()));
  check(file, spng_set_image_limits(png.get(), 1u << 24, 1u << 24));
  check(file, spng_set_chunk_limits(png.get(), 4u << 20, 4u << 20));
  spng_ihdr header{};
  check(file, spng_get_ihdr(png.get(), &header));
  require_grey(file, header);
  require_height_map_size(file, header.width, header.height);
  std::vector<std::uint16_t> values(std::size_t{header.width} * header.height);
  check(file, spng_decode_image(png.get(), values.data(), 2 * values.size(), SPNG_FMT_PNG, 0));
  HeightMap map{header.width, header.height, std::vector<float>(values.size()), {}};
  for (std::size_t y = 0; y < map.rows; ++y)
    for (std::size_t x = 0; x < map.columns; ++x)
      map.heights[y * map.columns + x] =
          static_cast<float>(lowest + (highest - lowest) * (values[(map.rows - 1 - y) * map.columns + x] / kMostValue));
  return map;
}

bool is_geotiff(const std::string& file) {
  const std::string ending = base::ending_of(file);
  return ending == ".tif" || ending == ".tiff";
}

HeightMap read_geotiff(const std::string& file) {
  const auto* const plugin = static_cast<const GdalPlugin*>(
      base::load_plugin(kGdalSymbol, "only PNG height maps can be read; convert this one to a greyscale PNG of 16 bits",
                        "GDAL (Debian: libgdal32)"));
  return plugin->read_heights(file, require_height_map_size);
}

HeightMap read_height_map(const std::string& file, double lowest, double highest) {
  return decode_height_map(file, base::read_bytes(file, kMostBytes), lowest, highest);
}

glm::dvec2 size_of(const Terrain& terrain) { return terrain.cell * glm::dvec2(terrain.columns - 1, terrain.rows - 1); }

Pose corner_of(const Terrain& terrain) {
  const glm::dvec2 size = size_of(terrain);
  return compose(terrain.X_WT, {-0.5 * size.x, -0.5 * size.y, 0.0, 0.0});
}

std::array<glm::dvec2, 4> outline_of(const Terrain& terrain) {
  const Pose X_WF = corner_of(terrain);
  const glm::dvec2 size = size_of(terrain);
  return {transform(X_WF, {0.0, 0.0}), transform(X_WF, {size.x, 0.0}), transform(X_WF, size),
          transform(X_WF, {0.0, size.y})};
}

TerrainSurface::TerrainSurface(const Terrain& terrain)
    : terrain_(terrain), X_FW_(inverse(corner_of(terrain))), turn_(base::sin_cos(X_FW_.yaw)) {}

glm::dvec2 TerrainSurface::in_frame(glm::dvec2 p) const {
  const auto [s, c] = turn_;
  return glm::dvec2{X_FW_.x, X_FW_.y} + glm::dvec2{c * p.x - s * p.y, s * p.x + c * p.y};
}

glm::dvec2 TerrainSurface::border(glm::dvec2 p) const {
  const glm::dvec2 size = size_of(terrain_), at = in_frame(p);
  glm::dvec2 nearest = glm::clamp(at, glm::dvec2{}, size);
  if (nearest == at) {
    const glm::dvec2 side{at.x < 0.5 * size.x ? 0.0 : size.x, at.y < 0.5 * size.y ? 0.0 : size.y};
    const glm::dvec2 away = glm::abs(side - at);
    (away.x < away.y ? nearest.x : nearest.y) = away.x < away.y ? side.x : side.y;
  }
  const auto [s, c] = turn_;
  const glm::dvec2 way = nearest - at;
  return p + glm::dvec2{c * way.x + s * way.y, c * way.y - s * way.x};
}

std::optional<GroundPoint> TerrainSurface::at(glm::dvec2 p) const {
  const Terrain& terrain = terrain_;
  const auto [s, c] = turn_;
  const glm::dvec2 at = in_frame(p) / terrain.cell;
  if (!(at.x >= 0.0 && at.y >= 0.0 && at.x <= terrain.columns - 1.0 && at.y <= terrain.rows - 1.0)) return {};
  const auto i = std::min(static_cast<std::uint32_t>(at.x), terrain.columns - 2);
  const auto j = std::min(static_cast<std::uint32_t>(at.y), terrain.rows - 2);
  const float* const row = terrain.heights.data() + std::size_t{j} * terrain.columns + i;
  const double a = row[0], e = row[terrain.columns + 1], x = at.x - i, y = at.y - j;
  // Cut along the diagonal from the corner with the smallest x and y.
  const double side = x >= y ? row[1] : row[terrain.columns];
  const glm::dvec2 rise = x >= y ? glm::dvec2{side - a, e - side} : glm::dvec2{e - side, side - a};
  const glm::dvec2 g = rise / terrain.cell;
  return GroundPoint{terrain.X_WT.z + a + (side - a) * std::abs(x - y) + (e - a) * std::min(x, y),
                     {c * g.x + s * g.y, c * g.y - s * g.x}};
}

std::optional<double> height_at(const Terrain& terrain, glm::dvec2 p) {
  const auto found = TerrainSurface(terrain).at(p);
  return found ? std::optional(found->z) : std::nullopt;
}

}  // namespace sf::world
