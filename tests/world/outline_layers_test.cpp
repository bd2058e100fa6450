// Outlines in the formats that GDAL reads, written by GDAL: the walls equal those of the same outlines in text.

#include <cpl_conv.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/refusal.h"
#include "world/outlines.h"
#include "world/stage/properties.h"

namespace sf::world {

namespace {

struct Feature {
  std::string wkt;  ///< empty: none
  double height;    ///< NaN: none
};

std::string in_folder(const std::string& name) { return (std::filesystem::temp_directory_path() / name).string(); }

using Wall = std::array<double, 6>;
struct LayerRead {
  std::vector<Wall> walls;  ///< sorted: formats may start a ring at another corner
  std::string warnings;
};

LayerRead read_layers(const std::string& file, double unit = 1.0) {
  OutlineFile outlines;
  outlines.file = file;
  outlines.metres_per_unit = unit;
  outlines.surface.z_max = 3.0;
  LayerRead found;
  std::vector<Warning> warnings;
  read_outlines(
      outlines,
      [&](std::span<const Segment> walls) {
        for (const Segment& w : walls)
          found.walls.push_back({w.a.x, w.a.y, w.b.x, w.b.y, w.z_max, w.solid_left ? 1.0 : 0.0});
      },
      &warnings);
  std::sort(found.walls.begin(), found.walls.end());
  for (const Warning& w : warnings) found.warnings += fmt::format("{}: {}\n", w.line, w.message);
  return found;
}

LayerRead read_layers_of(const std::string& name, const std::string& text) {
  std::ofstream(in_folder(name), std::ios::binary) << text;
  return read_layers(in_folder(name));
}

/// Writes a file with one layer of these features. @param options of the layer
std::string write_layer(const char* driver, const std::string& name, const std::vector<Feature>& features,
                        OGRwkbGeometryType type, const std::vector<std::string>& options = {}, int epsg = 32632,
                        int layers = 1) {
  RegisterOGRGeoPackage(), RegisterOGRShape(), RegisterOGRGeoJSON(), RegisterOGRGeoJSONSeq(), RegisterOGRCSV();
  std::filesystem::remove(in_folder(name));
  const GDALDatasetH dataset =
      GDALCreate(GDALGetDriverByName(driver), in_folder(name).c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  char** list = nullptr;
  for (const std::string& option : options) list = CSLAddString(list, option.c_str());
  const OGRSpatialReferenceH system = OSRNewSpatialReference(nullptr);
  OSRImportFromEPSG(system, epsg);
  for (int i = 0; i < layers; ++i) {
    const OGRLayerH layer = GDALDatasetCreateLayer(dataset, fmt::format("houses{}", i).c_str(), system, type, list);
    const OGRFieldDefnH field = OGR_Fld_Create("Height", OFTReal);
    OGR_L_CreateField(layer, field, 1);
    OGR_Fld_Destroy(field);
    for (const Feature& f : features) {
      const OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
      OGRGeometryH geometry = nullptr;
      std::string wkt = f.wkt;
      char* text = wkt.data();
      if (!wkt.empty() && OGR_G_CreateFromWkt(&text, nullptr, &geometry) == OGRERR_NONE)
        OGR_F_SetGeometryDirectly(feature, geometry);
      if (!std::isnan(f.height)) OGR_F_SetFieldDouble(feature, 0, f.height);
      EXPECT_EQ(OGR_L_CreateFeature(layer, feature), OGRERR_NONE);
      OGR_F_Destroy(feature);
    }
  }
  OSRDestroySpatialReference(system);
  CSLDestroy(list);
  GDALClose(dataset);
  return in_folder(name);
}

/// Returns a ring around a centre, with corners whose decimals are exact.
std::string ring_at_random(std::mt19937& random, glm::dvec2 centre, double size) {
  const int corners = 3 + static_cast<int>(random() % 8);
  std::string text;
  std::string first;
  for (int i = 0; i < corners; ++i) {
    const double r = size * std::uniform_real_distribution(0.5, 1.0)(random), a = 2.0 * M_PI * i / corners;
    const auto grid = [](double v) { return std::round(v * 64.0) / 64.0; };
    const std::string corner = fmt::format("{} {}", grid(centre.x + r * std::cos(a)), grid(centre.y + r * std::sin(a)));
    if (i == 0) first = corner;
    text += corner + ",";
  }
  return "(" + text + first + ")";
}

std::vector<Feature> features_at_random(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Feature> features;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec2 centre{500'000.0 + 30.0 * i, 4e6 + static_cast<double>(random() % 1000)};
    const std::string outer = ring_at_random(random, centre, 12.0), inner = ring_at_random(random, centre, 3.0);
    const std::string other = ring_at_random(random, centre + glm::dvec2(0, 2000), 9.0);
    const double height = static_cast<double>(random() % 100) / 8.0;
    features.push_back(i % 3 == 0   ? Feature{"MULTIPOLYGON ((" + outer + "),(" + other + "))", height}
                       : i % 3 == 1 ? Feature{"POLYGON (" + outer + "," + inner + ")", height}
                                    : Feature{"POLYGON (" + outer + ")", NAN});
  }
  return features;
}

std::string table_of(const std::vector<Feature>& features) {
  std::string text = "WKT,height\n";
  for (const Feature& f : features)
    text += fmt::format("\"{}\",{}\n", f.wkt, std::isnan(f.height) ? "" : fmt::format("{}", f.height));
  return text;
}

TEST(OutlineLayers, EveryFormatGivesTheWallsOfTheText) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::vector<Feature> houses = features_at_random(seed);
    const LayerRead text = read_layers_of("houses.txt", table_of(houses));
    EXPECT_EQ(text.warnings, "");
    ASSERT_GT(text.walls.size(), 300u);
    const std::string files[] = {
        write_layer("GPKG", "houses.gpkg", houses, wkbUnknown),
        write_layer("ESRI Shapefile", "houses.shp", houses, wkbPolygon),
        write_layer("GeoJSON", "houses.geojson", houses, wkbUnknown),
        write_layer("CSV", "comma.csv", houses, wkbUnknown, {"GEOMETRY=AS_WKT"}),
        write_layer("CSV", "semicolon.csv", houses, wkbUnknown, {"GEOMETRY=AS_WKT", "SEPARATOR=SEMICOLON"}),
        write_layer("CSV", "tab.csv", houses, wkbUnknown, {"GEOMETRY=AS_WKT", "SEPARATOR=TAB", "WRITE_BOM=YES"}),
        write_layer("CSV", "windows.csv", houses, wkbUnknown,
                    {"GEOMETRY=AS_WKT", "LINEFORMAT=CRLF", "STRING_QUOTING=ALWAYS"}),
    };
    for (const std::string& file : files) {
      const LayerRead found = read_layers(file);
      EXPECT_TRUE(found.walls == text.walls) << file << ": " << found.walls.size() << " of " << text.walls.size();
      EXPECT_EQ(found.warnings, "") << file;
    }
  }
}

TEST(OutlineLayers, RowsWithoutWallsAreNamedAndCounted) {
  std::vector<Feature> features{{"LINESTRING (0 0,900 0)", -2.0}, {"", 1.0}, {"POINT (1 2)", 1.0}};
  for (int i = 0; i < 5; ++i) features.push_back({"POLYGON EMPTY", 1.0});
  const LayerRead found = read_layers(write_layer("GPKG", "mixed.gpkg", features, wkbUnknown));
  EXPECT_EQ(found.walls.size(), 1u);
  EXPECT_EQ(found.walls[0][4], 3.0);
  EXPECT_EQ(
      found.warnings,
      "0: feature 1: the height is '-2'; expected a number alone, such as 3.5, from 0 to 1e+07: using the height of "
      "the model\n0: feature 2: has no geometry: left out\n0: feature 3: points have no walls: left out\n"
      "0: feature 4: the geometry is EMPTY: left out\n0: feature 5: the geometry is EMPTY: left out\n"
      "0: 3 more rows have no geometry and are left out\n");
  expect_in("has no outlines with walls; its layers are 'houses0', their columns 'Height'", sf::refusal_of([&] {
              read_layers(write_layer("GPKG", "none.gpkg", {{"POINT (1 2)", 1.0}}, wkbUnknown));
            }));
}

TEST(OutlineLayers, CurvesBecomeChordsWithinAMicrometre) {
  const std::vector<Feature> tower{
      {"CURVEPOLYGON (CIRCULARSTRING (500002 0,500000 2,499998 0,500000 -2,500002 0))", 9.0}};
  const LayerRead found = read_layers(write_layer("GPKG", "tower.gpkg", tower, wkbCurvePolygon));
  ASSERT_GT(found.walls.size(), 1000u);
  for (const Wall& w : found.walls) {
    EXPECT_NEAR(std::hypot(w[0] - 5e5, w[1]), 2.0, 1e-9);
    EXPECT_NEAR(std::hypot(0.5 * (w[0] + w[2]) - 5e5, 0.5 * (w[1] + w[3])), 2.0, 1.001e-6);
  }
}

TEST(OutlineLayers, SystemsInDegreesAndSeveralLayersAreNamed) {
  const std::vector<Feature> house{{"POLYGON ((11 48,11 49,12 49,11 48))", NAN}};
  expect_in("the file states that the coordinates are in degrees, but they are read as lengths",
            read_layers(write_layer("GPKG", "degrees.gpkg", house, wkbUnknown, {}, 4326)).warnings);
  expect_in("coordinates of GeoJSON are degrees unless its member 'crs' states another system",
            read_layers_of("degrees.json",
                           R"({"type": "Polygon", "coordinates": [[[11, 48], [11, 49], [12, 49], [11, 48]]]})")
                .warnings);
  const LayerRead two = read_layers(write_layer("GPKG", "two.gpkg", house, wkbUnknown, {}, 32632, 2));
  EXPECT_EQ(two.walls.size(), 6u);
  expect_in("all 2 layers are read ('houses0', 'houses1')", two.warnings);
}

TEST(OutlineLayers, UnitsOtherThanTheWorldsAreNamed) {  // New York in US survey feet, Germany in metres
  const std::vector<Feature> house{{"POLYGON ((0 0,12 0,12 8,0 0))", 5.0}};
  const std::string feet = "the file's coordinate system has a unit of 0.30480061 m, but its coordinates are read in";
  expect_in(feet, read_layers(write_layer("GPKG", "feet.gpkg", house, wkbUnknown, {}, 2263)).warnings);
  expect_in(feet, read_layers(write_layer("ESRI Shapefile", "feet.shp", house, wkbPolygon, {}, 2263)).warnings);
  expect_in(feet, read_layers(write_layer("GeoJSON", "feet.geojson", house, wkbUnknown, {}, 2263)).warnings);
  const std::string metres = write_layer("GPKG", "metres.gpkg", house, wkbUnknown);
  EXPECT_EQ(read_layers(metres).warnings, "");
  expect_in("has a unit of 1 m, but its coordinates are read in the world's, 0.01 m",
            read_layers(metres, 0.01).warnings);
}

TEST(OutlineLayers, SridOfATableStatesItsUnit) {
  const auto warnings = [](const char* srid) {
    return read_layers_of("srid.csv", fmt::format("SRID={};LINESTRING (0 0,12 0)\n", srid)).warnings;
  };
  EXPECT_EQ(warnings("32632"), "");
  EXPECT_EQ(warnings("999999"), "") << "an unknown one";
  EXPECT_EQ(warnings("4294967295"), "");
  expect_in("has a unit of 0.30480061 m", warnings("2263"));
  expect_in("the SRID states that the coordinates are in degrees", warnings("4326"));
  expect_in("the SRID states that the coordinates are in degrees", warnings("7844"));  // Australia
}

TEST(OutlineLayers, FlagIsNotAHeight) {
  const LayerRead found = read_layers_of("flag.json", R"({"type": "Feature", "properties": {"height": true},
      "geometry": {"type": "LineString", "coordinates": [[0, 0], [900, 0]]}})");
  EXPECT_EQ(found.walls[0][4], 3.0);
  expect_in("the height is 'true'", found.warnings);
  const auto feature = [](const char* height) {
    return fmt::format(R"({{"type": "Feature", "properties": {{"Height" : {}}},
      "geometry": {{"type": "LineString", "coordinates": [[0, 0], [900, 0]]}}}})",
                       height);
  };
  const std::string word = "a height is true or false, which is read as 1 or 0";
  for (const char* number : {"5", "5.5"})  // GDAL reads both as one column
    expect_in(word, read_layers_of("flags.json", R"({"type": "FeatureCollection", "features": [)" + feature("true") +
                                                     "," + feature(number) + "]}")
                        .warnings);
  EXPECT_EQ(read_layers_of("number.json", feature("5")).warnings.find(word), std::string::npos);
}

