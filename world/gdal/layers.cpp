// The GDAL plug-in: returns features of GeoPackages, shapefiles and GeoJSON as rows.

#include <fmt/format.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <climits>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "world/gdal/guard.h"
#include "world/gdal/heights.h"
#include "world/outline_rows.h"

namespace sf::world {

namespace {

constexpr std::size_t kShownNames = 20;

std::string quoted(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kShownNames); ++i)
    text += fmt::format("{}'{}'", i > 0 ? ", " : "", names[i]);
  return names.size() > kShownNames ? text + ", ..." : text;
}

/// @param system null: none
SystemUnits units_of(OGRSpatialReferenceH system) {
  if (system == nullptr) return {};
  // A GeoPackage without a stated system has this one.
  if (std::string_view(OSRGetName(system)) == "Undefined geographic SRS") return {};
  if (OSRIsGeographic(system) != 0) return {.is_degrees = true};
  const double unit = OSRGetLinearUnits(system, nullptr);
  return {.metres_per_unit = OSRIsProjected(system) != 0 || (OSRIsLocal(system) != 0 && unit != 1.0) ? unit : 0.0};
}

SystemUnits units_of_epsg_by_gdal(std::uint32_t number) {
  std::string messages;
  const Guard guard(messages);
  const OGRSpatialReferenceH system = OSRNewSpatialReference(nullptr);
  const bool is_known = number <= INT_MAX && OSRImportFromEPSG(system, static_cast<int>(number)) == OGRERR_NONE;
  const SystemUnits units = is_known ? units_of(system) : SystemUnits();
  OSRDestroySpatialReference(system);
  return units;
}

/// Returns whether a property `height` of a GeoJSON file is true or false. In a column of numbers, GDAL reads these as
/// 1 and 0.
bool has_flags(const std::string& file) {
  constexpr std::string_view kName = "\"height\"";
  constexpr std::size_t kBlock = 1u << 20, kKept = 256;  // bytes
  const auto same = [](char a, char b) { return (a | 0x20) == b; };
  std::ifstream in(file, std::ios::binary);
  std::string text, block(kBlock, '\0');
  while (in.read(block.data(), kBlock), in.gcount() > 0) {
    text.append(block, 0, static_cast<std::size_t>(in.gcount()));
    for (auto at = text.begin();;) {
      at = std::search(at, text.end(), kName.begin(), kName.end(), same);
      if (at == text.end()) break;
      at += kName.size();
      const std::string_view rest = std::string_view(text).substr(static_cast<std::size_t>(at - text.begin()));
      const std::string_view value = rest.substr(std::min(rest.find_first_not_of(" \t\r\n:"), rest.size()));
      if (value.starts_with("true") || value.starts_with("false")) return true;
    }
    text.erase(0, text.size() - std::min(text.size(), kKept));
  }
  return false;
}

class Layers : public OutlineRows {
 public:
  explicit Layers(const std::string& file) : file_(file) {
    const Guard guard(messages_);
    // The absolute path never matches one of GDAL's special file names.
    dataset_ = GDALOpenEx(std::filesystem::absolute(file).c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr,
                          nullptr);
    if (dataset_ == nullptr)
      throw base::InputError(file, 0,
                             "cannot be read as a GeoPackage, shapefile or GeoJSON: " +
                                 (messages_.empty() ? "no driver of GDAL recognises it" : messages_));
    is_json_ = std::string_view(GDALGetDriverShortName(GDALGetDatasetDriver(dataset_))).starts_with("GeoJSON");
    for (int i = 0; i < GDALDatasetGetLayerCount(dataset_); ++i) {
      const OGRLayerH layer = GDALDatasetGetLayer(dataset_, i);
      if (OGR_L_GetGeomType(layer) == wkbNone) continue;
      layers_.push_back(layer);
      names_.emplace_back(OGR_L_GetName(layer));
    }
  }
  ~Layers() override {
    const Guard guard(messages_);
    OGR_F_Destroy(feature_);
    GDALClose(dataset_);
  }

