#include "world/stage/build_state.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/suggest.h"
#include "world/keys.h"
#include "world/meshes/mesh_file.h"
#include "world/shapes.h"
#include "world/stage/attached_devices.h"
#include "world/stage/ctrl.h"
#include "world/stage/emitter_entities.h"
#include "world/stage/entity_color.h"
#include "world/stage/floor_entities.h"
#include "world/stage/light_entities.h"
#include "world/stage/mesh_entities.h"
#include "world/stage/mover_entities.h"
#include "world/stage/outline_entities.h"
#include "world/stage/read_keys.h"
#include "world/stage/road_entities.h"
#include "world/stage/shape_entities.h"
#include "world/stage/terrain_entity.h"

namespace sf::world {

namespace {

constexpr std::size_t kMaxSuggestions = 1'000;
constexpr double kMaxModels = 500'000;
constexpr std::uint32_t kStageRed = 0xFFFF0000u;  // colour of a model without one

// --- Words

KeyScope key_scope(EntityKind kind) {
  switch (kind) {
    case EntityKind::model:
      return KeyScope::model;
    case EntityKind::position:
      return KeyScope::position;
    case EntityKind::light:
      return KeyScope::light;
    default:
      return KeyScope::unmodelled;
  }
}

// Suggests only while there are few unknown types: a file with many of them does not contain spelling mistakes.
std::string suggested(const BuildState& b, const std::string& type) {
  constexpr std::size_t kMaxSlips = 100;
  return b.warned_types.size() > kMaxSlips ? "" : base::suggest(type, b.types);
}

// Types without a model become plain bodies. They are counted, and mentioned once per type.
void count_unmodelled(BuildState& b, const Entity& entity, const std::string& type, bool is_known) {
  ++b.world.unmodelled[type];
  if (!b.warned_types.insert(type).second) return;
  warn(b.context, entity.at,
       is_known ? fmt::format("'{}' is not modelled: kept as a body that does nothing", type)
                : fmt::format("unknown type '{}' is kept as a body that does nothing{}", type, suggested(b, type)));
}

// --- Names

std::string unique_name(BuildState& b, const Entity& entity, const std::string& wanted) {
  charge(b.context, entity.at, b.context.usage.name_bytes, static_cast<double>(wanted.size()), 1e8,
         "bytes of models' names", "give shorter names, or nest less");
  std::string name = free_name(b, wanted);
  if (name != wanted) warn(b.context, entity.at, fmt::format("a second model named '{}' is called '{}'", wanted, name));
  return name;
}

// Names are "parent.child" within a parent. A leading / marks a name in the scope of the whole world.
std::string own_name(BuildState& b, const Entity& entity, Parent& parent) {
  const std::string given = text(b.context, entity, "name", "");
  return given.empty() ? fmt::format("{}:{}", entity.word, parent.unnamed[entity.word]++) : given;
}

std::string joined(const std::string& parent, const std::string& name) {
  if (name.size() > 1 && name.front() == '/') return name.substr(1);
  return parent.empty() ? name : parent + "." + name;
}

// --- Models

Size default_size(const Entity& entity) {
  if (entity.type == "light") return {0.12, 0.12, 0.6};
  return entity.type == "laser" ? Size{0.15, 0.15, 0.2} : Size{};
}

/// Returns the model and flags of a body's surface.
Segment surface_of(BuildState& b, const Entity& entity, const Model& model) {
  StageContext& context = b.context;
  Segment surface;
  surface.model = static_cast<std::uint32_t>(b.world.models.size());
  read_keys(context, entity, surface);
  surface.seen_by_laser =
      number(context, entity, "laser_return", 1.0) != 0.0 && number(context, entity, "ranger_return", 1.0) >= 0.0;
  if (!model.is_bitmap || surface.stops_robots || context.obstacles.applies) return surface;
  surface.stops_robots = true;
  if (!context.obstacles.stated)
    warn_once(context, location_of(entity, "obstacle_return"),
              "floor plans stop robots, also with 'obstacle_return 0'; in Stage robots drive through this one: "
              "--stage-obstacles or the world key stage_obstacles 1 allows that, stage_obstacles 0 confirms that it "
              "stops them");
  return surface;
}

/// @param X_B the body frame, in the mover's frame for a mover's body, else in the world
void add_body(BuildState& b, const Entity& entity, const Model& model, const std::vector<Segment>& shape,
              const Pose& X_B) {
  const Segment surface = surface_of(b, entity, model);
  place_outline(shape, X_B, surface, model.mover == kNone ? b.world.walls : b.world.movers[model.mover].body);
}

/// Properties of a model as written, before anything is derived from them.
struct ModelProperties {
  EntityKind kind = EntityKind::model;
  const SensorKeyword* sensor = nullptr;  ///< the sensor type of the model; null: no sensor
  std::string name;                       ///< as written, or generated
  Pose X_PB;                              ///< default: on top of the parent
  Size size;
  std::optional<std::uint32_t> mesh;  ///< row in `World::meshes`
};

/// Refuses to mount a sensor in six degrees of freedom that measures in the plane.
/// @param keys of the sensor or of its block
void refuse_pose6(BuildState& b, const Entity& entity, std::span<const std::string_view> keys) {
  constexpr std::string_view kKey = "pose6";
  const Property* const property = find(entity, kKey);
  const auto takes = [&](std::span<const std::string_view> own) { return std::ranges::find(own, kKey) != own.end(); };
  if (property == nullptr || takes(keys)) return;
  std::vector<std::string> words;
  for (const SensorKeyword& word : b.options.sensors) {
    if (takes(word.keys)) words.emplace_back(word.type);
    if (takes(word.block_keys)) words.push_back(fmt::format("sensor of {}", word.type));
  }
  fail(b.context, property->at,
       fmt::format("'{}' stays level and has no 'pose6'; expected 'pose [x y z yaw]'. 'pose6' mounts {}", entity.word,
                   fmt::join(words, ", ")));
}

ModelProperties read_model_properties(BuildState& b, const Entity& entity, Parent& parent) {
  ModelProperties said;
  said.kind = entity_kind(entity.type);
  said.name = own_name(b, entity, parent);
  said.X_PB = pose(b.context, entity, "pose");
  said.X_PB.z += parent.lift;
  if (parent.model == kNone) said.X_PB.z += terrain_height(b.world, {said.X_PB.x, said.X_PB.y});
  said.size = size_of(b.context, entity, default_size(entity));
  said.mesh = mesh_of(b, entity, said.size);

  // A laser named like a lane edge sensor measures the edge of the lane instead of ranges.
  const bool is_lane_edge = entity.type == "laser" && (said.name == "laneedge" || said.name == "/laneedge");
  const std::string type = is_lane_edge ? "laneedge" : entity.type;
  said.sensor = type == "derived" ? derived_keyword(b, entity) : find_sensor_keyword(b, type);
  if (said.sensor != nullptr) {
    refuse_pose6(b, entity, said.sensor->keys);
    check_keys(b.context, entity, KeyScope::device, said.sensor->keys);
    return said;
  }
  const bool moves = said.kind == EntityKind::model && names_model_controller(b, entity);
  check_keys(b.context, entity, moves ? KeyScope::position : key_scope(said.kind));
  if (said.kind == EntityKind::unmodelled || said.kind == EntityKind::unknown)
    count_unmodelled(b, entity, type, said.kind == EntityKind::unmodelled);
  return said;
}

std::vector<Segment> outline_of_mesh(BuildState& b, const Entity& entity, std::uint32_t mesh) {
  const auto [found, is_new] = b.mesh_outlines.try_emplace(mesh);
  if (is_new) found->second = outline_from_above(b.world.meshes[mesh].vertices);
  const std::vector<Segment>& outline = found->second;
  charge(b.context, entity.at, b.context.usage.segments, static_cast<double>(outline.size()), kMaxSegments, "segments",
         "leave out models, or give them a 'block'");
  return outline;
}

std::vector<Segment> shape_of_model(BuildState& b, const Entity& entity, const ModelProperties& said) {
  const bool is_light = said.kind == EntityKind::light;
  const bool is_box = !is_light && !has_no_body(entity.type) && (said.sensor == nullptr || entity.type == "laser") &&
                      find(entity, "outlines") == nullptr && !said.mesh;
  std::vector<Segment> shape = shape_of(b.context, b.bitmaps, entity, said.size, is_box);
  if (said.mesh && shape.empty() && !flag(b.context, entity, "noblocks", false))
    return outline_of_mesh(b, entity, *said.mesh);
  if (is_light && shape.empty() && !flag(b.context, entity, "noblocks", false))
    return light_shape(said.size, number(b.context, entity, "lamps", 3.0) == 1.0);
  return shape;
}

Model model_of(BuildState& b, const Entity& entity, const Parent& parent, const ModelProperties& said) {
  Model model;
  model.name = unique_name(b, entity, joined(parent.name, said.name));
  model.type = entity.word;
  model.parent = parent.model;
  model.mover = parent.mover;
  model.X_WM = compose(parent.X_WP, said.X_PB);
  model.size = {said.size.x, said.size.y};
  model.color = entity_color(b.context, entity, "color", kStageRed, static_cast<std::uint32_t>(b.world.models.size()));
  model.is_bitmap = find(entity, "bitmap") != nullptr;
  model.pixel = pixel_of(b.context, b.bitmaps, entity, said.size);
  return model;
}

void read_reflectance(BuildState& b, const Entity& entity) {
  if (find(entity, "reflectance") == nullptr) return;
  const double value = number(b.context, entity, "reflectance", kDefaultReflectance);
  if (!(value >= 0.0 && value <= 100.0))
    fail(b.context, location_of(entity, "reflectance"),
         fmt::format("'reflectance' is {:g}; expected 0 to 1 for diffuse surfaces, up to 100 for retroreflectors",
                     value));
  b.world.reflectances.push_back({static_cast<std::uint32_t>(b.world.models.size()), value});
}

// Returns true if the model becomes a mover: a robot or a linked object. A model carried by a mover belongs to that
// mover, whatever its type or name.
bool becomes_mover(BuildState& b, const Entity& entity, const Parent& parent, const ModelProperties& said) {
  const bool controlled = said.kind != EntityKind::position && names_model_controller(b, entity);
  const bool random = is_random(entity);
  if (said.kind != EntityKind::position && !packet_id_of(said.name) && !controlled && !random) return false;
  if (parent.mover == kNone) return true;
  if (random)
    fail(b.context, entity.at,
         fmt::format("'{}' is mounted on '{}', which moves it; expected 'random_pose', 'random_present' and "
                     "'random_size' in a model that stands free, or is on a static one",
                     said.name, parent.name));
  if (controlled)
    fail(
        b.context, location_of(entity, "ctrl"),
        fmt::format("'{}' is mounted on '{}', which moves it, so it can have no controller; expected 'ctrl' in a model "
                    "that stands free, or is on a static one",
                    said.name, parent.name));
  warn(b.context, entity.at, fmt::format("'{}' is mounted on '{}' and moves with it", said.name, parent.name));
  return false;
}

void add_model(BuildState& b, const Entity& entity, Parent& parent) {
  charge(b.context, entity.at, b.context.usage.models, 1.0, kMaxModels, "models", "leave some out");
  const ModelProperties said = read_model_properties(b, entity, parent);
  Model model = model_of(b, entity, parent, said);

  Parent own;  // for the children of this model
  own.X_MP = compose(parent.X_MP, said.X_PB);
  own.name_in_mover = parent.mover == kNone ? "" : joined(parent.name_in_mover, said.name);
  const bool moves = becomes_mover(b, entity, parent, said);
  const std::optional<PacketId> packet_id = packet_id_of(said.name);
  const Pose X_MT = tag_pose_of(b.context, entity, moves && packet_id && packet_id->is_tag);
  if (moves) {
    const bool is_tag = packet_id ? packet_id->is_tag : said.kind != EntityKind::position;
    model.mover = add_mover(b, entity, model, {said.size.x, said.size.y, said.size.z}, packet_id, is_tag);
    read_ctrl(b, entity, b.world.movers[model.mover]);
    b.world.movers[model.mover].X_MT = X_MT;
    own.X_MP = {};
  } else {
    warn_of_ctrl(b, entity, said.name);
  }

  const Pose X_B = compose(model.mover == kNone ? model.X_WM : own.X_MP, pose(b.context, entity, "origin"));
  if (moves) b.world.movers[model.mover].X_MB = X_B;
  const std::vector<Segment> shape = shape_of_model(b, entity, said);
  is_floor_hole(b.context, entity) ? add_floor_holes(b, entity, model, shape, X_B)
                                   : add_body(b, entity, model, shape, X_B);
  if (said.mesh && !is_floor_hole(b.context, entity)) add_mesh(b, *said.mesh, surface_of(b, entity, model), X_B);
  if (find(entity, "outlines") != nullptr)
    add_outlines(b, entity, model, surface_of(b, entity, model), said.size.z, X_B);
  read_reflectance(b, entity);
  add_magnet(b, entity, model, said.size, X_B);
  add_emitter(b, entity, model, said.size, X_B);
  add_lamp(b, entity, model, said.size, X_B);
  add_heat_source(b, entity, model, X_B);
  add_fiducial(b, entity, said.size, X_B);
  if (said.kind == EntityKind::light) add_light(b, entity, model);
  if (said.sensor != nullptr) add_sensors(b, entity, model, *said.sensor, X_B, said.size.z, own.name_in_mover);

  own.model = static_cast<std::uint32_t>(b.world.models.size());
  own.mover = model.mover;
  own.X_WP = model.X_WM;
  own.lift = flag(b.context, entity, "stack_children", true) ? said.size.z : 0.0;
  own.name = model.name;
  own.sensor = said.sensor;
  b.world.models.push_back(std::move(model));
  add_children(b, entity, own);
}

// Warns, once per key, about keys that have an effect in Stage but not here.
void warn_of_effect(StageContext& context, const Property& property) {
  const std::string_view effect = unmodelled_effect(property.key);
  if (effect.empty()) return;
  const auto matters = [](const Value& value) { return value.is_text ? value.text == "odom" : value.number != 0.0; };
  if (std::none_of(property.values.begin(), property.values.end(), matters)) return;
  warn_once(context, property.at, effect);
}

}  // namespace

std::string free_name(BuildState& b, const std::string& wanted) {
  if (b.names.insert(wanted).second) return wanted;
  for (int& k = b.copies.try_emplace(wanted, 1).first->second;;) {
    std::string name = fmt::format("{}#{}", wanted, ++k);
    if (b.names.insert(name).second) return name;
  }
}

void check_keys(StageContext& context, const Entity& entity, KeyScope where, std::span<const std::string_view> own) {
  if (where == KeyScope::unmodelled) return;
  for (const Property& property : entity.properties) {
    warn_of_effect(context, property);
    if (is_known_key(where, property.key, own)) continue;
    if (context.warnings.size() > kMaxSuggestions) {
      warn(context, property.at, fmt::format("unknown property '{}' of '{}' is ignored", property.key, entity.word));
      continue;
    }
    warn(context, property.at,
         fmt::format("unknown property '{}' of '{}' is ignored{}", property.key, entity.word,
                     suggest_key(where, property.key, own)));
  }
}

void add_children(BuildState& b, const Entity& entity, Parent& parent) {
  for (const Entity& child : entity.children) {
    if (entity_kind(child.type) == EntityKind::ignored) continue;
    if (child.type == "block" && parent.model != kNone) {
      check_keys(b.context, child, KeyScope::block);
    } else if (child.type == "sensor" && parent.sensor != nullptr && !parent.sensor->block_keys.empty()) {
      refuse_pose6(b, child, parent.sensor->block_keys);
      check_keys(b.context, child, KeyScope::sensor, parent.sensor->block_keys);
    } else if (child.type == "block" || child.type == "sensor") {
      const char* home = child.type == "block" ? "a model" : "a ranger";
      warn(b.context, child.at, fmt::format("'{}' is ignored here; expected it inside {}", child.word, home));
    } else if (entity_kind(child.type) == EntityKind::road || entity_kind(child.type) == EntityKind::path) {
      if (parent.model != kNone)
        fail(b.context, child.at, fmt::format("'{}' is part of a model; expected it at the top level", child.word));
      entity_kind(child.type) == EntityKind::road ? add_road(b, child) : add_path(b, child);
    } else if (entity_kind(child.type) == EntityKind::terrain) {
      if (parent.model != kNone)
        fail(b.context, child.at, "'terrain' is part of a model; expected it at the top level");
    } else if (entity_kind(child.type) == EntityKind::shape) {
      if (parent.model != kNone)
        fail(b.context, child.at, fmt::format("'{}' is part of a model; expected it at the top level", child.word));
      add_shape(b, child);
    } else {
      add_model(b, child, parent);
    }
  }
}

}  // namespace sf::world
