#pragma once
// The rows of a file of outlines: of a table in text, or, through GDAL, the features of a GeoPackage, shapefile or
// GeoJSON file.
//
// Tables have a reader of their own, because GDAL's has no line numbers and loses broken rows (docs/architecture.md).
// Other formats are read by GDAL, whose 100 libraries are a plug-in (world/gdal/, `sensorfarm_gdal.so`) that is loaded
// with the first such file. Both hand on rows alone; what a geometry means is decided in one place
// (world/well_known_geometry.h).

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace sf::world {

struct OutlineRow {
  std::string_view geometry;      ///< text, or the bytes of well-known binary; empty: none. Lives until the next row
  std::string_view height;        ///< as written; empty: none
  int line = 0;                   ///< 1-based, where the row begins; 0: not a text
  std::string place;              ///< of a feature, for messages, e.g. "feature 3"
  bool is_binary = false;         ///< `geometry` is well-known binary
  std::string_view behind_quote;  ///< text between a closing quote and the next separator, which is ignored
  std::string_view degrees;       ///< why coordinates are degrees, for a warning; empty: nothing states it
  double metres_per_unit = 0.0;   ///< [m] of coordinates, by the file's own words; 0: it states none
};

class OutlineRows {
 public:
  virtual ~OutlineRows() = default;
  /// @return false after the last row  @throws base::InputError when the file cannot be read on
  virtual bool next(OutlineRow& row) = 0;
  /// Of the columns, as in messages: "its columns are 'id' and 'name'".
  virtual std::string columns() const = 0;
  /// After the last row: what its reader has to say about the whole file, for a warning; empty: nothing.
  virtual std::string remark() const { return {}; }
};

/// Opens a file by its content. @throws base::InputError for what is neither text nor one of GDAL's three formats
std::unique_ptr<OutlineRows> open_outline_rows(const std::string& file);

/// A table in text; its first lines state how it is written.
std::unique_ptr<OutlineRows> open_outline_table(const std::string& file);

/// Of a coordinate system.
struct SystemUnits {
  bool is_degrees = false;
  double metres_per_unit = 0.0;  ///< [m]; 0: not known, or degrees
};
/// Of the system with this number of EPSG, by GDAL's tables. Nothing is known where the plug-in or its tables are
/// missing, but that numbers from 4001 to 4999 are degrees.
SystemUnits units_of_epsg(std::uint32_t number);

/// GDAL's part. `open` throws base::InputError with GDAL's reasons.
struct GdalPlugin {
  std::unique_ptr<OutlineRows> (*open)(const std::string& file);
  SystemUnits (*units_of_epsg)(std::uint32_t number);
};
/// The name of the plug-in's only symbol: `extern "C" const GdalPlugin sensorfarm_gdal`.
inline constexpr const char* kGdalSymbol = "sensorfarm_gdal";

}  // namespace sf::world
