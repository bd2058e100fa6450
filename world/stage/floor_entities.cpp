#include "world/stage/floor_entities.h"

namespace sf::world {

namespace {

bool same(glm::dvec2 p, glm::dvec2 q) { return p.x == q.x && p.y == q.y; }

}  // namespace

bool is_floor_hole(const StageContext& context, const Entity& entity) {
  return flag(context, entity, "cliff_return", false);
}

void add_floor_holes(BuildState& b, const Entity& entity, const Model& model, const std::vector<Segment>& shape,
                     const Pose& X_B) {
  const SourceLocation at = find(entity, "cliff_return")->at;
  if (model.mover != kNone) fail(b.context, at, "a hole in the floor cannot move; expected it outside moving models");
  if (model.is_bitmap || flag(b.context, entity, "boundary", false))
    fail(b.context, at, "'cliff_return' expects blocks or a box, neither a bitmap nor a boundary");
  const auto row = static_cast<std::uint32_t>(b.world.models.size());
  for (std::size_t i = 0; i < shape.size();) {
    FloorHole hole{{}, row};
    const glm::dvec2 first = shape[i].a;
    bool closed = false;
    for (; i < shape.size() && !closed; ++i) {
      if (!shape[i].solid_left)
        fail(b.context, at, "'cliff_return' expects outlines of at least three corners that do not cross themselves");
      hole.outline.push_back(transform(X_B, shape[i].a));
      closed = same(shape[i].b, first);
    }
    b.world.floor_holes.push_back(std::move(hole));
  }
}

}  // namespace sf::world
