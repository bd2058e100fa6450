#pragma once
// The body of one model: blocks, a bitmap, a boundary or a box, scaled to the model's size.

#include <vector>

#include "world/stage/model_picture.h"
#include "world/stage/properties.h"

namespace sf::world {

inline constexpr double kMaxSegments = 2e6;  ///< of one world file

/// Returns segments in the body frame: centred in x and y, z from 0 to size.z. `Segment::model` and the flags keep
/// their defaults.
/// @param is_box whether a model without blocks, bitmap and boundary is a box
/// @throws base::InputError for a block or bitmap that cannot be read
std::vector<Segment> shape_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity, const Size& size,
                              bool is_box);

/// Reads the `size` property, or returns the fallback. Two numbers keep the fallback's height.
Size size_of(StageContext& context, const Entity& entity, const Size& fallback);

}  // namespace sf::world
