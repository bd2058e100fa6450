#include "world/outlines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "world/stage/polygon.h"
#include "world/stage/properties.h"
#include "world/well_known_text.h"

namespace sf::world {

namespace {

constexpr std::size_t kMaxCorners = 20'000;  // of a ring
constexpr double kMaxCornerPairs = 1e9;      // of all rings; the check for crossings is quadratic
constexpr double kMaxWalls = 5e7;            // of a file

/// A line of the file: its geometry, and the height of its walls.
struct Row {
  std::string_view geometry;
  std::optional<double> height;  ///< in the unit of length of the file
};

/// The first quote that ends a field: two in a row stand for one within it.
std::size_t closing_quote(std::string_view text) {
  std::size_t at = text.find('"');
  while (at < text.size() && text.substr(at + 1).starts_with('"')) at = text.find('"', at + 2);
  return at;
}

/// Fields of a line of comma-separated values (RFC 4180); quotes stand round a field that contains commas.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (bool more = true; more;) {
    const bool quoted = line.starts_with('"');
    if (quoted) line.remove_prefix(1);
    const std::size_t end = std::min(quoted ? closing_quote(line) : line.find(','), line.size());
    fields.push_back(line.substr(0, end));
    line.remove_prefix(std::min(line.find(',', end), line.size()));
    more = line.starts_with(',');
    if (more) line.remove_prefix(1);
  }
  return fields;
}

bool is_word(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
}

/// The rows of a file, with or without a line of column names.
class Rows {
 public:
  /// @return false: the line names the columns
  bool read(std::string_view line, bool first, Row& row) {
    if (first && (is_word(line, "wkt") || is_word(line.substr(0, 4), "wkt,"))) {
      named_ = true;
      const auto names = fields_of(line);
      for (std::size_t i = 1; i < names.size(); ++i)
        if (is_word(names[i], "height")) height_ = i;
      return false;
    }
    row = {line, std::nullopt};
    if (!named_) return true;
    const auto fields = fields_of(line);
    row.geometry = fields.front();
    if (height_ > 0) row.height = height_of(fields);
    return true;
  }

 private:
  std::optional<double> height_of(const std::vector<std::string_view>& fields) const {
    if (height_ >= fields.size() || fields[height_].empty()) return std::nullopt;
    const std::string_view text = fields[height_];
    double height = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), height);
    if (error != std::errc() || end != text.data() + text.size() || !(height >= 0.0 && height <= kMaxLength))
      throw base::InputError(
          fmt::format("the height is '{}'; expected a number that is not negative", text.substr(0, 24)));
    return height;
  }
  bool named_ = false;
  std::size_t height_ = 0;  ///< column; 0: none
};

/// The walls of a file's geometries, in the world frame.
class WallBuilder {
 public:
  WallBuilder(const OutlineFile& file, const TakeOutline& take) : file_(file), take_(take) {}

  void add(const Row& row) {
    const double height = row.height ? *row.height * file_.metres_per_unit : file_.surface.z_max;
    for (const TextGeometry& geometry : read_geometry(row.geometry)) {
      bool solid = geometry.closed;
      for (std::size_t i = 0; i < geometry.lines.size(); ++i) {
        const bool outer = i == 0;
        walls_.clear();
        if (geometry.closed) {
          solid = add_ring(geometry.lines[i], outer, solid);
        } else {
          for (std::size_t k = 1; k < geometry.lines[i].size(); ++k)
            add_wall(geometry.lines[i][k - 1], geometry.lines[i][k], false);
        }
        finish(height);
      }
    }
  }

 private:
  /// @param solid holes: of the outer ring  @return whether the ring bounds a solid
  bool add_ring(const std::vector<glm::dvec2>& points, bool outer, bool solid) {
    const auto corners = static_cast<double>(points.size());
    pairs_ += 0.5 * corners * corners;
    if (points.size() > kMaxCorners || pairs_ > kMaxCornerPairs)
      throw base::InputError(
          fmt::format("a ring of {} corners; at most {} are read, and less in a file with many large "
                      "rings: simplify it (ST_Simplify, ogr2ogr -simplify)",
                      points.size(), kMaxCorners));
    Polygon ring = make_polygon(points);
    solid = ring.solid_left && solid;
    if (outer) {
      for (const PolygonEdge& edge : ring.edges) add_wall(edge.a, edge.b, solid);
    } else {
      for (auto edge = ring.edges.rbegin(); edge != ring.edges.rend(); ++edge) add_wall(edge->b, edge->a, solid);
    }
    return solid;
  }
  glm::dvec2 placed(glm::dvec2 p) const { return transform(file_.X_WF, file_.metres_per_unit * p); }
  void add_wall(glm::dvec2 a, glm::dvec2 b, bool solid) {
    Segment wall = file_.surface;
    wall.a = placed(a);
    wall.b = placed(b);
    wall.solid_left = solid;
    const double farthest = std::max({std::abs(wall.a.x), std::abs(wall.a.y), std::abs(wall.b.x), std::abs(wall.b.y)});
    if (!(farthest <= kMaxLength))
      throw base::InputError(
          fmt::format("a corner is {:g} m from the origin of the world; expected at most {:g} m: shift "
                      "the outlines by the model's 'pose'",
                      farthest, kMaxLength));
    if (wall.a != wall.b) walls_.push_back(wall);
  }
  void finish(double height) {
    if (walls_.empty()) return;
    count_ += static_cast<double>(walls_.size());
    if (count_ > kMaxWalls)
      throw base::InputError(fmt::format("more than {:g} walls, the limit for a file", kMaxWalls));
    for (Segment& wall : walls_) {
      wall.z_min = file_.X_WF.z;
      wall.z_max = file_.X_WF.z + height;
    }
    take_(walls_);
  }

  const OutlineFile& file_;
  const TakeOutline& take_;
  std::vector<Segment> walls_;  ///< of the ring or line in work
  double count_ = 0.0;
  double pairs_ = 0.0;
};

}  // namespace

void read_outlines(const OutlineFile& file, const TakeOutline& take) {
  base::LineFile lines(file.file);
  Rows rows;
  WallBuilder builder(file, take);
  bool any = false;
  for (std::string_view line; lines.next(line);) {
    const bool first = lines.number() == 1;
    if (first && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);  // byte order mark
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    try {
      Row row;
      if (!rows.read(line, first, row)) continue;
      any = true;
      builder.add(row);
    } catch (const base::InputError& error) {
      throw base::InputError(file.file, lines.number(), error.what());
    }
  }
  if (!any)
    throw base::InputError(file.file, 0, "has no outlines; expected a geometry in well-known text on each line");
}

void read_unread(World& world) {
  for (const OutlineFile& file : world.unread)
    read_outlines(file, [&](std::span<const Segment> walls) {
      world.walls.insert(world.walls.end(), walls.begin(), walls.end());
    });
  world.unread.clear();
}

}  // namespace sf::world