  bool next(OutlineRow& row) override {
    const Guard guard(messages_);
    for (; at_ < layers_.size(); ++at_, entered_ = false) {
      if (!entered_) enter();
      OGR_F_Destroy(feature_);
      feature_ = OGR_L_GetNextFeature(layers_[at_]);
      if (feature_ != nullptr) return read(row), true;
    }
    return false;
  }
  std::string columns() const override {
    std::vector<std::string> fields;
    for (const OGRLayerH layer : layers_)
      for (int i = 0; i < OGR_FD_GetFieldCount(OGR_L_GetLayerDefn(layer)); ++i)
        fields.emplace_back(OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(OGR_L_GetLayerDefn(layer), i)));
    return fmt::format("its layers are {}, their columns {}", layers_.empty() ? "none" : quoted(names_),
                       fields.empty() ? "none" : quoted(fields));
  }
  std::string remark() const override {
    std::string text = messages_.empty() ? "" : "GDAL: " + messages_;
    if (layers_.size() > 1)
      text +=
          fmt::format("{}all {} layers are read ({}); extract a single one with ogr2ogr -f GPKG ONE.gpkg FILE LAYER",
                      text.empty() ? "" : "; ", layers_.size(), quoted(names_));
    if (is_json_ && has_numbers_ && has_flags(file_))
      text += fmt::format("{}a height is true or false, which is read as 1 or 0; expected numbers",
                          text.empty() ? "" : "; ");
    return text;
  }

 private:
  void enter() {
    entered_ = true;
    OGR_L_ResetReading(layers_[at_]);
    const OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layers_[at_]);
    height_column_ = -1;
    for (int i = OGR_FD_GetFieldCount(definition); i-- > 0;)
      if (EQUAL(OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(definition, i)), "height")) height_column_ = i;
    const SystemUnits units = units_of(OGR_L_GetSpatialRef(layers_[at_]));
    metres_per_unit_ = units.metres_per_unit;
    degrees_ = {};
    if (units.is_degrees)
      degrees_ = is_json_
                     ? "coordinates of GeoJSON are degrees unless its member 'crs' states another system (RFC 7946)"
                     : "the file states that the coordinates are in degrees";
  }
  void read(OutlineRow& row) {
    const OGRGeometryH geometry = OGR_F_GetGeometryRef(feature_);
    bytes_.resize(geometry != nullptr ? OGR_G_WkbSizeEx(geometry) : 0);
    if (geometry != nullptr) OGR_G_ExportToIsoWkb(geometry, wkbNDR, reinterpret_cast<unsigned char*>(bytes_.data()));
    read_height();
    row = {.geometry = bytes_,
           .height = height_,
           .place = fmt::format("feature {}", OGR_F_GetFID(feature_)),
           .is_binary = true,
           .degrees = degrees_,
           .metres_per_unit = metres_per_unit_};
    if (layers_.size() > 1) row.place += " of layer '" + names_[at_] + "'";
  }
  /// Reads numbers with all their digits.
  void read_height() {
    height_.clear();
    if (height_column_ < 0 || OGR_F_IsFieldSetAndNotNull(feature_, height_column_) == 0) return;
    const OGRFieldDefnH field = OGR_F_GetFieldDefnRef(feature_, height_column_);
    const bool is_real = OGR_Fld_GetType(field) == OFTReal;
    if (OGR_Fld_GetSubType(field) == OFSTBoolean) {
      height_ = OGR_F_GetFieldAsInteger(feature_, height_column_) != 0 ? "true" : "false";
      return;
    }
    if (is_real) {
      height_ = fmt::format("{}", OGR_F_GetFieldAsDouble(feature_, height_column_));
    } else {
      height_ = OGR_F_GetFieldAsString(feature_, height_column_);
    }
    has_numbers_ = has_numbers_ || is_real || OGR_Fld_GetType(field) == OFTInteger;
  }

  std::string file_;
  std::string messages_;  ///< GDAL's messages so far
  GDALDatasetH dataset_ = nullptr;
  bool is_json_ = false;
  bool has_numbers_ = false;       ///< heights may be numbers or flags
  std::vector<OGRLayerH> layers_;  ///< layers with geometries
  std::vector<std::string> names_;
  std::size_t at_ = 0;    ///< current layer
  bool entered_ = false;  ///< the following three members are of the current layer
  int height_column_ = -1;
  std::string_view degrees_;
  double metres_per_unit_ = 0.0;
  OGRFeatureH feature_ = nullptr;
  std::string bytes_, height_;  ///< of the current feature
};

std::unique_ptr<OutlineRows> open_layers(const std::string& file) {
  // Registers only these drivers. Others open files or network resources that the content refers to.
  static const bool once =
      (RegisterOGRGeoPackage(), RegisterOGRShape(), RegisterOGRGeoJSON(), RegisterOGRGeoJSONSeq(), true);
  static_cast<void>(once);
  return std::make_unique<Layers>(file);
}

}  // namespace

}  // namespace sf::world

extern "C" {
extern const sf::world::GdalPlugin sensorfarm_gdal;
const sf::world::GdalPlugin sensorfarm_gdal{.open = sf::world::open_layers,
                                            .units_of_epsg = sf::world::units_of_epsg_by_gdal,
                                            .read_heights = sf::world::read_heights_by_gdal};
}
