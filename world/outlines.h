#pragma once
// Files of outlines: the buildings of a city, too many for a world file.
//
// A table in text has a geometry a row in one of its columns, whichever that is, in well-known text or binary
// (world/well_known_geometry.h), and the heights of its walls in a column `height`; its first line may name the
// columns. GeoPackage, shapefiles and GeoJSON are read through GDAL. Coordinates are plane, in the unit of
// length of the world file.

#include <functional>
#include <span>

#include "world/world.h"

namespace sf::world {

/// Called with the walls of one ring or line, each beginning at the end of the previous one; never empty.
using TakeOutline = std::function<void(std::span<const Segment>)>;

/// Calls `take` for all rings and lines in the order of the file, in the world frame. Outer rings are solids and inner
/// rings holes in them; lines are thin walls, and so are rings that cross or touch themselves, as in make_polygon.
/// Tables are read a row at a time: memory does not grow with the file. A row that cannot be read, or has no walls, is
/// left out; a height that cannot be read is that of the model.
/// @param warnings null, or gets those faults: a few of each kind with their lines, the number of the others, and none
/// that it has already
/// @throws base::InputError for the first such row where `file.strict`, for a file without any wall, naming its
/// columns, for files that are no outlines, and for more than 50 million walls
void read_outlines(const OutlineFile& file, const TakeOutline& take, std::vector<Warning>* warnings = nullptr);

/// Appends the walls of all unread files to `world.walls`, and their warnings.
void read_unread(World& world);

}  // namespace sf::world
