#include "world/ros_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "world/picture.h"
#include "world/ros_map_file.h"
#include "world/stage/model_picture.h"

namespace sf::world {

namespace {

constexpr std::size_t kMaxYaml = 1u << 20;  // bytes; a map's YAML file has only a few lines

enum class MapCell : std::uint8_t { wall, unknown, free };

// Implements map_server's rule: occ = (255 - p) / 255 (p / 255 if negated); above `occupied` is wall, below `free` is
// free, otherwise unknown. p is the mean of the colours; in mode trinary, the mean includes alpha if the picture has
// it.
MapCell ground_of(const RosMap& map, bool has_alpha, const std::uint8_t* rgba) {
  const bool averaged = has_alpha && map.mode == RosMap::Mode::trinary && map.averages_alpha;
  const std::uint8_t opaque = map.mode == RosMap::Mode::scale ? 255 : 128;
  if (has_alpha && !averaged && map.mode != RosMap::Mode::raw && rgba[3] < opaque) return MapCell::unknown;
  const double sum = rgba[0] + rgba[1] + rgba[2];
  const double p = averaged ? (sum + rgba[3]) / 4.0 : sum / 3.0;
  const double percent = std::round(p);
  if (map.mode == RosMap::Mode::raw && percent > 100.0) return MapCell::unknown;
  const double occ = map.mode == RosMap::Mode::raw ? percent / 100.0 : (map.negate ? p : 255.0 - p) / 255.0;
  if (occ > map.occupied) return MapCell::wall;
  return occ < map.free ? MapCell::free : MapCell::unknown;
}

/// @param counts whether this kind of ground is solid in the grid
/// @param changed counts the cells changed by alpha
template <class Counts>
Bitmap read_grid(const RosMap& map, Counts&& counts, std::size_t* changed = nullptr) {
  RosMap opaque = map;
  opaque.averages_alpha = false;
  return read_bitmap(map.image, [&](const PixelRow& row, std::uint8_t* solid) {
    for (std::size_t i = 0; i < row.rgba.size(); i += 4) {
      const MapCell ground = ground_of(map, row.has_alpha, row.rgba.data() + i);
      *solid++ = counts(ground) ? 1 : 0;
      if (changed != nullptr && row.has_alpha && ground != ground_of(opaque, true, row.rgba.data() + i)) ++*changed;
    }
  });
}

Pose middle_of(const RosMap& map, const Bitmap& grid) {
  return compose(map.X_WL, {map.resolution * grid.width / 2.0, map.resolution * grid.height / 2.0, 0.0, 0.0});
}

std::vector<Segment> outlines_of(const RosMap& map, Bitmap grid) {
  const Size size{map.resolution * grid.width, map.resolution * grid.height, kMapWallHeight};
  const Pose X_WM = middle_of(map, grid);
  const PicturePart part = whole_of(grid);
  std::vector<Segment> outlines = bitmap_segments(trace_bitmap(std::move(grid), map.image), part, size);
  for (Segment& edge : outlines) {
    edge.a = transform(X_WM, edge.a);
    edge.b = transform(X_WM, edge.b);
  }
  return outlines;
}

void add_walls(World& world, const RosMap& map, Bitmap grid) {
  const auto row = static_cast<std::uint32_t>(world.models.size());
  Model model;
  model.name = "map";
  model.type = "map";
  model.X_WM = middle_of(map, grid);
  model.size = {map.resolution * grid.width, map.resolution * grid.height};
  model.color = 0xFF4D4D4Du;
  model.is_bitmap = true;
  world.models.push_back(model);
  std::vector<Segment> walls = outlines_of(map, std::move(grid));
  for (Segment& wall : walls) wall.model = row;
  world.walls.insert(world.walls.end(), walls.begin(), walls.end());
}

void add_map(World& world, const std::string& file, const std::string& text, const LoadOptions& options) {
  const RosMap map = read_ros_map_file(file, text, world.warnings);
  world.ros_map = file;
  try {
    std::size_t changed = 0;
    const auto is_wall = [&](MapCell ground) {
      return ground == MapCell::wall || (ground == MapCell::unknown && options.unknown_is_wall);
    };
    add_walls(world, map, read_grid(map, is_wall, &changed));
    if (changed > 0)
      world.warnings.push_back({file, map.image_line,
                                fmt::format("alpha affects {} cells: it is averaged with the colours, as in "
                                            "map_server, so transparent black is occupied; with 'transparent: unknown' "
                                            "in this file, transparent cells are unknown, as in newer versions of Nav2",
                                            changed)});
  } catch (const base::InputError& error) {
    throw base::InputError(file, map.image_line, fmt::format("'image': {}", error.what()));
  }
}

/// Returns the map of a world that has one.
RosMap map_of(const World& world) {
  std::vector<Warning> said;
  return read_ros_map_file(world.ros_map, base::read_text(world.ros_map, kMaxYaml), said);
}

}  // namespace

bool is_ros_map(const std::string& file) {
  const std::string ending = base::ending_of(file);
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
  add_map(world, file, text, options);
  update_extent_and_hash(world);
  return world;
}

void add_ros_map(World& world, const std::string& file, const LoadOptions& options) {
  add_map(world, file, base::read_text(file, kMaxYaml), options);
}

std::vector<Segment> known_free(const World& world) {
  if (world.ros_map.empty()) return {};
  const RosMap map = map_of(world);
  return outlines_of(map, read_grid(map, [](MapCell ground) { return ground == MapCell::free; }));
}

KnownSpace::KnownSpace(const World& world) : limited_(!world.ros_map.empty()) {
  if (!limited_) return;
  const RosMap map = map_of(world);
  X_WL_ = map.X_WL;
  resolution_ = map.resolution;
  known_ = read_grid(map, [](MapCell ground) { return ground != MapCell::unknown; });
}

bool KnownSpace::contains(glm::dvec2 at) const {
  if (!limited_) return true;
  const glm::dvec2 cell = base::rotate(-X_WL_.yaw, at - glm::dvec2{X_WL_.x, X_WL_.y}) / resolution_;
  if (!(cell.x >= 0.0 && cell.y >= 0.0 && cell.x < known_.width && cell.y < known_.height)) return false;
  return known_.solid[static_cast<std::size_t>(cell.y) * known_.width + static_cast<std::size_t>(cell.x)] != 0;
}

}  // namespace sf::world
