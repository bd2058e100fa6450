#include "world/ros_map.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "world/picture.h"
#include "world/stage/model_shape.h"
#include "world/stage/properties.h"

namespace sf::world {

namespace {

constexpr std::size_t kMaxYaml = 1u << 20;  // bytes; a map's YAML file has a few lines

struct Map {
  std::string image;        ///< path
  double resolution = 0.0;  ///< [m] per pixel
  Pose X_WL;                ///< lower left corner of the picture in the map frame
  bool negate = false;      ///< true: bright pixels are occupied
  double occupied = 0.65;   ///< [-] above: wall
  double free = 0.196;      ///< [-] below: free; between: unknown
};

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

Pose origin_of(const Yaml& yaml) {
  const YAML::Node node = need(yaml, "origin", "[x, y, yaw] of the lower left corner");
  if (!node.IsSequence() || node.size() != 3) fail(yaml, node, "'origin' expects [x, y, yaw]");
  Pose X_WL;
  X_WL.x = finite(yaml, node[0], "x of 'origin'");
  X_WL.y = finite(yaml, node[1], "y of 'origin'");
  X_WL.yaw = finite(yaml, node[2], "yaw of 'origin'");
  if (std::abs(X_WL.x) > kMaxLength || std::abs(X_WL.y) > kMaxLength || std::abs(X_WL.yaw) > 1e6) {
    fail(yaml, node, "'origin' is out of range");
  }
  return X_WL;
}

bool negate_of(const Yaml& yaml) {
  const YAML::Node node = yaml.root["negate"];
  if (!node) return false;
  const std::string word = node.IsScalar() ? node.Scalar() : "";
  if (word == "0" || word == "false") return false;
  if (word == "1" || word == "true") return true;
  fail(yaml, node, "'negate' expects 0 or 1");
}

// Mode `scale` has the same walls; its grades between free and occupied are not used. In mode `raw` no value has a
// known meaning.
void check_mode(const Yaml& yaml, std::vector<Warning>& warnings) {
  const YAML::Node node = yaml.root["mode"];
  if (!node) return;
  const std::string mode = node.IsScalar() ? node.Scalar() : "";
  if (mode == "trinary") return;
  if (mode != "scale") fail(yaml, node, fmt::format("'mode' is '{}'; expected trinary (or scale)", mode));
  warnings.push_back({yaml.file, node.Mark().line + 1, "'mode: scale' is read as trinary: walls, free and unknown"});
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

Map read_map(const Yaml& yaml, std::vector<Warning>& warnings) {
  Map map;
  const YAML::Node image = need(yaml, "image", "the map's picture");
  if (!image.IsScalar() || image.Scalar().empty()) fail(yaml, image, "'image' expects a file");
  map.image = (std::filesystem::path(yaml.file).parent_path() / image.Scalar()).string();

  const YAML::Node resolution = need(yaml, "resolution", "metres per pixel");
  map.resolution = finite(yaml, resolution, "'resolution'");
  if (!(map.resolution > 0.0 && map.resolution <= 1000.0))
    fail(yaml, resolution, "'resolution' expects metres per pixel above 0");
  map.X_WL = origin_of(yaml);
  map.negate = negate_of(yaml);
  map.occupied = threshold(yaml, "occupied_thresh", map.occupied);
  map.free = threshold(yaml, "free_thresh", map.free);
  if (map.free > map.occupied) fail(yaml, yaml.root["free_thresh"], "'free_thresh' is above 'occupied_thresh'");
  check_mode(yaml, warnings);
  return map;
}

// map_server's trinary rule: occ = (255 - p) / 255 (p / 255 when negated); above `occupied` wall, below `free` free,
// otherwise unknown. Transparent pixels are unknown.
enum class Ground : std::uint8_t { wall, unknown, free };

/// @param counts whether this kind of ground is solid in the grid
template <class Counts>
Bitmap grid_of(const Map& map, const Picture& picture, Counts&& counts) {
  Bitmap grid{picture.width, picture.height, std::vector<std::uint8_t>(picture.value.size())};
  for (std::uint32_t row = 0; row < picture.height; ++row) {
    const std::size_t from = std::size_t{row} * picture.width;
    const std::size_t to = std::size_t{picture.height - 1 - row} * picture.width;
    for (std::uint32_t i = 0; i < picture.width; ++i) {
      const double p = picture.value[from + i];
      const double occ = (map.negate ? p : 255.0 - p) / 255.0;
      const bool opaque = picture.opaque.empty() || picture.opaque[from + i] != 0;
      const bool wall = opaque && occ > map.occupied;
      const bool unknown = !wall && (!opaque || occ >= map.free);
      grid.solid[to + i] = counts(wall ? Ground::wall : unknown ? Ground::unknown : Ground::free) ? 1 : 0;
    }
  }
  return grid;
}

Pose middle_of(const Map& map, const Bitmap& grid) {
  return compose(map.X_WL, {map.resolution * grid.width / 2.0, map.resolution * grid.height / 2.0, 0.0, 0.0});
}

std::vector<Segment> outlines_of(const Map& map, Bitmap grid) {
  const Size size{map.resolution * grid.width, map.resolution * grid.height, kMapWallHeight};
  const Pose X_WM = middle_of(map, grid);
  std::vector<Segment> outlines = bitmap_segments(*trace_bitmap(std::move(grid), map.image), size);
  for (Segment& edge : outlines) {
    edge.a = transform(X_WM, edge.a);
    edge.b = transform(X_WM, edge.b);
  }
  return outlines;
}

void add_walls(World& world, const Map& map, Bitmap grid) {
  Model model;
  model.name = "map";
  model.type = "map";
  model.X_WM = middle_of(map, grid);
  model.size = {map.resolution * grid.width, map.resolution * grid.height};
  model.color = 0xFF4D4D4Du;
  model.is_bitmap = true;
  world.models.push_back(model);
  world.walls = outlines_of(map, std::move(grid));
}

}  // namespace

bool is_ros_map(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".yaml" || ending == ".yml";
}

World load_ros_map(const std::string& file, const LoadOptions& options) {
  return build_ros_map(file, base::read_text(file, kMaxYaml), options);
}

World build_ros_map(const std::string& file, const std::string& text, const LoadOptions& options) {
  World world;
  world.file = file;
  world.accuracy.word = options.accuracy;
  world.name = std::filesystem::path(file).stem().string();
  const Yaml yaml{file, parse_yaml(file, text)};
  const Map map = read_map(yaml, world.warnings);
  try {
    const Picture picture = read_picture(map.image, Channel::mean);
    add_walls(world, map, grid_of(map, picture, [&](Ground ground) {
                return ground == Ground::wall || (ground == Ground::unknown && options.unknown_is_wall);
              }));
  } catch (const base::InputError& error) {
    fail(yaml, yaml.root["image"], fmt::format("'image': {}", error.what()));
  }
  update_extent_and_hash(world);
  return world;
}

std::vector<Segment> known_free(const World& world) {
  if (!is_ros_map(world.file)) return {};
  std::vector<Warning> said;
  const Map map = read_map({world.file, parse_yaml(world.file, base::read_text(world.file, kMaxYaml))}, said);
  const Picture picture = read_picture(map.image, Channel::mean);
  return outlines_of(map, grid_of(map, picture, [](Ground ground) { return ground == Ground::free; }));
}

}  // namespace sf::world
