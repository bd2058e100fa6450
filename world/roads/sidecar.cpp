#include "world/roads/sidecar.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/error.h"
#include "base/files.h"
#include "base/suggest.h"
#include "world/toml.h"
#include "world/toml_reader.h"

namespace sf::world {

namespace {

constexpr double kMaxPosition = 1e7;  // [m]
constexpr double kMaxWidth = 1e4;     // [m]
constexpr double kMaxHeight = 1e3;    // [m]

constexpr std::array<std::string_view, 12> kSidecarKeys{"origin",       "scale",         "position",      "heading_deg",
                                                        "lane_width_m", "paint_width_m", "dash_length_m", "dash_gap_m",
                                                        "stop_width_m", "spot_width_m",  "lanes",         "points"};
constexpr std::array<std::string_view, 3> kLaneKeys{"width_m", "left", "right"};
constexpr std::array<std::string_view, 2> kPointKeys{"position", "height_m"};

struct Reader {
  const std::string& file;
  std::vector<Warning>& warnings;

  [[noreturn]] void fail(const TomlNode& node, const std::string& message) const {
    throw base::InputError(file, node.line, message);
  }

  void warn_unknown(const TomlNode& table, std::span<const std::string_view> known) const {
    for (const TomlNode& node : table.items)
      if (std::find(known.begin(), known.end(), node.key) == known.end())
        warnings.push_back({file, node.line,
                            fmt::format("unknown key '{}' is ignored{}", node.key,
                                        node.key.size() > 40 ? "" : base::suggest(node.key, known))});
  }

  double number(const TomlNode& node, std::string_view key, double least, double most) const {
    if (node.kind == TomlNode::Kind::number && node.number >= least && node.number <= most) return node.number;
    fail(node, fmt::format("'{}' expects a number from {} to {}; got {}", key, least, most, shown_toml(node)));
  }

  /// Reads a length [m] of at least 1e-6.
  std::optional<double> width(const TomlNode& table, std::string_view key) const {
    const TomlNode* node = find(table, key);
    if (node == nullptr) return std::nullopt;
    const double value = number(*node, key, 0.0, kMaxWidth);
    if (value >= 1e-6) return value;
    fail(*node, fmt::format("'{}' is {}; expected metres from 1e-6 to {}", key, value, kMaxWidth));
  }

  glm::dvec2 pair(const TomlNode& node, std::string_view key, glm::dvec2 most, std::string_view expected) const {
    if (node.kind != TomlNode::Kind::list || node.items.size() != 2)
      fail(node, fmt::format("'{}' expects {}", key, expected));
    return {number(node.items[0], key, -most.x, most.x), number(node.items[1], key, -most.y, most.y)};
  }

