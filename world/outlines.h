#pragma once
// Files of outlines in well-known text: the buildings of a city, too many for a world file.
//
// Each line is a geometry of OGC 06-103r4 (Simple Features), section 7: POLYGON or MULTIPOLYGON, whose outer rings are
// solids and whose inner rings are holes in them, LINESTRING or MULTILINESTRING, thin walls. Or the file is a table as
// GDAL writes it (`ogr2ogr -f CSV -lco GEOMETRY=AS_WKT`): its first line names the columns, `WKT` the first one; a
// column `height` has the heights of the walls. Coordinates are plane, in the unit of length of the world file.

#include <functional>
#include <span>

#include "world/world.h"

namespace sf::world {

/// Called with the walls of one ring or line, each beginning at the end of the previous one; never empty.
using TakeOutline = std::function<void(std::span<const Segment>)>;

/// Calls `take` for all rings and lines in the order of the file, in the world frame. The file is read a line at a
/// time: memory does not grow with it. Rings that cross or touch themselves are thin walls, as in make_polygon.
/// @throws base::InputError with file and line for what is no geometry, and beyond the bounds in outlines.cpp
void read_outlines(const OutlineFile& file, const TakeOutline& take);

/// Appends the walls of all unread files to `world.walls`.
void read_unread(World& world);

}  // namespace sf::world
