#pragma once
// The body of one model: blocks, a bitmap, a boundary or a box, scaled to the model's size.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "world/bitmap.h"
#include "world/properties.h"

namespace sf::world {

struct Size {
  double x = 0.1;
  double y = 0.1;
  double z = 0.1;  ///< [m] each, in [0, 1e7]
};

/// A bitmap and its outline, traced once however many models show it.
struct Traced {
  Grid grid;  ///< its cells are dropped after tracing
  std::vector<Run> runs;
};
using Bitmaps = std::map<std::string, std::shared_ptr<const Traced>>;

/// Segments in the body's own frame: centred in x and y, z from 0 to size.z. `Segment::model` and the flags are left
/// alone.
/// @param is_box whether a model without blocks, bitmap and boundary is a box.
/// @throws base::InputError for a block or bitmap that cannot be read.
std::vector<Segment> shape_of(Source& source, Bitmaps& bitmaps, const Entity& entity, const Size& size, bool is_box);

/// [m] larger side of a pixel of the bitmap that `entity` shows on `size`; 0 when it shows none.
double pixel_of(Source& source, Bitmaps& bitmaps, const Entity& entity, const Size& size);

/// Segments of a traced grid shown on size.x by size.y, from 0 to size.z.
std::vector<Segment> bitmap_segments(const Traced& traced, const Size& size);

/// @throws base::InputError when the outline is absurd (more than 2 000 000 runs).
std::shared_ptr<const Traced> trace(Grid grid, const std::string& file);

/// The `size` property, or the fallback; two numbers keep the fallback's height.
Size size_of(const Source& source, const Entity& entity, const Size& fallback);

}  // namespace sf::world
