#include "world/gdal/heights.h"

#include <fmt/format.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/error.h"

namespace sf::world {

namespace {

using Dataset = std::unique_ptr<void, decltype(&GDALClose)>;

[[noreturn]] void refuse(const std::string& file, const std::string& reason) {
  throw base::InputError(file, 0, reason);
}

/// Distances of points [m]; 0 where the file states none in metres.
glm::dvec2 cell_of(const std::string& file, GDALDatasetH dataset, bool& south_up) {
  std::array<double, 6> g{};
  if (GDALGetGeoTransform(dataset, g.data()) != CE_None) return {};
  if (g[2] != 0.0 || g[4] != 0.0) refuse(file, "its rows are turned; expected rows along x: use gdalwarp");
  south_up = g[5] > 0.0;
  const OGRSpatialReferenceH system = GDALGetSpatialRef(dataset);
  if (system != nullptr && OSRIsGeographic(system) != 0) return {};
  const double unit = system == nullptr ? 1.0 : OSRGetLinearUnits(system, nullptr);
  return {std::abs(g[1]) * unit, std::abs(g[5]) * unit};
}

void require_values(const std::string& file, GDALRasterBandH band, const HeightMap& map) {
  int has_none = 0;
  const double none = GDALGetRasterNoDataValue(band, &has_none);
  for (std::size_t i = 0; i < map.heights.size(); ++i) {
    const float height = map.heights[i];
    if (std::isfinite(height) && std::abs(height) <= 1e5f && !(has_none != 0 && height == static_cast<float>(none)))
      continue;
    refuse(file,
           fmt::format("the height in column {}, row {} is {}; expected heights within 100 km everywhere: fill gaps "
                       "with gdal_fillnodata.py",
                       i % map.columns, i / map.columns, height));
  }
}

}  // namespace

HeightMap read_heights_by_gdal(const std::string& file, HeightMapSizeRule require_size) {
  static const bool once = (GDALRegister_GTiff(), true);
  static_cast<void>(once);
  std::string messages;
  const Guard guard(messages);
  // The absolute path never matches one of GDAL's special file names.
  const Dataset dataset(
      GDALOpenEx(std::filesystem::absolute(file).c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr),
      &GDALClose);
  if (dataset == nullptr) refuse(file, "cannot be read as a GeoTIFF: " + messages);
  const int columns = GDALGetRasterXSize(dataset.get()), rows = GDALGetRasterYSize(dataset.get());
  require_size(file, static_cast<std::uint64_t>(columns), static_cast<std::uint64_t>(rows));
  if (GDALGetRasterCount(dataset.get()) != 1)
    refuse(file, fmt::format("has {} bands; expected one band of heights", GDALGetRasterCount(dataset.get())));
  const GDALRasterBandH band = GDALGetRasterBand(dataset.get(), 1);
  HeightMap map{static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), {}, {}};
  bool south_up = false;
  map.cell = cell_of(file, dataset.get(), south_up);
  map.heights.resize(std::size_t{map.columns} * map.rows);
  if (GDALRasterIO(band, GF_Read, 0, 0, columns, rows, map.heights.data(), columns, rows, GDT_Float32, 0, 0) != CE_None)
    refuse(file, "its heights cannot be read: " + messages);
  require_values(file, band, map);
  for (std::size_t y = 0; !south_up && y < map.rows / 2; ++y)
    std::swap_ranges(map.heights.begin() + static_cast<std::ptrdiff_t>(y * map.columns),
                     map.heights.begin() + static_cast<std::ptrdiff_t>((y + 1) * map.columns),
                     map.heights.begin() + static_cast<std::ptrdiff_t>((map.rows - 1 - y) * map.columns));
  return map;
}

}  // namespace sf::world