TEST(OutlineLayers, ShapefileNeedsNoTable) {
  const std::string file =
      write_layer("ESRI Shapefile", "alone.shp", {{"POLYGON ((0 0,0 900,900 0,0 0))", 9.0}}, wkbPolygon);
  EXPECT_EQ(read_layers(file).walls[0][4], 9.0);
  std::filesystem::remove(in_folder("alone.dbf"));
  EXPECT_EQ(read_layers(file).walls.size(), 3u);
  EXPECT_EQ(read_layers(file).walls[0][4], 3.0);
}

TEST(OutlineLayers, BrokenFilesAreErrors) {
  const std::string file = write_layer("GPKG", "whole.gpkg", {{"LINESTRING (0 0,900 0)", 9.0}}, wkbUnknown);
  std::filesystem::copy_file(file, in_folder("half.gpkg"), std::filesystem::copy_options::overwrite_existing);
  std::filesystem::resize_file(in_folder("half.gpkg"), std::filesystem::file_size(file) / 2);
  expect_in("half.gpkg: ", sf::refusal_of([&] { read_layers(in_folder("half.gpkg")); }));
  for (const char* text : {"{", "{}", "{\"type\": \"Topology\"}", "{\"type\": \"FeatureCollection\"}"})
    expect_in("broken.json: ", sf::refusal_of([&] { read_layers_of("broken.json", text); }));
  expect_in("broken.gpkg: cannot be read as a GeoPackage, shapefile or GeoJSON: no driver of GDAL recognises it",
            sf::refusal_of([&] { read_layers_of("broken.gpkg", std::string("SQLite format 3\0aaaa", 20)); }));
  expect_in("broken.shp: cannot be read as a GeoPackage, shapefile or GeoJSON",
            sf::refusal_of([&] { read_layers_of("broken.shp", std::string("\0\0\x27\x0A\0\0\0\0", 8)); }));
}

TEST(OutlineLayers, FilesDoNotAccessTheNetwork) {
  const LayerRead found =
      read_layers_of("link.json", R"({"type": "FeatureCollection", "crs": {"type": "link", "properties":
      {"href": "http://127.0.0.1:9/system"}}, "features": [{"type": "Feature", "properties": {"height": "7"},
      "geometry": {"type": "LineString", "coordinates": [[0, 0], [900, 0]]}}]})");
  EXPECT_EQ(found.walls[0][4], 7.0);
  expect_in("the file refers to a network location, which is not used", found.warnings);
}

}  // namespace

}  // namespace sf::world
