#include "world/stage/outline_entities.h"

#include <fmt/format.h>

#include <algorithm>

#include "world/stage/floor_entities.h"

namespace sf::world {

void add_outlines(BuildState& b, const Entity& entity, const Model& model, Segment surface, double height,
                  const Pose& X_B) {
  const SourceLocation at = location_of(entity, "outlines");
  if (model.mover != kNone) fail(b.context, at, "'outlines' are for static models; give robots and tags a 'block'");
  const bool has_blocks =
      find(entity, "blocks") != nullptr || std::any_of(entity.children.begin(), entity.children.end(),
                                                       [](const Entity& child) { return child.type == "block"; });
  if (has_blocks || find(entity, "bitmap") != nullptr || flag(b.context, entity, "boundary", false) ||
      is_floor_hole(b.context, entity))
    fail(b.context, at, "'outlines' are the whole body of a model; write blocks, bitmaps and holes as another model");
  const std::string file = file_of(b.context, entity, "outlines");
  if (find(entity, "size") == nullptr)
    warn(b.context, at,
         fmt::format("'{}' has outlines but no 'size': walls without a height of their own are {:g} m high; write size "
                     "[0 0 HEIGHT]",
                     entity.word, height));
  surface.z_max = height;
  b.world.unread.push_back({.file = file,
                            .X_WF = X_B,
                            .metres_per_unit = b.context.metres_per_unit,
                            .surface = surface,
                            .strict = b.options.strict});
}

}  // namespace sf::world
