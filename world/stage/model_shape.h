#pragma once
// The body of one model: blocks, a bitmap, a boundary or a box, scaled to the model's size.

#include <map>
#include <memory>
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

/// A bitmap and its outline, traced once for all models that show it.
struct TracedBitmap {
  Bitmap grid;  ///< cells are released after tracing
  std::vector<BoundaryRun> runs;
};
using BitmapCache = std::map<std::string, std::shared_ptr<const TracedBitmap>>;

/// Segments in the body's frame: centred in x and y, z from 0 to size.z. `Segment::model` and the flags keep their
/// defaults.
/// @param is_box whether a model without blocks, bitmap and boundary is a box.
/// @throws base::InputError for a block or bitmap that cannot be read.
std::vector<Segment> shape_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity, const Size& size,
                              bool is_box);

/// [m] larger side of a pixel of the bitmap that `entity` shows on `size`; 0 when it shows none.
double pixel_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity, const Size& size);

/// Segments of a traced grid shown on size.x by size.y, from 0 to size.z.
std::vector<Segment> bitmap_segments(const TracedBitmap& traced, const Size& size);

/// @throws base::InputError when the outline has more than 2 000 000 runs.
std::shared_ptr<const TracedBitmap> trace_bitmap(Bitmap grid, const std::string& file);

/// The `size` property, or the fallback; two numbers keep the fallback's height.
Size size_of(const StageContext& context, const Entity& entity, const Size& fallback);

}  // namespace sf::world
