#include "world/building.h"

#include <fmt/format.h>

#include <algorithm>

#include "world/devices.h"
#include "world/floor.h"
#include "world/keys.h"
#include "world/lasers.h"
#include "world/light_plan.h"
#include "world/movers.h"
#include "world/paint.h"
#include "world/road.h"

namespace sf::world {

namespace {

constexpr std::size_t kMostSuggestions = 1'000;
constexpr double kMostModels = 500'000;
constexpr double kMostBeams = 1e7;                // of all lasers
constexpr std::uint32_t kStageRed = 0xFFFF0000u;  // of a model without a colour

// --- Words
// --------------------------------------------------------------------------------------------------------------

Where where_of(Kind kind) {
  switch (kind) {
    case Kind::model:
      return Where::model;
    case Kind::position:
      return Where::position;
    case Kind::laser:
      return Where::laser;
    case Kind::ranger:
      return Where::ranger;
    case Kind::light:
      return Where::light;
    default:
      return Where::kept;
  }
}

// A slip has few neighbours to be meant; of many unknown words none is one.
std::string suggested(const Building& b, const std::string& type) {
  constexpr std::size_t kMostSlips = 100;
  return b.told.size() > kMostSlips ? "" : suggest(type, b.types);
}

// A type that we do not model is a body all the same, counted and mentioned once.
void keep(Building& b, const Entity& entity, const std::string& type, bool is_known) {
  ++b.world.kept[type];
  if (!b.told.insert(type).second) return;
  const std::string what = is_known ? fmt::format("'{}' is not modelled", type)
                                    : fmt::format("unknown type '{}'{}", type, suggested(b, type));
  warn(b.source, entity.at, what + (is_known ? ": " : " ") + "kept as a body that does nothing");
}

// --- Names
// --------------------------------------------------------------------------------------------------------------

std::string unique_name(Building& b, const Entity& entity, const std::string& wanted) {
  spend(b.source, entity.at, b.source.spent.name_bytes, static_cast<double>(wanted.size()), 1e8,
        "bytes of models' names", "give shorter names, or nest less");
  std::string name = free_name(b, wanted);
  if (name != wanted) warn(b.source, entity.at, fmt::format("a second model named '{}' is called '{}'", wanted, name));
  return name;
}

// "parent.child" within a parent; a leading / says that the name is meant for the whole world.
std::string own_name(Building& b, const Entity& entity, Parent& parent) {
  const std::string given = text(b.source, entity, "name", "");
  return given.empty() ? fmt::format("{}:{}", entity.word, parent.unnamed[entity.word]++) : given;
}

std::string joined(const std::string& parent, const std::string& name) {
  if (name.size() > 1 && name.front() == '/') return name.substr(1);
  return parent.empty() ? name : parent + "." + name;
}

// --- Models
// -------------------------------------------------------------------------------------------------------------

Size default_size(Kind kind) {
  if (kind == Kind::light) return {0.12, 0.12, 0.6};
  return kind == Kind::laser ? Size{0.15, 0.15, 0.2} : Size{};
}

Segment placed(const Segment& local, const Pose& X) {
  Segment segment = local;
  segment.a = transform(X, local.a);
  segment.b = transform(X, local.b);
  segment.z_min += X.z;
  segment.z_max += X.z;
  return segment;
}

/// @param X_B the body frame, in the mover's frame for a mover's body, else in the world.
void add_body(Building& b, const Entity& entity, const Model& model, const std::vector<Segment>& shape,
              const Pose& X_B) {
  const Source& source = b.source;
  const bool seen =
      number(source, entity, "laser_return", 1.0) != 0.0 && number(source, entity, "ranger_return", 1.0) >= 0.0;
  const bool is_plan = model.is_bitmap && !b.options.stage_obstacles;
  const bool seen_as_paint = flag(source, entity, "laneedge_return", true);
  const bool stops = is_plan || flag(source, entity, "obstacle_return", true);
  auto& segments = model.mover == kNone ? b.world.walls : b.world.movers[model.mover].body;
  for (const Segment& local : shape) {
    Segment segment = placed(local, X_B);
    const bool lost_in_rounding = segment.a.x == segment.b.x && segment.a.y == segment.b.y;
    if (lost_in_rounding) continue;
    segment.model = static_cast<std::uint32_t>(b.world.models.size());
    segment.seen_by_laser = seen;
    segment.stops_robots = stops;
    segment.seen_by_laneedge = seen_as_paint;
    segments.push_back(segment);
  }
}

void add_lasers(Building& b, const Entity& entity, const Model& model, const Pose& X_MB, double height,
                const std::string& name) {
  if (model.mover == kNone) {
    warn(b.source, entity.at,
         fmt::format("'{}' is carried by no robot: kept as a body that measures nothing", entity.word));
    return;
  }
  auto& lasers = b.world.movers[model.mover].lasers;
  auto added = lasers_of(b.source, b.options, entity, X_MB, height, name);
  for (const Laser& laser : added)
    spend(b.source, place_of(entity, "samples"), b.source.spent.beams, laser.samples, kMostBeams, "beams of lasers",
          "give fewer 'samples'");
  std::move(added.begin(), added.end(), std::back_inserter(lasers));
}

/// What the file says of a model before anything is derived from it.
struct Said {
  Kind kind = Kind::model;
  bool is_lane_edge = false;           ///< a laser of that name measures the edge of the lane, no ranges
  const SensorWord* sensor = nullptr;  ///< the kind that measures with it; null: none, or one that is read here
  std::string name;                    ///< as written, or made up
  Pose X_PB;                           ///< children stand on top of their parent, unless it says otherwise
  Size size;
};

Said read_said(Building& b, const Entity& entity, Parent& parent) {
  Said said;
  said.kind = kind_of(entity.type);
  said.name = own_name(b, entity, parent);
  said.is_lane_edge = said.kind == Kind::laser && (said.name == "laneedge" || said.name == "/laneedge");
  said.X_PB = pose(b.source, entity, "pose");
  said.X_PB.z += parent.lift;
  said.size = size_of(b.source, entity, default_size(said.kind));

  said.sensor = sensor_word(b, said.is_lane_edge ? "laneedge" : entity.type);
  if (said.sensor != nullptr) {
    check_keys(b.source, entity, Where::device, said.sensor->keys);
    return said;
  }
  check_keys(b.source, entity, where_of(said.kind));
  if (said.is_lane_edge) keep(b, entity, "laneedge", true);
  if (said.kind == Kind::kept || said.kind == Kind::unknown) keep(b, entity, entity.type, said.kind == Kind::kept);
  return said;
}

std::vector<Segment> shape_of_model(Building& b, const Entity& entity, const Said& said) {
  const bool is_light = said.kind == Kind::light;
  const bool is_box = !is_light && !bodiless(entity.type) && (said.sensor == nullptr || said.kind == Kind::laser);
  std::vector<Segment> shape = shape_of(b.source, b.bitmaps, entity, said.size, is_box);
  if (is_light && shape.empty() && !flag(b.source, entity, "noblocks", false))
    return light_shape(said.size, number(b.source, entity, "lamps", 3.0) == 1.0);
  return shape;
}

Model model_of(Building& b, const Entity& entity, const Parent& parent, const Said& said) {
  Model model;
  model.name = unique_name(b, entity, joined(parent.name, said.name));
  model.type = entity.word;
  model.parent = parent.model;
  model.mover = parent.mover;
  model.X_WM = compose(parent.X_WP, said.X_PB);
  model.size = {said.size.x, said.size.y};
  model.color = paint(b.source, entity, "color", kStageRed, static_cast<std::uint32_t>(b.world.models.size()));
  model.is_bitmap = find(entity, "bitmap") != nullptr;
  model.pixel = pixel_of(b.source, b.bitmaps, entity, said.size);
  return model;
}

// A robot or a linked object becomes a mover; what a mover carries belongs to it, whatever its type or name.
bool becomes_mover(Building& b, const Entity& entity, const Parent& parent, const Said& said) {
  if (said.kind != Kind::position && !link_of(said.name)) return false;
  if (parent.mover == kNone) return true;
  warn(b.source, entity.at, fmt::format("'{}' is carried by '{}' and moves with it", said.name, parent.name));
  return false;
}

void add_model(Building& b, const Entity& entity, Parent& parent) {
  spend(b.source, entity.at, b.source.spent.models, 1.0, kMostModels, "models", "leave some out");
  const Said said = read_said(b, entity, parent);
  Model model = model_of(b, entity, parent, said);

  Parent own;  // of the model's own children
  own.X_MP = compose(parent.X_MP, said.X_PB);
  own.name_in_mover = parent.mover == kNone ? "" : joined(parent.name_in_mover, said.name);
  const std::string controller = controller_of(b, entity);
  const bool moves = becomes_mover(b, entity, parent, said);
  const std::optional<Link> link = link_of(said.name);
  const Pose X_MT = tag_pose_of(b.source, entity, moves && link && link->is_tag);
  if (moves) {
    model.mover = add_mover(b, entity, model, link);
    b.world.movers[model.mover].controller = controller;
    b.world.movers[model.mover].X_MT = X_MT;
    own.X_MP = {};
  } else if (!controller.empty()) {
    warn(b.source, place_of(entity, "ctrl"),
         fmt::format("'ctrl' drives robots, and '{}' is none: write it into the robot's own parentheses", said.name));
  }

  const Pose X_B = compose(model.mover == kNone ? model.X_WM : own.X_MP, pose(b.source, entity, "origin"));
  const std::vector<Segment> shape = shape_of_model(b, entity, said);
  is_drop(b.source, entity) ? add_drops(b, entity, model, shape, X_B) : add_body(b, entity, model, shape, X_B);
  add_magnet(b, entity, model, said.size, X_B);
  add_emitter(b, entity, model, said.size, X_B);
  if (said.kind == Kind::light) add_light(b, entity, model);
  if (said.sensor != nullptr) {
    add_sensor(b, entity, model, *said.sensor, X_B, said.size.z, own.name_in_mover);
  } else if ((said.kind == Kind::laser && !said.is_lane_edge) || said.kind == Kind::ranger) {
    add_lasers(b, entity, model, X_B, said.size.z, own.name_in_mover);
  }

  own.model = static_cast<std::uint32_t>(b.world.models.size());
  own.mover = model.mover;
  own.X_WP = model.X_WM;
  own.lift = flag(b.source, entity, "stack_children", true) ? said.size.z : 0.0;
  own.name = model.name;
  b.world.models.push_back(std::move(model));
  add_children(b, entity, said.kind, own);
}

}  // namespace

std::string free_name(Building& b, const std::string& wanted) {
  if (b.names.insert(wanted).second) return wanted;
  for (int& k = b.copies.try_emplace(wanted, 1).first->second;;) {
    std::string name = fmt::format("{}#{}", wanted, ++k);
    if (b.names.insert(name).second) return name;
  }
}

void check_keys(Source& source, const Entity& entity, Where where, std::span<const std::string_view> own) {
  if (where == Where::kept) return;
  for (const Property& property : entity.properties) {
    if (is_known_key(where, property.key, own)) continue;
    if (source.warnings.size() > kMostSuggestions) {
      warn(source, property.at, fmt::format("unknown property '{}' of '{}' is ignored", property.key, entity.word));
      continue;
    }
    warn(source, property.at,
         fmt::format("unknown property '{}' of '{}' is ignored{}", property.key, entity.word,
                     suggest_key(where, property.key, own)));
  }
}

void add_children(Building& b, const Entity& entity, Kind kind, Parent& parent) {
  for (const Entity& child : entity.children) {
    if (kind_of(child.type) == Kind::ignored) continue;
    if (child.type == "block" && parent.model != kNone) {
      check_keys(b.source, child, Where::block);
    } else if (child.type == "sensor" && kind == Kind::ranger) {
      check_keys(b.source, child, Where::sensor);
    } else if (child.type == "block" || child.type == "sensor") {
      const char* home = child.type == "block" ? "a model" : "a ranger";
      warn(b.source, child.at, fmt::format("'{}' is ignored here; expected it inside {}", child.word, home));
    } else if (kind_of(child.type) == Kind::road || kind_of(child.type) == Kind::path) {
      if (parent.model != kNone)
        fail(b.source, child.at, fmt::format("'{}' is part of a model; expected it at the top level", child.word));
      kind_of(child.type) == Kind::road ? add_road(b, child) : add_path(b, child);
    } else {
      add_model(b, child, parent);
    }
  }
}

}  // namespace sf::world
