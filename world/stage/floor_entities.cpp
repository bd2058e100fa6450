#include "world/stage/floor_entities.h"

#include "world/stage/read_keys.h"
#include "world/stage/unit_hints.h"

namespace sf::world {

namespace {

// The beam of a virtual wall reaches 2.4 m (8 feet, from the accessory's specification) and its halo 0.45 m (18
// inches). The width of the beam and all three values of the dock are assumptions.
constexpr Emitter kVirtualWall{.range = 2.4, .fov = 0.4, .halo = 0.45};  // [m], [rad], [m]
constexpr Emitter kDock{.range = 1.8, .fov = 0.7, .halo = 0.6};

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

void add_emitter(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B) {
  const StageContext& context = b.context;
  const Property* property = find(entity, "ir_emitter");
  if (property == nullptr) return;
  if (model.mover != kNone)
    fail(context, property->at, "an infrared emitter cannot move; expected it outside moving models");
  for (const char* key : {"ir_fov", "ir_range"})
    if (const Property* said = find(entity, key); said != nullptr) warn_of_units(b, *said, property->key);
  Emitter emitter = kVirtualWall;
  read_keys(context, entity, emitter);
  if (emitter.kind == Emitter::Kind::dock) read_keys(context, entity, emitter = kDock);
  emitter.model = static_cast<std::uint32_t>(b.world.models.size());
  emitter.X_WE = X_B;
  emitter.X_WE.z += 0.5 * size.z;
  b.world.emitters.push_back(emitter);
}

}  // namespace sf::world
