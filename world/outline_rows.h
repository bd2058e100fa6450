#pragma once
// The rows of a file of outlines: of a text table, or, through GDAL, the features of a GeoPackage, shapefile or GeoJSON
// file.
//
// Tables have their own reader, because GDAL's reader has no line numbers and loses broken rows (docs/architecture.md).
// Other formats are read by GDAL, whose 100 libraries are in a plug-in (world/gdal/, `sensorfarm_gdal.so`) that is
// loaded with the first such file. Both only return rows; world/well_known_geometry.h interprets the geometries.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace sf::world {

struct OutlineRow {
  std::string_view geometry;      ///< text, or the bytes of well-known binary; empty: none. Valid until the next row
  std::string_view height;        ///< as written; empty: none
  int line = 0;                   ///< 1-based, first line of the row; 0: not a text file
  std::string place;              ///< place of a feature, for messages, e.g. "feature 3"
  bool is_binary = false;         ///< `geometry` is well-known binary
  std::string_view behind_quote;  ///< ignored text between a closing quote and the next separator
  std::string_view degrees;       ///< why the coordinates are in degrees, for a warning; empty: not stated
  double metres_per_unit = 0.0;   ///< [m] unit of coordinates as stated in the file; 0: not stated
};

class OutlineRows {
 public:
  virtual ~OutlineRows() = default;
  /// @return false after the last row
  /// @throws base::InputError if the file cannot be read any further
  virtual bool next(OutlineRow& row) = 0;
  /// Describes the columns for messages: "its columns are 'id' and 'name'".
  virtual std::string columns() const = 0;
  /// Returns a warning about the whole file, after the last row; empty: none.
  virtual std::string remark() const { return {}; }
};

/// Opens a file by its content.
/// @throws base::InputError if it is neither text nor one of GDAL's three formats
std::unique_ptr<OutlineRows> open_outline_rows(const std::string& file);

/// Opens a text table, whose first lines determine its dialect.
std::unique_ptr<OutlineRows> open_outline_table(const std::string& file);

/// Units of a coordinate system.
struct SystemUnits {
  bool is_degrees = false;
  double metres_per_unit = 0.0;  ///< [m]; 0: unknown, or degrees
};
/// Returns the units of the system with this EPSG number, from GDAL's tables. If the plug-in or its tables are missing,
/// units are unknown, except that numbers from 4001 to 4999 are degrees.
SystemUnits units_of_epsg(std::uint32_t number);

/// Throws base::InputError unless a height map of this size is within the limits (world/terrain.h).
using HeightMapSizeRule = void (*)(const std::string& file, std::uint64_t columns, std::uint64_t rows);
struct HeightMap;

/// The interface of the GDAL plug-in. `open` and `read_heights` throw base::InputError with GDAL's reasons.
struct GdalPlugin {
  std::unique_ptr<OutlineRows> (*open)(const std::string& file);
  SystemUnits (*units_of_epsg)(std::uint32_t number);
  HeightMap (*read_heights)(const std::string& file, HeightMapSizeRule require_size);  ///< of a GeoTIFF
};
/// Name of the plug-in's only symbol: `extern "C" const GdalPlugin sensorfarm_gdal`.
inline constexpr const char* kGdalSymbol = "sensorfarm_gdal";

}  // namespace sf::world
