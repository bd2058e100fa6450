#include "world/stage/shape_entities.h"

#include <fmt/format.h>

#include <algorithm>

#include "world/shapes.h"
#include "world/stage/entity_color.h"
#include "world/stage/model_picture.h"
#include "world/stage/model_shape.h"

namespace sf::world {

namespace {

std::string name_of_shape(const BuildState& b, const Entity& entity) {
  std::string name = text(b.context, entity, "name", "");
  const SourceLocation at = location_of(entity, "name");
  if (name.empty()) fail(b.context, at, "'shape' has no name; expected name \"...\" in it");
  if (name == kOriginalShape)
    fail(b.context, at, fmt::format("'{}' is each object's own shape; expected another name", name));
  if (!base::is_shape_name(name))
    fail(b.context, at,
         fmt::format("'{}' is no name of a shape; expected 1 to {} ASCII letters, digits, '_', '-' or '.'", name,
                     base::kMostShapeName));
  if (std::ranges::find(b.world.shapes, name, &Shape::name) != b.world.shapes.end())
    fail(b.context, at, fmt::format("a second shape is named '{}'; expected another name", name));
  if (b.world.shapes.size() >= kMostShapes)
    fail(b.context, at, fmt::format("more than {} shapes; expected fewer", kMostShapes));
  return name;
}

}  // namespace

void add_shape(BuildState& b, const Entity& entity) {
  check_keys(b.context, entity, KeyScope::shape);
  Shape shape;
  shape.name = name_of_shape(b, entity);
  const Size size = size_of(b.context, entity, {});
  shape.size = {size.x, size.y, size.z};
  if (!base::is_shape_length(size.x) || !base::is_shape_length(size.y) || !base::is_shape_length(size.z))
    fail(b.context, location_of(entity, "size"),
         fmt::format("shape '{}' has the size {:g} x {:g} x {:g} m; expected each in (0, {:g}]", shape.name, size.x,
                     size.y, size.z, base::kMostShapeSize));
  shape.color = entity_color(b.context, entity, "color", 0, static_cast<std::uint32_t>(b.world.shapes.size()));
  shape.is_bitmap = find(entity, "bitmap") != nullptr;
  shape.pixel = pixel_of(b.context, b.bitmaps, entity, size);
  shape.outline = shape_of(b.context, b.bitmaps, entity, size, true);
  if (shape.outline.empty() || shape.outline.size() > kMostShapeSides)
    fail(b.context, entity.at,
         fmt::format("shape '{}' has an outline of {} sides; expected 1 to {}", shape.name, shape.outline.size(),
                     kMostShapeSides));
  for (const Entity& child : entity.children) {
    if (child.type != "block")
      fail(b.context, child.at, fmt::format("'{}' is not part of a shape; expected blocks only", child.word));
    check_keys(b.context, child, KeyScope::block);
  }
  b.world.shapes.push_back(std::move(shape));
}

}  // namespace sf::world
