#include "world/outline_rows.h"

#include <fmt/format.h>

#include <array>
#include <fstream>

#include "base/error.h"
#include "base/files.h"
#include "base/plugin.h"

namespace sf::world {

namespace {

using namespace std::string_view_literals;

/// Formats by their first bytes.
struct Signature {
  std::string_view bytes;
  bool gdal;
  const char* what;  ///< name, and advice if the format is not read
};
constexpr std::array kSignatures{
    Signature{"SQLite format 3\0"sv, true, ""},
    Signature{"\0\0\x27\x0A"sv, true, ""},
    Signature{"\xFF\xFE"sv, false, "UTF-16 text: save it as UTF-8"},
    Signature{"\xFE\xFF"sv, false, "UTF-16 text: save it as UTF-8"},
    Signature{"PK\x03\x04"sv, false, "a ZIP archive (or an XLSX file): unpack it, or save the table as CSV"},
    Signature{"\x1F\x8B"sv, false, "compressed: unpack it with gunzip"},
    Signature{"<"sv, false, "XML or HTML: convert it, e.g. with ogr2ogr -f GPKG"}};

constexpr std::string_view kBeforeJson = " \t\r\n\x1E";  // and the mark of GeoJSON text sequences

std::string first_bytes(const std::string& file) {
  base::LineFile check(file);  // rejects devices and pipes
  std::string bytes(512, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

const GdalPlugin& gdal_plugin() {
  static const auto* const loaded = static_cast<const GdalPlugin*>(
      base::load_plugin(kGdalSymbol, "outlines can be read from text tables only", "GDAL 3.6 (Debian: libgdal32)"));
  return *loaded;
}

std::unique_ptr<OutlineRows> open_with_gdal(const std::string& file) {
  const GdalPlugin* plugin = nullptr;
  try {
    plugin = &gdal_plugin();
  } catch (const base::InputError& error) {
    throw base::InputError(file, 0, fmt::format("requires GDAL: {}", error.what()));
  }
  return plugin->open(file);
}

}  // namespace

SystemUnits units_of_epsg(std::uint32_t number) {
  try {
    if (const SystemUnits units = gdal_plugin().units_of_epsg(number); units.is_degrees || units.metres_per_unit > 0.0)
      return units;
  } catch (const base::InputError&) {  // no GDAL
  }
  return {.is_degrees = number >= 4001 && number <= 4999};
}

std::unique_ptr<OutlineRows> open_outline_rows(const std::string& file) {
  const std::string bytes = first_bytes(file);
  std::string_view text = bytes;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (const Signature& row : kSignatures) {
    if (!text.starts_with(row.bytes)) continue;
    if (row.gdal) return open_with_gdal(file);
    throw base::InputError(file, 0, std::string("is ") + row.what);
  }
  const std::size_t start = text.find_first_not_of(kBeforeJson);
  if (start != std::string_view::npos && text[start] == '{') return open_with_gdal(file);
  if (text.find('\0') != std::string_view::npos)
    throw base::InputError(
        file, 0,
        "is not text; expected a table with geometries in well-known text, a GeoPackage, a shapefile "
        "(.shp) or GeoJSON");
  return open_outline_table(file);
}

}  // namespace sf::world
