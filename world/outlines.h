#pragma once
// Files of outlines: the buildings of a city, which are too many for a world file.
//
// A text table has one geometry per row, in any one column, as well-known text or binary (world/well_known_geometry.h),
// and the heights of its walls in a column `height`. Its first line may name the columns. GeoPackage, shapefiles and
// GeoJSON are read through GDAL. Coordinates are planar, in the world file's unit of length.

#include <functional>
#include <span>

#include "world/world.h"

namespace sf::world {

/// Called with the walls of one ring or line, each starting at the end of the previous one; never empty.
using TakeOutline = std::function<void(std::span<const Segment>)>;

/// Calls `take` for all rings and lines in file order, in the world frame. Outer rings are solids, and inner rings are
/// holes in them. Lines are thin walls, and so are rings that cross or touch themselves, as in make_polygon. Tables are
/// read row by row, so memory does not grow with the file. Rows that are unreadable or have no walls are skipped;
/// unreadable heights are replaced by that of the model.
/// @param warnings null, or receives these faults: a few of each kind with line numbers, and the number of the others.
/// Does not add a warning that is already there
/// @throws base::InputError for the first such row if `file.strict`, for a file without walls (lists its columns), for
/// files that are not outlines, and for more than 50 million walls
void read_outlines(const OutlineFile& file, const TakeOutline& take, std::vector<Warning>* warnings = nullptr);

/// Appends the walls of all unread files to `world.walls`, and their warnings.
void read_unread(World& world);

}  // namespace sf::world
