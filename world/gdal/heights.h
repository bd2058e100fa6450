#pragma once
// Reads height maps from GeoTIFF, in the GDAL plug-in.

#include "world/gdal/guard.h"
#include "world/outline_rows.h"
#include "world/terrain.h"

namespace sf::world {

/// As GdalPlugin::read_heights.
HeightMap read_heights_by_gdal(const std::string& file, HeightMapSizeRule require_size);

}  // namespace sf::world