  const TomlNode& table(const TomlNode& node, std::string_view key) const {
    if (node.kind == TomlNode::Kind::table) return node;
    fail(node, fmt::format("'{}' expects a table", key));
  }
};

std::optional<Boundary> boundary(const Reader& reader, const TomlNode& table, std::string_view key) {
  const TomlNode* node = find(table, key);
  if (node == nullptr) return std::nullopt;
  if (node->text == "none") return Boundary::none;
  const auto read = node->kind == TomlNode::Kind::text ? boundary_of(node->text) : std::nullopt;
  if (!read) reader.fail(*node, fmt::format("'{}' expects one of {}, none", key, boundary_words()));
  return read;
}

void read_lanes(const Reader& reader, const TomlNode& lanes, RoadSidecar& into) {
  for (const TomlNode& node : lanes.items) {
    const auto id = read_point_id(node.key, 2);
    if (!id) reader.fail(node, fmt::format("{} is not a lane; expected [lanes.\"1.2\"]", sf::world::quoted(node.key)));
    const TomlNode& table = reader.table(node, node.key);
    reader.warn_unknown(table, kLaneKeys);
    into.lanes[*id] = {reader.width(table, "width_m"), boundary(reader, table, "left"),
                       boundary(reader, table, "right"), node.line};
  }
}

void read_points(const Reader& reader, const TomlNode& points, RoadSidecar& into) {
  for (const TomlNode& node : points.items) {
    const auto id = read_point_id(node.key);
    if (!id)
      reader.fail(node, fmt::format("{} is not a way-point; expected [points.\"1.2.3\"]", sf::world::quoted(node.key)));
    const TomlNode& table = reader.table(node, node.key);
    reader.warn_unknown(table, kPointKeys);
    const TomlNode* position = find(table, "position");
    const TomlNode* height = find(table, "height_m");
    if (position == nullptr && height == nullptr)
      reader.fail(node, "expected position = [x, y] in metres, or height_m = metres above the floor");
    RoadSidecar::Point& point = into.points[*id];
    point.line = node.line;
    if (position != nullptr)
      point.p = reader.pair(*position, "position", {kMaxPosition, kMaxPosition}, "[x, y] in metres");
    if (height != nullptr) point.height = reader.number(*height, "height_m", 0.0, kMaxHeight);
  }
}

void read_frame(const Reader& reader, const TomlNode& root, RoadSidecar& into) {
  if (const TomlNode* node = find(root, "origin")) {
    const glm::dvec2 origin = reader.pair(*node, "origin", {90.0, 180.0}, "[latitude, longitude] in degrees");
    into.origin = Geodetic{origin.x, origin.y};
  }
  if (const TomlNode* node = find(root, "scale")) {
    into.scale = reader.number(*node, "scale", 0.0, 1000.0);
    if (into.scale < 1e-6) reader.fail(*node, "'scale' expects a number from 1e-6 to 1000, e.g. 0.142857142857");
  }
  if (const TomlNode* node = find(root, "position"))
    into.position = reader.pair(*node, "position", {kMaxPosition, kMaxPosition}, "[x, y] in metres");
  if (const TomlNode* node = find(root, "heading_deg"))
    into.heading = reader.number(*node, "heading_deg", -1e6, 1e6) * (M_PI / 180.0);
}

}  // namespace

RoadSidecar parse_sidecar(const std::string& file, std::string_view text, std::vector<Warning>& warnings) {
  RoadSidecar sidecar;
  sidecar.file = file;
  const TomlNode root = parse_toml(file, text);
  const Reader reader{file, warnings};
  reader.warn_unknown(root, kSidecarKeys);
  read_frame(reader, root, sidecar);
  sidecar.lane_width = reader.width(root, "lane_width_m");
  sidecar.paint_width = reader.width(root, "paint_width_m");
  sidecar.dash_length = reader.width(root, "dash_length_m");
  sidecar.dash_gap = reader.width(root, "dash_gap_m");
  sidecar.stop_width = reader.width(root, "stop_width_m");
  sidecar.spot_width = reader.width(root, "spot_width_m");
  if (const TomlNode* lanes = find(root, "lanes")) read_lanes(reader, reader.table(*lanes, "lanes"), sidecar);
  if (const TomlNode* points = find(root, "points")) read_points(reader, reader.table(*points, "points"), sidecar);
  return sidecar;
}

RoadSidecar read_sidecar(const std::string& rndf_file, std::vector<Warning>& warnings) {
  const std::string file = std::filesystem::path(rndf_file).replace_extension(".toml").string();
  std::error_code error;
  if (file == rndf_file || !std::filesystem::exists(file, error)) return {};
  return parse_sidecar(file, base::read_text(file), warnings);
}

void check_against(const RoadSidecar& sidecar, const Rndf& rndf) {
  std::set<PointId> lanes;
  std::set<PointId> points;
  const auto add = [&](const std::vector<RndfPoint>& row) {
    for (const RndfPoint& point : row) points.insert(point.id);
  };
  for (const RndfSegment& segment : rndf.segments)
    for (const RndfLane& lane : segment.lanes) {
      lanes.insert({static_cast<std::uint16_t>(segment.id), static_cast<std::uint16_t>(lane.number), 0});
      add(lane.points);
    }
  for (const RndfZone& zone : rndf.zones) {
    add(zone.perimeter);
    for (const RndfSpot& spot : zone.spots) add(spot.points);
  }
  for (const auto& [id, lane] : sidecar.lanes)
    if (lanes.count(id) == 0)
      throw base::InputError(
          sidecar.file, lane.line,
          fmt::format("{} has no lane {}.{}; expected one of its lanes", rndf.file, id.segment, id.lane));
  for (const auto& [id, point] : sidecar.points)
    if (points.count(id) == 0)
      throw base::InputError(
          sidecar.file, point.line,
          fmt::format("{} has no point {}; expected one of its points", rndf.file, point_id_text(id)));
  for (const auto& [id, point] : sidecar.points)
    if (point.height != 0.0 && lanes.count({id.segment, id.lane, 0}) == 0)
      throw base::InputError(sidecar.file, point.line,
                             fmt::format("point {} is in a zone, which is on the floor; expected 'height_m' of "
                                         "way-points of lanes only",
                                         point_id_text(id)));
}

}  // namespace sf::world
