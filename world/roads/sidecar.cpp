#include "world/roads/sidecar.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>

namespace sf::world {

/// toml++ 3.3 takes some of what a file says for granted and, built for release, tells the compiler to do so too. Here
/// its assumptions are checked, and broken ones are the file's fault.
struct NoToml {};
[[noreturn]] inline void distrust() { throw NoToml{}; }

}  // namespace sf::world

#undef NDEBUG
#define TOML_ASSERT(assumption) ((assumption) ? void() : ::sf::world::distrust())
#include <toml++/toml.h>

#include "base/error.h"
#include "world/entities.h"
#include "world/keys.h"

namespace sf::world {

namespace {

constexpr double kMostPosition = 1e7;  // [m]
constexpr double kMostWidth = 1e4;     // [m]

constexpr std::array<std::string_view, 12> kKeys{"origin",       "scale",         "position",      "heading_deg",
                                                 "lane_width_m", "paint_width_m", "dash_length_m", "dash_gap_m",
                                                 "stop_width_m", "spot_width_m",  "lanes",         "points"};
constexpr std::array<std::string_view, 3> kLaneKeys{"width_m", "left", "right"};
constexpr std::array<std::string_view, 1> kPointKeys{"position"};

struct Reader {
  const std::string& file;
  std::vector<Warning>& warnings;

  [[noreturn]] void fail(const toml::node& node, const std::string& message) const {
    throw base::InputError(file, static_cast<int>(node.source().begin.line), message);
  }

  void warn_unknown(const toml::table& table, std::span<const std::string_view> known) const {
    for (const auto& [key, node] : table)
      if (std::find(known.begin(), known.end(), key.str()) == known.end())
        warnings.push_back({file, static_cast<int>(key.source().begin.line),
                            fmt::format("unknown key '{}' is ignored{}", key.str(),
                                        key.str().size() > 40 ? "" : suggest(key.str(), known))});
  }

  double number(const toml::node& node, std::string_view key, double least, double most) const {
    const auto value = node.value<double>();
    if (value && (node.is_floating_point() || node.is_integer()) && *value >= least && *value <= most) return *value;
    fail(node, fmt::format("'{}' expects a number from {} to {}", key, least, most));
  }

  /// A length above 0. [m]
  std::optional<double> width(const toml::table& table, std::string_view key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    const double value = number(*node, key, 0.0, kMostWidth);
    if (value >= 1e-6) return value;
    fail(*node, fmt::format("'{}' is {}; expected metres from 1e-6 to {}", key, value, kMostWidth));
  }

  Vec2 pair(const toml::node& node, std::string_view key, Vec2 most, std::string_view expected) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 2) fail(node, fmt::format("'{}' expects {}", key, expected));
    return {number(*array->get(0), key, -most.x, most.x), number(*array->get(1), key, -most.y, most.y)};
  }

  const toml::table& table(const toml::node& node, std::string_view key) const {
    if (const toml::table* inner = node.as_table()) return *inner;
    fail(node, fmt::format("'{}' expects a table", key));
  }
};

/// `M.L` or `M.L.P`.
std::optional<PointId> id_of(std::string_view text, int count) {
  std::uint16_t parts[3] = {0, 0, 0};
  const char* at = text.data();
  const char* const last = text.data() + text.size();
  for (int i = 0; i < count; ++i) {
    if (i > 0 && (at == last || *at++ != '.')) return std::nullopt;
    const auto [end, error] = std::from_chars(at, last, parts[i]);
    if (error != std::errc()) return std::nullopt;
    at = end;
  }
  if (at != last) return std::nullopt;
  return PointId{parts[0], parts[1], parts[2]};
}

std::optional<Boundary> boundary(const Reader& reader, const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  const auto word = node->value<std::string>();
  if (word && *word == "none") return Boundary::none;
  const auto read = word ? boundary_of(*word) : std::nullopt;
  if (!read) reader.fail(*node, fmt::format("'{}' expects one of {}, none", key, boundary_words()));
  return read;
}

void read_lanes(const Reader& reader, const toml::table& lanes, RoadSidecar& into) {
  for (const auto& [key, node] : lanes) {
    const auto id = id_of(key.str(), 2);
    if (!id) reader.fail(node, fmt::format("{} is no lane; expected [lanes.\"1.2\"]", quoted(key.str())));
    const toml::table& table = reader.table(node, key.str());
    reader.warn_unknown(table, kLaneKeys);
    into.lanes[*id] = {reader.width(table, "width_m"), boundary(reader, table, "left"),
                       boundary(reader, table, "right"), static_cast<int>(key.source().begin.line)};
  }
}

