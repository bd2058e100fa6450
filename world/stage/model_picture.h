#pragma once
// Pictures as bodies: floor plans of Stage worlds, and ROS maps.

#include <map>
#include <string>
#include <vector>

#include "world/bitmap.h"
#include "world/stage/properties.h"

namespace sf::world {

struct Size {
  double x = 0.1;
  double y = 0.1;
  double z = 0.1;  ///< [m] each, in [0, 1e7]
};

/// A bitmap and its outline, traced once for all models that use it.
struct TracedBitmap {
  Bitmap grid;  ///< cells are released after tracing
  std::vector<BoundaryRun> runs;
  PicturePart solid;       ///< all solid cells; the whole grid if there are none
  std::size_t hidden = 0;  ///< number of dark pixels that are transparent
};
using BitmapCache = std::map<std::string, TracedBitmap>;

/// @throws base::InputError if the outline has more than 2 000 000 runs
TracedBitmap trace_bitmap(Bitmap grid, const std::string& file);

PicturePart whole_of(const Bitmap& grid);

/// Returns the segments of a traced grid whose `part` is shown on size.x by size.y, from 0 to size.z.
std::vector<Segment> bitmap_segments(const TracedBitmap& traced, const PicturePart& part, const Size& size);

/// Returns the picture that `bitmap` of `entity` refers to. @throws base::InputError if it cannot be read or traced
const TracedBitmap& bitmap_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity);

/// Returns the part of the picture that is shown on `size`: the solid part, as in Stage; with `old_shapes`, the whole
/// picture.
PicturePart part_of(const StageContext& context, const TracedBitmap& plan);

/// Warns if the picture is read differently than in Stage, or than in versions up to 0.2.
void warn_of_picture(StageContext& context, const Entity& entity, const TracedBitmap& plan, const Size& size);

/// [m] Returns the larger side of a pixel of the bitmap that `entity` shows on `size`; 0 if it shows none.
double pixel_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity, const Size& size);

}  // namespace sf::world
