#include "world/stage/emitter_entities.h"

#include <fmt/format.h>

#include "world/stage/read_keys.h"
#include "world/stage/unit_hints.h"

namespace sf::world {

namespace {

// The beam of a virtual wall reaches 2.4 m (8 feet, from the accessory's specification) and its halo 0.45 m (18
// inches). The width of the beam and all three values of the dock are assumptions.
constexpr Emitter kVirtualWall{.range = 2.4, .fov = 0.4, .halo = 0.45};  // [m], [rad], [m]
constexpr Emitter kDock{.range = 1.8, .fov = 0.7, .halo = 0.6};

constexpr std::size_t kMaxLamps = 1000;        // every light sensor reads every lamp
constexpr std::size_t kMaxHeatSources = 1000;  // every thermometer reads every source
constexpr std::size_t kMaxFiducials = 1000;    // every finder tests every fiducial
constexpr double kMaxFiducialId = 65535.0;

}  // namespace

void add_emitter(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B) {
  StageContext& context = b.context;
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

void add_lamp(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B) {
  StageContext& context = b.context;
  const Property* fov = find(entity, "lamp_fov");
  const Property* property = find(entity, "lamp_intensity");
  if (property == nullptr) {
    if (fov != nullptr) warn(b.context, fov->at, "'lamp_fov' has no effect without 'lamp_intensity'");
    return;
  }
  if (model.mover != kNone) fail(context, property->at, "a lamp cannot move; expected it outside moving models");
  if (b.world.lamps.size() >= kMaxLamps)
    fail(context, property->at, fmt::format("more than {} lamps; expected fewer, brighter ones", kMaxLamps));
  if (fov != nullptr) warn_of_units(b, *fov, property->key);
  Lamp lamp;
  read_keys(context, entity, lamp);
  lamp.model = static_cast<std::uint32_t>(b.world.models.size());
  lamp.X_WL = X_B;
  lamp.X_WL.z += 0.5 * size.z;
  b.world.lamps.push_back(lamp);
}

void add_heat_source(BuildState& b, const Entity& entity, const Model& model, const Pose& X_B) {
  StageContext& context = b.context;
  const Property* radius = find(entity, "heat_radius");
  const Property* property = find(entity, "heat");
  if (property == nullptr) {
    if (radius != nullptr) warn(b.context, radius->at, "'heat_radius' has no effect without 'heat'");
    return;
  }
  if (model.mover != kNone) fail(context, property->at, "a heat source cannot move; expected it outside moving models");
  if (b.world.heat_sources.size() >= kMaxHeatSources)
    fail(context, property->at, fmt::format("more than {} heat sources; expected fewer, larger ones", kMaxHeatSources));
  HeatSource source;
  read_keys(context, entity, source);
  source.model = static_cast<std::uint32_t>(b.world.models.size());
  source.p = {X_B.x, X_B.y};
  b.world.heat_sources.push_back(source);
}

void add_fiducial(BuildState& b, const Entity& entity, const Size& size, const Pose& X_B) {
  StageContext& context = b.context;
  constexpr auto kMaxId = static_cast<std::uint32_t>(kMaxFiducialId);
  const std::uint32_t id = whole(context, entity, "fiducial_return", 0, 0, kMaxId);
  if (id == 0) return;
  if (b.world.fiducials.size() >= kMaxFiducials)
    fail(context, find(entity, "fiducial_return")->at,
         fmt::format("more than {} fiducials; expected fewer", kMaxFiducials));
  Fiducial fiducial;
  read_keys(context, entity, fiducial);
  fiducial.model = static_cast<std::uint32_t>(b.world.models.size());
  fiducial.id = id;
  fiducial.key = whole(context, entity, "fiducial_key", 0, 0, kMaxId);
  fiducial.X_BF = X_B;
  fiducial.X_BF.z += 0.5 * size.z;
  b.world.fiducials.push_back(fiducial);
}

}  // namespace sf::world
