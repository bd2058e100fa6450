#include "world/ros_map_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/error.h"
#include "base/suggest.h"
#include "world/foreign_world.h"
#include "world/stage/properties.h"

namespace sf::world {

namespace {

constexpr std::size_t kMaxKeyWarnings = 1000;  // keys compared with the known ones
constexpr double kTurn = 6.2832;               // [rad] a full turn, rounded up
constexpr double kCoarsest = 1.0;              // [m] coarser resolutions probably have another unit

struct Yaml {
  const std::string& file;
  YAML::Node root;
};

[[noreturn]] void fail(const Yaml& yaml, const YAML::Node& node, const std::string& message) {
  throw base::InputError(yaml.file, node.IsDefined() && !node.Mark().is_null() ? node.Mark().line + 1 : 0, message);
}

YAML::Node need(const Yaml& yaml, const std::string& key, const std::string& meaning) {
  const YAML::Node node = yaml.root[key];
  if (!node) throw base::InputError(yaml.file, 0, fmt::format("'{}' is missing; expected {}", key, meaning));
  return node;
}

void warn(const Yaml& yaml, const YAML::Node& node, std::vector<Warning>& warnings, const std::string& message) {
  warnings.push_back({yaml.file, node.Mark().line + 1, message});
}

double finite(const Yaml& yaml, const YAML::Node& node, const std::string& what) {
  double value = NAN;
  if (node.IsScalar() && YAML::convert<double>::decode(node, value) && std::isfinite(value)) return value;
  fail(yaml, node, fmt::format("{} is not a number", what));
}

double threshold(const Yaml& yaml, const std::string& key, double fallback) {
  const YAML::Node node = yaml.root[key];
  if (!node) return fallback;
  const double value = finite(yaml, node, "'" + key + "'");
  if (value >= 0.0 && value <= 1.0) return value;
  fail(yaml, node, fmt::format("'{}' is {}; expected 0 to 1", key, value));
}

Pose origin_of(const Yaml& yaml, std::vector<Warning>& warnings) {
  const YAML::Node node = need(yaml, "origin", "[x, y, yaw] of the lower left corner");
  if (!node.IsSequence() || node.size() != 3) fail(yaml, node, "'origin' expects [x, y, yaw]");
  Pose X_WL;
  X_WL.x = finite(yaml, node[0], "x of 'origin'");
  X_WL.y = finite(yaml, node[1], "y of 'origin'");
  X_WL.yaw = finite(yaml, node[2], "yaw of 'origin'");
  if (std::abs(X_WL.x) > kMaxLength || std::abs(X_WL.y) > kMaxLength || std::abs(X_WL.yaw) > 1e6) {
    fail(yaml, node, "'origin' is out of range");
  }
  if (std::abs(X_WL.yaw) > kTurn)
    warn(yaml, node, warnings,
         fmt::format("yaw of 'origin' is in radians, and {:g} looks like degrees: write {:.5g} if it is", X_WL.yaw,
                     X_WL.yaw * M_PI / 180.0));
  return X_WL;
}

// Accepts YAML's words and numbers. map_server accepts integers, including hexadecimal ones, and words.
bool negate_of(const Yaml& yaml, std::vector<Warning>& warnings) {
  const YAML::Node node = yaml.root["negate"];
  bool word = false;
  long long whole = 0;
  double number = 0.0;
  if (!node || (node.IsScalar() && YAML::convert<bool>::decode(node, word))) return word;
  if (node.IsScalar() && YAML::convert<long long>::decode(node, whole)) return whole != 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, number) || !std::isfinite(number))
    fail(yaml, node, "'negate' expects 0 or 1, false or true");
  warn(yaml, node, warnings,
       fmt::format("'negate: {}' is read as {}; map_server expects a whole number, false or true", node.Scalar(),
                   number != 0.0));
  return number != 0.0;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// Mode `scale` has the same walls; its grades between free and occupied are not used.
RosMap::Mode mode_of(const Yaml& yaml, std::vector<Warning>& warnings) {
  const YAML::Node node = yaml.root["mode"];
  if (!node) return RosMap::Mode::trinary;
  const std::string written = node.IsScalar() ? node.Scalar() : "";
  const std::string mode = lower_case(written);
  if (mode == "trinary") return RosMap::Mode::trinary;
  if (mode == "scale") {
    warn(yaml, node, warnings, "'mode: scale' is read as trinary: walls, free and unknown");
    return RosMap::Mode::scale;
  }
  if (mode != "raw") fail(yaml, node, fmt::format("'mode' is '{}'; expected trinary, scale or raw", written));
  warn(yaml, node, warnings,
       "'mode: raw' stores occupancy percentages up to 100; they are compared with 'occupied_thresh' and "
       "'free_thresh', 'negate' is not used, and values above 100 are unknown");
  return RosMap::Mode::raw;
}

// A key of this program, for maps that were drawn for earlier versions or for Nav2 since 2025.
bool averages_alpha(const Yaml& yaml) {
  const YAML::Node node = yaml.root["transparent"];
  if (!node) return true;
  const std::string word = node.IsScalar() ? node.Scalar() : "";
  if (word != "averaged" && word != "unknown") fail(yaml, node, "'transparent' expects averaged or unknown");
  return word == "averaged";
}

void check_map_keys(const Yaml& yaml, std::vector<Warning>& warnings) {
  constexpr auto kKeys = std::to_array<std::string_view>(
      {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode", "transparent"});
  std::set<std::string> written;
  for (const auto& pair : yaml.root) {
    const std::string key = pair.first.IsScalar() ? pair.first.Scalar() : "";
    if (written.size() >= kMaxKeyWarnings) return;
    if (!written.insert(key).second)
      warn(yaml, pair.first, warnings, fmt::format("'{}' is given twice; the first one is used", key));
    if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
      warn(yaml, pair.first, warnings, fmt::format("unknown key '{}' is ignored{}", key, base::suggest(key, kKeys)));
  }
}

YAML::Node parse_yaml(const std::string& file, const std::string& text) {
  try {
    YAML::Node root = YAML::Load(text);
    if (root.IsMap()) return root;
  } catch (const YAML::Exception& error) {
    throw base::InputError(file, error.mark.is_null() ? 0 : error.mark.line + 1, "not YAML: " + error.msg);
  }
  throw base::InputError(file, 0, "expected the YAML of a ROS map: image, resolution, origin");
}

// Returns the maps of flatland's layers: "'a.yaml' and 'b.yaml'"; empty if there are none.
std::string maps_of(const YAML::Node& layers) {
  std::vector<std::string> maps;
  for (const YAML::Node& layer : layers)
    if (layer.IsMap() && layer["map"] && layer["map"].IsScalar() && maps.size() < 10)
      maps.push_back("'" + layer["map"].Scalar() + "'");
  return fmt::format("{}", fmt::join(maps, ", "));
}

// flatland and ir-sim have YAML worlds.
void refuse_foreign_yaml(const Yaml& yaml) {
  const YAML::Node& root = yaml.root;
  if (root["image"]) return;
  if (const YAML::Node layers = root["layers"]; layers && layers.IsSequence()) {
    const std::string maps = maps_of(layers);
    refuse_world_of(yaml.file, layers.Mark().line + 1, "flatland",
                    fmt::format("load the ROS map of one of its layers{}{}; a layer of line segments can be written as "
                                "LINESTRINGs for `outlines`",
                                maps.empty() ? "" : ": ", maps));
  }
  if (const YAML::Node models = root["models"]; models && models.IsSequence())
    refuse_world_of(yaml.file, models.Mark().line + 1, "flatland",
                    "write each of its models as a position( ) or model( ), and load the ROS map that they move in");
  if (root["bodies"] && root["bodies"].IsSequence())
    refuse_world_of(yaml.file, root["bodies"].Mark().line + 1, "flatland (a model)",
                    "write its footprints as block( ... ) of a position( ), with laser( ) for its sensors");
  for (const char* key : {"world", "robot", "robots", "obstacle", "obstacles"})
    if (root[key] && (root[key].IsMap() || root[key].IsSequence()))
      refuse_world_of(yaml.file, root[key].Mark().line + 1, "ir-sim",
                      "name the picture of its `obstacle_map` by `bitmap`, and write each obstacle as a model: a "
                      "rectangle by `size`, a polygon's vertices by block( points ... ), a linestring for `outlines`");
}

RosMap read_map(const Yaml& yaml, std::vector<Warning>& warnings) {
  refuse_foreign_yaml(yaml);
  RosMap map;
  const YAML::Node image = need(yaml, "image", "the map's picture");
  if (!image.IsScalar() || image.Scalar().empty()) fail(yaml, image, "'image' expects a file");
  map.image_line = image.Mark().line + 1;
  map.image = (std::filesystem::path(yaml.file).parent_path() / image.Scalar()).string();

  const YAML::Node resolution = need(yaml, "resolution", "metres per pixel");
  map.resolution = finite(yaml, resolution, "'resolution'");
  if (!(map.resolution > 0.0 && map.resolution <= 1000.0))
    fail(yaml, resolution, "'resolution' expects metres per pixel above 0");
  if (map.resolution > kCoarsest)
    warn(yaml, resolution, warnings,
         fmt::format("'resolution' is in metres per pixel, and {:g} looks like another unit: write {:g} if it is in "
                     "millimetres, {:g} if in centimetres, or {:g} if in pixels per metre",
                     map.resolution, map.resolution / 1000.0, map.resolution / 100.0, 1.0 / map.resolution));
  map.X_WL = origin_of(yaml, warnings);
  map.negate = negate_of(yaml, warnings);
  map.occupied = threshold(yaml, "occupied_thresh", map.occupied);
  map.free = threshold(yaml, "free_thresh", map.free);
  if (map.free > map.occupied) fail(yaml, yaml.root["free_thresh"], "'free_thresh' is above 'occupied_thresh'");
  map.mode = mode_of(yaml, warnings);
  map.averages_alpha = averages_alpha(yaml);
  check_map_keys(yaml, warnings);
  return map;
}

}  // namespace

RosMap read_ros_map_file(const std::string& file, const std::string& text, std::vector<Warning>& warnings) {
  return read_map({file, parse_yaml(file, text)}, warnings);
}

}  // namespace sf::world
