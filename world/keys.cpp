#include "world/keys.h"

#include <algorithm>
#include <array>

#include "base/suggest.h"
#include "world/fields.h"

namespace sf::world {

namespace {

using Words = std::span<const std::string_view>;

// clang-format off
// Keys with their own readers. world/fields.h has all others.
constexpr auto kWorld = std::to_array<std::string_view>({"unit_length", "unit_angle", "accuracy", "earth_field", "earth_location", "floor_color", "floor_return", "old_shapes", "stage_noise", "stage_obstacles",
  // known, not modelled
  "quit_time", "resolution", "show_clock", "show_clock_interval", "threads", "speedup", "paused", "confirm_on_quit",
  "interval_real", "gui_disable", "gui_interval", "ppm"});

constexpr auto kModel = std::to_array<std::string_view>({"name", "pose", "size", "origin", "color", "color_rgba", "bitmap", "outlines", "mesh", "mesh_scale", "mesh_rotation", "reflectance", "boundary", "stack_children",
  "noblocks", "laser_return", "ranger_return", "magnetic_moment", "magneticmoment", "magnetometer_return", "blocks",
  "block[].points", "block[].point[]", "block[].z", "cliff_return", "tag_pose", "fiducial_return", "fiducial_key", "random_pose", "random_present", "random_size",
  // known, not modelled
  "ctrl", "update_interval", "gui_nose", "gui_grid", "gui_outline", "gui_move", "gui_movemask", "gui_boundary",
  "blob_return", "blobfinder_return", "gripper_return", "puck_return", "mass", "friction",
  "map_resolution", "say", "alwayson", "thread_safe", "joules", "kjoules", "joules_capacity", "watts", "give_watts",
  "take_watts", "trail_length", "trail_interval", "event_queue", "debug", "rebuild_displaylist", "block[].color"});

constexpr auto kPosition = std::to_array<std::string_view>({"dynamics", "random_slip", "random_acceleration", "random_noise",
  // known, not modelled
  "velocity", "localization", "localization_origin", "odom_error", "odom"});

constexpr auto kSensing = std::to_array<std::string_view>({"rate", "phase", "latency", "update_interval", "accuracy", "priority"});

constexpr auto kLight = std::to_array<std::string_view>({"lamps", "phases", "phase[]", "stop_lines"});

constexpr auto kBlockSensor = std::to_array<std::string_view>({"pose", "size", "color", "color_rgba", "name"});

constexpr auto kBlock = std::to_array<std::string_view>({"points", "point[]", "z",
  // known, not modelled
  "color", "color_rgba", "glow"});

constexpr auto kRoad = std::to_array<std::string_view>({"name", "rndf", "magnetic_moment", "magnet_spacing", "magnet_size", "magnet_top", "magnet_lanes"});

constexpr auto kPath = std::to_array<std::string_view>({"name", "pose", "pieces", "straight[]", "arc[]", "left", "right", "paint_width", "dash",
  "magnetic_moment", "magnet_spacing", "magnet_size", "magnet_top"});

constexpr auto kShape = std::to_array<std::string_view>({"name", "size", "color", "color_rgba", "bitmap", "boundary", "noblocks", "blocks",
  "block[].points", "block[].point[]", "block[].z",
  // known, not modelled
  "block[].color"});

constexpr auto kTerrain = std::to_array<std::string_view>({"file", "size", "heights", "pose"});

constexpr auto kUnmodelledTypes = std::to_array<std::string_view>({"actuator", "blinkenlight", "blobfinder", "bumper", "camera", "charger", "fiducial", "gripper",
  "laneedge", "laser", "lightindicator", "magnetometer", "map", "powerpack", "puck", "ranger", "sonar", "speech", "wifi"});
constexpr auto kNoBodyTypes = std::to_array<std::string_view>({"blobfinder", "bumper", "fiducial", "laneedge", "magnetometer", "powerpack", "ranger", "sonar",
  "speech", "wifi"});
constexpr auto kIgnoredTypes = std::to_array<std::string_view>({"window", "gui", "menu"});
// clang-format on

bool has(Words words, std::string_view word) { return std::find(words.begin(), words.end(), word) != words.end(); }

// Converts `block[2].point[13]` to `block[].point[]`.
std::string without_indices(std::string_view key) {
  std::string plain;
  bool inside = false;
  for (const char c : key) {
    if (c == ']') inside = false;
    if (!inside) plain += c;
    if (c == '[') inside = true;
  }
  return plain;
}

/// Returns the keys of a row's fields.
template <class Row>
Words fields_of() {
  static const std::vector<std::string_view> keys = [] {
    std::vector<std::string_view> names;
    for_each_key<Row>([&](const auto& field) { names.push_back(field.key.name); });
    return names;
  }();
  return keys;
}

/// Returns the keys of every model, and `others`.
std::vector<Words> model_and(std::initializer_list<Words> others) {
  std::vector<Words> words{kModel,
                           fields_of<Segment>(),
                           fields_of<Emitter>(),
                           fields_of<Lamp>(),
                           fields_of<HeatSource>(),
                           fields_of<Fiducial>()};
  words.insert(words.end(), others);
  return words;
}

std::vector<Words> keys_in(KeyScope where) {
  switch (where) {
    case KeyScope::world:
      return {kWorld, fields_of<World>(), fields_of<Daylight>(), fields_of<GroundReflectance>()};
    case KeyScope::position:
      return model_and({kPosition, fields_of<Mover>()});
    case KeyScope::light:
      return model_and({kLight, fields_of<Light>()});
    case KeyScope::sensor:
      return {kBlockSensor, kSensing};
    case KeyScope::block:
      return {kBlock};
    case KeyScope::device:
      return model_and({kSensing});
    case KeyScope::sensing:
      return {kSensing};
    case KeyScope::road:
      return {kRoad};
    case KeyScope::path:
      return {kPath};
    case KeyScope::shape:
      return {kShape};
    case KeyScope::terrain:
      return {kTerrain};
    case KeyScope::model:
    case KeyScope::unmodelled:
      break;
  }
  return model_and({});
}

}  // namespace

EntityKind entity_kind(std::string_view type) {
  if (type == "model") return EntityKind::model;
  if (type == "position") return EntityKind::position;
  if (type == "light") return EntityKind::light;
  if (type == "road") return EntityKind::road;
  if (type == "path") return EntityKind::path;
  if (type == "shape") return EntityKind::shape;
  if (type == "terrain") return EntityKind::terrain;
  if (has(kIgnoredTypes, type)) return EntityKind::ignored;
  return has(kUnmodelledTypes, type) ? EntityKind::unmodelled : EntityKind::unknown;
}

bool has_no_body(std::string_view type) { return has(kNoBodyTypes, type); }

std::vector<std::string_view> known_types() {
  std::vector<std::string_view> types{"model", "position", "light", "sensor", "block",
                                      "road",  "path",     "shape", "terrain"};
  types.insert(types.end(), kUnmodelledTypes.begin(), kUnmodelledTypes.end());
  types.insert(types.end(), kIgnoredTypes.begin(), kIgnoredTypes.end());
  return types;
}

bool is_known_key(KeyScope where, std::string_view key, std::span<const std::string_view> own) {
  const std::string plain = without_indices(key);
  const auto words = keys_in(where);
  return has(own, plain) || std::any_of(words.begin(), words.end(), [&](Words list) { return has(list, plain); });
}

std::string_view unmodelled_effect(std::string_view key) {
  if (key == "velocity") return "'velocity' has no effect here: robots stay at rest until they are commanded";
  if (key == "localization") return "'localization' has no effect here: robots have their true poses, without drift";
  return {};
}

std::string suggest_key(KeyScope where, std::string_view key, std::span<const std::string_view> own) {
  std::vector<std::string_view> candidates(own.begin(), own.end());
  for (const Words list : keys_in(where)) candidates.insert(candidates.end(), list.begin(), list.end());
  return base::suggest(without_indices(key), candidates);
}

}  // namespace sf::world