void read_points(const Reader& reader, const toml::table& points, RoadSidecar& into) {
  for (const auto& [key, node] : points) {
    const auto id = id_of(key.str(), 3);
    if (!id) reader.fail(node, fmt::format("{} is no way-point; expected [points.\"1.2.3\"]", quoted(key.str())));
    const toml::table& table = reader.table(node, key.str());
    reader.warn_unknown(table, kPointKeys);
    const toml::node* position = table.get("position");
    if (position == nullptr) reader.fail(node, "'position' is missing; expected position = [x, y] in metres");
    into.points[*id] = {reader.pair(*position, "position", {kMostPosition, kMostPosition}, "[x, y] in metres"),
                        static_cast<int>(key.source().begin.line)};
  }
}

void read_frame(const Reader& reader, const toml::table& root, RoadSidecar& into) {
  if (const toml::node* node = root.get("origin")) {
    const Vec2 origin = reader.pair(*node, "origin", {90.0, 180.0}, "[latitude, longitude] in degrees");
    into.origin = Geodetic{origin.x, origin.y};
  }
  if (const toml::node* node = root.get("scale")) {
    into.scale = reader.number(*node, "scale", 0.0, 1000.0);
    if (into.scale < 1e-6) reader.fail(*node, "'scale' expects a number from 1e-6 to 1000, e.g. 0.142857142857");
  }
  if (const toml::node* node = root.get("position"))
    into.position = reader.pair(*node, "position", {kMostPosition, kMostPosition}, "[x, y] in metres");
  if (const toml::node* node = root.get("heading_deg"))
    into.heading = reader.number(*node, "heading_deg", -1e6, 1e6) * (M_PI / 180.0);
}

/// The same text in ASCII: comments may be in any language, all else is ours. (toml++ up to 3.3 runs into undefined
/// behaviour at some characters beyond.)
std::string in_ascii(const std::string& file, std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());
  std::string plain(text);
  int line = 1;
  bool quoted = false;  // some quote stands in the line so far
  bool comment = false;
  for (char& c : plain) {
    if (c == '\n') {
      ++line;
      quoted = comment = false;
    }
    quoted = quoted || c == '"' || c == '\'';
    comment = comment || (c == '#' && !quoted);
    if (static_cast<unsigned char>(c) < 0x80) continue;
    if (!comment)
      throw base::InputError(file, line, "a character beyond ASCII; expected such only in comments of their own line");
    c = '?';
  }
  return plain;
}

}  // namespace

RoadSidecar parse_sidecar(const std::string& file, std::string_view text, std::vector<Warning>& warnings) {
  RoadSidecar sidecar;
  sidecar.file = file;
  toml::table root;
  try {
    root = toml::parse(in_ascii(file, text), file);
  } catch (const toml::parse_error& error) {
    throw base::InputError(file, static_cast<int>(error.source().begin.line),
                           fmt::format("not TOML: {}", error.description()));
  } catch (const NoToml&) {
    throw base::InputError(file, 0, "not TOML; expected lines like: scale = 0.5");
  }
  const Reader reader{file, warnings};
  reader.warn_unknown(root, kKeys);
  read_frame(reader, root, sidecar);
  sidecar.lane_width = reader.width(root, "lane_width_m");
  sidecar.paint_width = reader.width(root, "paint_width_m");
  sidecar.dash_length = reader.width(root, "dash_length_m");
  sidecar.dash_gap = reader.width(root, "dash_gap_m");
  sidecar.stop_width = reader.width(root, "stop_width_m");
  sidecar.spot_width = reader.width(root, "spot_width_m");
  if (const toml::node* lanes = root.get("lanes")) read_lanes(reader, reader.table(*lanes, "lanes"), sidecar);
  if (const toml::node* points = root.get("points")) read_points(reader, reader.table(*points, "points"), sidecar);
  return sidecar;
}

RoadSidecar read_sidecar(const std::string& rndf_file, std::vector<Warning>& warnings) {
  const std::string file = std::filesystem::path(rndf_file).replace_extension(".toml").string();
  std::error_code error;
  if (file == rndf_file || !std::filesystem::exists(file, error)) return {};
  return parse_sidecar(file, read_text(file), warnings);
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
      throw base::InputError(sidecar.file, point.line,
                             fmt::format("{} has no point {}; expected one of its points", rndf.file, text_of(id)));
}

}  // namespace sf::world
